//! Measures of how far an approximation f̂ is from its reference f.
//!
//! The log residual is ln(a + f̂) − ln(a + f), with f̂ not clamped at 0. The linear residual is
//! max(0, f̂) − f, in sr⁻¹. The offset a is 1e-5 of the mean value of each channel. For RGB, means are
//! over the channels too, and maxima are over all of them. Source: Cole 2002, section 4.3, without its
//! squares of scale.

use brdf_param::DirectionPair;
use rand_core::{Rng, SeedableRng};
use rand_xoshiro::SplitMix64;
use serde::{Deserialize, Serialize};

use crate::{Brdf, FidelityErrors, Rgb, SampleSet, uniform_hemisphere};

/// The mean absolute, mean square and largest absolute residual of a fit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ErrorMeasures {
    /// Mean of |r|, r being a residual.
    pub mean_abs: f64,
    /// Mean of r².
    pub mean_square: f64,
    /// Largest |r|.
    pub max: f64,
}

/// The errors of a fit: the six measures of Cole 2002, and those that follow the eye.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FitErrors {
    /// Measures of log residuals; natural logarithm, no unit.
    pub log: ErrorMeasures,
    /// Measures of linear residuals, sr⁻¹ (mean square: sr⁻²).
    pub linear: ErrorMeasures,
    /// The four errors of which a [`Fidelity`](crate::Fidelity) has two sets.
    pub fidelity: FidelityErrors,
    /// Number of log residuals for which a + f̂ was not positive, so that f̂ = 0 was used instead.
    #[serde(default)]
    pub without_logarithm: usize,
}

/// Returns the offset a of the log residual for each channel: 1e-5 of its mean.
///
/// Where a channel is zero everywhere the offset is 1e-5, so that the logarithm exists.
pub fn log_offsets(samples: &SampleSet) -> Vec<f64> {
    samples.mean().into_iter().map(|mean| if mean > 0.0 { 1e-5 * mean } else { 1e-5 }).collect()
}

/// Returns the errors of a model over a set of samples, with the given log offset for each channel.
///
/// Where a + f̂ ≤ 0, which happens only if a model goes negative, f̂ = 0 is used instead, and counted.
/// A set of one channel is compared with the model's luminance.
///
/// ```
/// use brdf_model::{Channels, PairSampling, Preset, SampleSet, log_offsets, measure};
///
/// let sampling = PairSampling { count: 500, seed: 1, theta_max: 1.3 };
/// let reference = Preset::find("plastic").expect("a preset of this crate").brdf();
/// let samples = SampleSet::draw(&reference, &sampling, Channels::Rgb);
/// let offsets = log_offsets(&samples);
/// assert_eq!(measure(&samples, &reference, &offsets).log.max, 0.0);
/// let other = Preset::find("lambert").expect("a preset of this crate").brdf();
/// assert!(measure(&samples, &other, &offsets).log.mean_square > 0.01);
/// ```
pub fn measure(samples: &SampleSet, model: &dyn Brdf, offsets: &[f64]) -> FitErrors {
    let predicted: Vec<Rgb> = samples.pairs().map(|pair| model.eval_unclamped(&pair)).collect();
    measure_values(samples, &predicted, offsets)
}

/// Returns the errors of samples under models that were each fitted without one fold: `predicted` are the unclamped
/// values of each fold's own model at its samples, in the order of the fold.
///
/// # Panics
///
/// If the folds are not those of [`SampleSet::folds`] of these samples.
pub fn measure_folds(
    samples: &SampleSet,
    folds: &[Vec<usize>],
    predicted: &[Vec<Rgb>],
    offsets: &[f64],
) -> FitErrors {
    let mut values = vec![Rgb::BLACK; samples.len()];
    for (&index, value) in folds.iter().flatten().zip(predicted.iter().flatten()) {
        values[index] = *value;
    }
    measure_values(samples, &values, offsets)
}

fn measure_values(samples: &SampleSet, predicted: &[Rgb], offsets: &[f64]) -> FitErrors {
    let mut sums = vec![FitErrors::default(); offsets.len()];
    for (index, predicted) in predicted.iter().enumerate() {
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
    let seen = |rgb: Rgb| match offsets.len() {
        1 => Rgb::splat(rgb.luminance()),
        _ => rgb,
    };
    let pairs: Vec<DirectionPair> = samples.pairs().collect();
    let reference: Vec<Rgb> = (0..samples.len()).map(|index| samples.rgb(index)).collect();
    let predicted: Vec<Rgb> = predicted.iter().copied().map(seen).collect();
    let fidelity = FidelityErrors::of(&pairs, &reference, &predicted);
    FitErrors { fidelity, ..mean_over(&sums, samples.len()) }
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
        fidelity: FidelityErrors::default(),
        without_logarithm: sums.iter().map(|s| s.without_logarithm).sum(),
    }
}

/// The number of pairs of [`cosine_rms`], that of Wang, Tran and Luebke 2004, section 4.3.
pub const COSINE_RMS_PAIRS: usize = 80_000;

/// Cosine-weighted errors over both hemispheres, root mean squares in sr⁻¹.
///
/// For models that grow without bound towards grazing (Ashikhmin–Shirley, clamped at a cosine of 1e-3)
/// `absolute` depends on a few pairs; `both_cosines` and `within_80` do not.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CosineRms {
    /// The error √(Σ cosθi (f − f̂)² / N), over N pairs.
    pub absolute: f64,
    /// The absolute error divided by √(Σ cosθi f² / N); no unit.
    pub relative: f64,
    /// The error with both cosines, √(Σ cosθi cosθo (f − f̂)² / N).
    pub both_cosines: f64,
    /// The absolute error over pairs with both directions within 80° of the normal.
    pub within_80: f64,
    /// Number of pairs that the reference or the model has no data for; they are left out of N.
    pub without_data: usize,
}

/// Returns the cosine-weighted RMS errors over [`COSINE_RMS_PAIRS`] pairs, uniform in solid angle on
/// both hemispheres (SplitMix64).
///
/// Squares are averaged over `channels`. Values are not clamped from above. Source: Wang, Tran and
/// Luebke 2004, section 4.3. The paper names neither a distribution of pairs nor a division by their
/// number; both are chosen here.
///
/// ```
/// use brdf_model::{Channels, Preset, cosine_rms};
///
/// let brdf = |name| Preset::find(name).expect("a preset of this crate").brdf();
/// let errors = cosine_rms(&brdf("plastic"), &brdf("lambert"), Channels::Rgb, 1);
/// assert!(errors.relative > 0.1 && errors.without_data == 0);
/// ```
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

/// Returns the pairs of [`cosine_rms`] for a seed.
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
