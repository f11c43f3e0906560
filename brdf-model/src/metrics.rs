//! How far an approximation is from its reference.
//!
//! Log residual: ln(a + f̂) − ln(a + f) with f̂ not clamped at 0. Linear residual: max(0, f̂) − f,
//! in sr⁻¹. The offset a is 1e-5 of the mean value of each channel. Over RGB, means are means over
//! channels and maxima are over all. Cole 2002, section 4.3, without its squares of scale.

use brdf_param::DirectionPair;
use rand_core::{Rng, SeedableRng};
use rand_xoshiro::SplitMix64;
use serde::{Deserialize, Serialize};

use crate::{Brdf, Rgb, SampleSet, uniform_hemisphere};

/// Mean absolute, mean square and largest absolute residual.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ErrorMeasures {
    /// Mean of |r|.
    pub mean_abs: f64,
    /// Mean of r².
    pub mean_square: f64,
    /// Largest |r|.
    pub max: f64,
}

/// The six measures of the thesis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FitErrors {
    /// Of log residuals; natural logarithm, no unit.
    pub log: ErrorMeasures,
    /// Of linear residuals, sr⁻¹ (mean square: sr⁻²).
    pub linear: ErrorMeasures,
    /// Log residuals for which a + f̂ was not positive and f̂ = 0 stood in.
    #[serde(default)]
    pub without_logarithm: usize,
}

impl FitErrors {
    /// Mean of several sets of errors, each weighted by its number of samples; maxima are maxima.
    pub fn pooled(parts: &[(Self, usize)]) -> Self {
        let total: usize = parts.iter().map(|(_, count)| count).sum();
        let pool = |pick: fn(&Self) -> ErrorMeasures| {
            parts.iter().fold(ErrorMeasures::default(), |sum, (errors, count)| {
                let share = *count as f64 / total.max(1) as f64;
                let part = pick(errors);
                ErrorMeasures {
                    mean_abs: sum.mean_abs + share * part.mean_abs,
                    mean_square: sum.mean_square + share * part.mean_square,
                    max: sum.max.max(part.max),
                }
            })
        };
        let without_logarithm = parts.iter().map(|(errors, _)| errors.without_logarithm).sum();
        Self { log: pool(|e| e.log), linear: pool(|e| e.linear), without_logarithm }
    }
}

/// 1e-5 of the mean of each channel: the offset a of the log residual. Where a channel is zero
/// everywhere, 1e-5, so that the logarithm exists.
pub fn log_offsets(samples: &SampleSet) -> Vec<f64> {
    samples.mean().into_iter().map(|mean| if mean > 0.0 { 1e-5 * mean } else { 1e-5 }).collect()
}

/// The errors of a model over a set of samples, with the given log offset per channel.
///
/// Where a + f̂ ≤ 0, which a model can only reach by going negative, f̂ = 0 stands in and is counted.
/// A set of one channel is compared with the model's luminance.
pub fn measure(samples: &SampleSet, model: &dyn Brdf, offsets: &[f64]) -> FitErrors {
    let mut sums = vec![FitErrors::default(); offsets.len()];
    for (index, pair) in samples.pairs().enumerate() {
        let predicted = model.eval_unclamped(&pair);
        let channels = match offsets.len() {
            1 => [predicted.luminance(), 0.0, 0.0],
            _ => predicted.channels(),
        };
        for (channel, sum) in sums.iter_mut().enumerate() {
            let (f, a) = (samples.values()[channel][index], offsets[channel]);
            let approximation = channels[channel];
            let has_logarithm = a + approximation > 0.0;
            let shifted = if has_logarithm { a + approximation } else { a };
            sum.without_logarithm += usize::from(!has_logarithm);
            sum.log.add(shifted.ln() - (a + f).ln());
            sum.linear.add(approximation.max(0.0) - f);
        }
    }
    mean_over(&sums, samples.len())
}

impl ErrorMeasures {
    fn add(&mut self, residual: f64) {
        self.mean_abs += residual.abs();
        self.mean_square += residual * residual;
        self.max = self.max.max(residual.abs());
    }
}

/// Means over samples and channels from per-channel sums.
fn mean_over(sums: &[FitErrors], count: usize) -> FitErrors {
    let terms = (count.max(1) * sums.len().max(1)) as f64;
    let reduce = |pick: fn(&FitErrors) -> ErrorMeasures| ErrorMeasures {
        mean_abs: sums.iter().map(|s| pick(s).mean_abs).sum::<f64>() / terms,
        mean_square: sums.iter().map(|s| pick(s).mean_square).sum::<f64>() / terms,
        max: sums.iter().map(|s| pick(s).max).fold(0.0, f64::max),
    };
    FitErrors {
        log: reduce(|s| s.log),
        linear: reduce(|s| s.linear),
        without_logarithm: sums.iter().map(|s| s.without_logarithm).sum(),
    }
}

/// Pairs behind [`cosine_rms`]: as many as Wang, Tran and Luebke 2004, section 4.3.
pub const COSINE_RMS_PAIRS: usize = 80_000;

/// Cosine-weighted errors over both hemispheres, root mean squares in sr⁻¹.
///
/// Models that grow without bound towards grazing (Ashikhmin–Shirley, which is clamped at a cosine
/// of 1e-3) make the first depend on a few pairs; the others do not.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CosineRms {
    /// √(Σ cosθi (f − f̂)² / N).
    pub absolute: f64,
    /// The same divided by √(Σ cosθi f² / N).
    pub relative: f64,
    /// √(Σ cosθi cosθo (f − f̂)² / N).
    pub both_cosines: f64,
    /// The first, over pairs with both directions within 80° of the normal.
    pub within_80: f64,
    /// Pairs that the reference or the model has no data for; they are left out of N.
    pub without_data: usize,
}

/// Cosine-weighted RMS over [`COSINE_RMS_PAIRS`] pairs, uniform in solid angle on both
/// hemispheres (SplitMix64), squares averaged over `channels`. Values are not clamped from above.
///
/// Source: Wang, Tran and Luebke 2004, section 4.3; the distribution and the division by the number
/// of pairs are ours, the paper names none.
pub fn cosine_rms(
    reference: &dyn Brdf,
    model: &dyn Brdf,
    channels: crate::Channels,
    seed: u64,
) -> CosineRms {
    let (mut error, mut signal, mut count) = (0.0, 0.0, 0_u32);
    let (mut both, mut near, mut near_count) = (0.0, 0.0, 0_u32);
    let mut without_data = 0;
    let limit = 80_f64.to_radians().cos();
    for pair in cosine_rms_pairs(seed) {
        if !reference.has_data(&pair) || !model.has_data(&pair) {
            without_data += 1;
            continue;
        }
        let f = reference.eval(&pair);
        let square = pair.wi.z * mean_square(f - model.eval(&pair), channels);
        error += square;
        both += pair.wo.z * square;
        signal += pair.wi.z * mean_square(f, channels);
        count += 1;
        if pair.wi.z.min(pair.wo.z) >= limit {
            near += square;
            near_count += 1;
        }
    }
    let n = f64::from(count.max(1));
    CosineRms {
        absolute: (error / n).sqrt(),
        relative: if signal > 0.0 { (error / signal).sqrt() } else { 0.0 },
        both_cosines: (both / n).sqrt(),
        within_80: (near / f64::from(near_count.max(1))).sqrt(),
        without_data,
    }
}

/// The pairs of [`cosine_rms`].
pub fn cosine_rms_pairs(seed: u64) -> impl Iterator<Item = DirectionPair> {
    let mut rng = SplitMix64::seed_from_u64(seed);
    let mut uniform = move || {
        let bits = (rng.next_u64() >> 11) as f64;
        bits / 9_007_199_254_740_992.0
    };
    (0..COSINE_RMS_PAIRS).map(move |_| {
        let wi = uniform_hemisphere(uniform(), uniform());
        let wo = uniform_hemisphere(uniform(), uniform());
        DirectionPair::new(wi, wo)
    })
}

fn mean_square(value: Rgb, channels: crate::Channels) -> f64 {
    match channels {
        crate::Channels::Rgb => value.channels().iter().map(|v| v * v).sum::<f64>() / 3.0,
        crate::Channels::Luminance => value.luminance().powi(2),
    }
}
