//! Fits of scattered samples, which cannot be read at nodes and say nothing of much of the domain.

use brdf_job::{Job, Stopped};
use brdf_model::{Channels, FidelityErrors, GgxLobes, Rgb, SampleSet, ScrambledSobol};
use brdf_param::DirectionPair;
use rayon::prelude::*;

use crate::base::stored;
use crate::error::SplineError;
use crate::fit::{
    ALPHAS, OFFSETS, SPLINE_BYTES, SplineFit, SplineSettings, check_bytes, check_data, finish,
};
use crate::harmonics::Symmetry;
use crate::judges::evaluate;
use crate::nodes::Nodes;
use crate::size::Size;
use crate::trials::{Choices, SplineTrial, best, try_out};

/// Weights of second differences that are tried.
const ROUGHNESSES: [f64; 3] = [1e-3, 1e-5, 1e-1];
/// Weights of the base that are tried, all in all, beside those of all samples.
const BASE_WEIGHTS: [f64; 3] = [1e-2, 1e-3, 1e-1];
/// Lobes of the base that are tried.
const LOBES: [usize; 2] = [2, 1];
/// Symmetries that are tried.
const SYMMETRIES: [Symmetry; 4] =
    [Symmetry::Both, Symmetry::Reciprocal, Symmetry::Mirror, Symmetry::None];
/// Sizes that are tried, of the one that the bytes are usual for.
const SIZES: [f64; 3] = [0.4, 1.0, 0.16];
/// Parts of the samples, each of which judges trials that were made without it.
const PARTS: usize = 5;
/// Steps of a trial.
const STEPS: usize = 5;
/// Most bytes for each channel of a sample: more did no better.
const BYTES_PER_VALUE: f64 = 0.6;

/// What fits so many lobes to samples.
pub type BaseFit<'a> = &'a (dyn Fn(&SampleSet, usize) -> Result<GgxLobes, Stopped> + Sync);

/// Returns the model of scattered samples of an isotropic material in at most so many bytes, or in fewer where there
/// are few samples.
///
/// Samples are fitted as they are and count the same. With a base the model is what the products change of its lobes,
/// which need not be a good fit: they are what is left far from all samples, where the products are held to change
/// nothing, at a small share of the weight of the samples. What share, which symmetry and what size suit the samples is
/// tried on five parts, each judged by models of the other four; the model is fitted to all samples.
///
/// # Errors
///
/// As [`fit_splines`](crate::fit_splines); [`SplineError::Lobes`].
pub fn fit_spline_samples(
    samples: &SampleSet,
    base: Option<BaseFit<'_>>,
    settings: &SplineSettings,
    job: &Job<'_>,
) -> Result<SplineFit, SplineError> {
    check_bytes(settings.bytes)?;
    let samples = match settings.channels {
        Channels::Luminance => samples.to_luminance(),
        Channels::Rgb => samples.clone(),
    };
    check_data(&Nodes::of_samples(&samples, Symmetry::Both, None))?;
    let channels = samples.channels().count();
    let least = *SPLINE_BYTES.start();
    let bytes = part_of(channels * samples.len(), BYTES_PER_VALUE).clamp(least, settings.bytes);
    let base_of = |rows: &SampleSet, lobes: usize| -> Result<Option<GgxLobes>, SplineError> {
        let base = base.filter(|_| lobes > 0);
        base.map(|base| stored(&base(rows, lobes)?, channels)).transpose()
    };
    let [trying, fitting] = job.split([1.0, 3.0]);
    let trials = match settings.axis {
        Some(axis) => vec![axis],
        None => {
            let parts = Parts::new(&samples, settings.seed, &base_of)?;
            let sizes = SIZES.map(|size| part_of(bytes, size).max(least));
            let choices = Choices {
                alphas: &ALPHAS,
                offsets: &OFFSETS,
                roughnesses: &ROUGHNESSES,
                lobes: if base.is_some() { &LOBES } else { &[0] },
                base_weights: if base.is_some() { &BASE_WEIGHTS } else { &[0.0] },
                symmetries: settings.symmetry.as_ref().map_or(&SYMMETRIES, std::slice::from_ref),
                sizes: &sizes,
            };
            choices.try_all(&|trial| parts.score(trial, &trying), &trying)?
        }
    };
    let best = best(&trials);
    let base = base_of(&samples, best.lobes)?;
    let base = base.as_ref().map(|base| (base, best.base_weight));
    let nodes = Nodes::of_samples(&samples, best.symmetry, base);
    let size = Size::for_bytes(best.size, best.symmetry, channels);
    let mut made = finish(&nodes, size, best, bytes, &fitting)?;
    made.trials = trials;
    Ok(made)
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a part of a number of bytes"
)]
fn part_of(count: usize, part: f64) -> usize {
    (count as f64 * part) as usize
}

/// Samples in parts.
struct Parts {
    parts: Vec<Part>,
    pairs: Vec<DirectionPair>,
    values: Vec<Rgb>,
}

/// A part of the samples, and what models of the others are made of.
struct Part {
    pairs: Vec<DirectionPair>,
    others: SampleSet,
    /// Bases by their number of lobes; none for 0.
    bases: Vec<Option<GgxLobes>>,
}

impl Parts {
    fn new(
        samples: &SampleSet,
        seed: u64,
        base_of: &(impl Fn(&SampleSet, usize) -> Result<Option<GgxLobes>, SplineError> + Sync),
    ) -> Result<Self, SplineError> {
        let (mut parts, mut pairs, mut values) = (Vec::new(), Vec::new(), Vec::new());
        for own in samples.folds(PARTS, ScrambledSobol::validation_seed(seed)) {
            let others: Vec<usize> =
                (0..samples.len()).filter(|index| own.binary_search(index).is_err()).collect();
            let others = samples.select(&others);
            let most = LOBES.iter().copied().max().unwrap_or(0);
            let bases = (0..=most).into_par_iter().map(|lobes| base_of(&others, lobes));
            let bases = bases.collect::<Result<_, _>>()?;
            let own_pairs: Vec<DirectionPair> = own.iter().map(|&i| samples.pair(i)).collect();
            pairs.extend(&own_pairs);
            values.extend(own.iter().map(|&index| samples.rgb(index)));
            parts.push(Part { pairs: own_pairs, others, bases });
        }
        Ok(Self { parts, pairs, values })
    }

    /// The error of all samples under models of the parts that they are not in.
    fn score(&self, trial: &SplineTrial, job: &Job<'_>) -> f64 {
        let of = |part: &Part| {
            let base = part.bases[trial.lobes].as_ref();
            let weighted = base.map(|base| (base, trial.base_weight));
            let nodes = Nodes::of_samples(&part.others, trial.symmetry, weighted);
            let size = Size::for_bytes(trial.size, trial.symmetry, nodes.channels);
            let (products, channels) = try_out(&nodes, size, trial, STEPS, job);
            evaluate(&products, &channels, base, &part.pairs)
        };
        let found: Vec<Vec<Rgb>> = self.parts.par_iter().map(of).collect();
        FidelityErrors::of(&self.pairs, &self.values, &found.concat()).score()
    }
}
