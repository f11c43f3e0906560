//! Fits: which axis, which offset, how many functions, and how coarse coefficients may be.

use brdf_job::{Job, Stopped};
use brdf_model::{Brdf, Channels, Fidelity, FidelityErrors, Rgb, SampleSet};
use brdf_param::DirectionPair;
use rayon::prelude::*;

use crate::alternating::{Alternating, ROUGHNESS};
use crate::basis::CubicBasis;
use crate::channel::Channel;
use crate::error::SplineError;
use crate::harmonics::Symmetry;
use crate::judges::{Judges, evaluate};
use crate::model::SplineBrdf;
use crate::nodes::{NodeGrid, Nodes};
use crate::products::{Products, Shape};
use crate::rounding::quantize;
use crate::warp::HalfAxis;

/// Bytes that a model may have.
pub const SPLINE_BYTES: std::ops::RangeInclusive<usize> = 300..=200_000;

/// α of the axis of θh that are tried, radians.
const ALPHAS: [f64; 3] = [0.004, 0.014, 0.05];
/// Offsets a that are tried, relative to the mean of a channel.
const OFFSETS: [f64; 3] = [1e-4, 1e-3, 5e-3];
/// Roughnesses that are tried with scattered samples, which leave gaps.
const ROUGHNESSES: [f64; 3] = [1e-5, 1e-3, 1e-1];
/// Shares that are tried of a prior, beside all samples.
const PRIORS: [f64; 3] = [1e-3, 1e-2, 1e-1];
/// Steps of a trial, and of the fit.
const TRIAL_STEPS: usize = 8;
const STEPS: usize = 18;
/// Steps after which nodes are weighed anew.
const REWEIGHED: [usize; 4] = [3, 6, 10, 14];
/// Error below which a symmetry is taken to hold: a third of that of a model of a few kilobytes.
const SYMMETRIC: f64 = 0.006;

/// How a material is fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SplineSettings {
    /// Most bytes of the model, within [`SPLINE_BYTES`].
    pub bytes: usize,
    /// Channels to fit.
    pub channels: Channels,
    /// Which exchanges leave the model unchanged; none for those that leave the material unchanged.
    pub symmetry: Option<Symmetry>,
    /// Which pairs trials are judged by.
    pub seed: u64,
    /// Axis, offset, roughness and share of a prior of an earlier fit, to be taken as they are; none to try some.
    pub axis: Option<SplineTrial>,
}

impl Default for SplineSettings {
    fn default() -> Self {
        Self { bytes: 8_192, channels: Channels::Rgb, symmetry: None, seed: 1, axis: None }
    }
}

/// A fitted model and what was tried.
#[derive(Clone, Debug)]
pub struct SplineFit {
    /// The model.
    pub model: SplineBrdf,
    /// Places at which the material was read.
    pub nodes: usize,
    /// Channels of those places that are 0: the model may be anything below there, as it ends at 0.
    pub zeros: usize,
    /// Places that were left out because a value was not finite.
    pub not_finite: usize,
    /// Axes and offsets that were tried, with their errors.
    pub trials: Vec<SplineTrial>,
    /// Errors of the material against its mirror image, and against itself with light and viewer exchanged, as far as
    /// that was looked at.
    pub asymmetry: Option<[f64; 2]>,
}

/// What one axis and offset came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SplineTrial {
    /// Angle up to which splines over θh are evenly spaced, radians.
    pub alpha: f64,
    /// a of ln(a + f), relative to the mean value of a channel.
    pub offset: f64,
    /// Weight of second differences, relative to that of what is fitted.
    pub roughness: f64,
    /// Weight of the prior of scattered samples, relative to that of all samples.
    pub prior: f64,
    /// The geometric mean of errors of [`Fidelity::score`], for a small model that is not rounded.
    pub score: f64,
}

/// Returns the model of an isotropic material in at most so many bytes.
///
/// The material is read at nodes that crowd at the mirror direction, all at azimuth φh = 0. Weights are such that the
/// geometric mean of the errors of [`Fidelity`] falls. Which axis of θh and which offset of the logarithm suit the
/// material is tried on fewer nodes.
///
/// # Errors
///
/// [`SplineError::Bytes`], [`SplineError::NoData`], [`SplineError::Stopped`].
pub fn fit_splines(
    brdf: &dyn Brdf,
    settings: &SplineSettings,
    job: &Job<'_>,
) -> Result<SplineFit, SplineError> {
    check_bytes(settings.bytes)?;
    let channels = settings.channels.count();
    let judges = Judges::new(brdf, settings);
    let found = settings.symmetry.is_none().then(|| judges.asymmetry(brdf));
    let symmetry = settings.symmetry.unwrap_or_else(|| symmetry_of(found));
    let size = Size::for_bytes(settings.bytes, symmetry, channels);
    let [trying, fitting] = job.split([1.0, 3.0]);

    let nodes = Nodes::of_grid(brdf, Size::trial(size).grid, symmetry, channels);
    check_data(&nodes)?;
    let judge = |products: &Products, channels: &[Channel]| judges.score(products, channels);
    let trials = match settings.axis {
        Some(axis) => vec![axis],
        None => {
            let nodes = [(0.0, nodes)];
            try_axes(&nodes, Size::trial(size), symmetry, &[ROUGHNESS], &judge, &trying)?
        }
    };
    let best = best(&trials);

    let nodes = Nodes::of_grid(brdf, size.grid, symmetry, channels);
    let mut made = finish(&nodes, size, symmetry, best, settings.bytes, &fitting)?;
    made.trials = trials;
    made.asymmetry = found;
    Ok(made)
}

/// What stands in for a material where its samples say nothing, made of the samples.
pub type Prior<'a> = &'a (dyn Fn(&SampleSet) -> Result<Box<dyn Brdf>, Stopped> + Sync);

/// Returns the model of scattered samples of an isotropic material in at most so many bytes, or in fewer where there
/// are few samples.
///
/// Samples are fitted as they are and count the same. A prior is fitted beside them everywhere, at a small share of
/// their weight, so that it decides where they are far. Without [`SplineSettings::symmetry`] both symmetries are taken
/// to hold, since few samples can tell. A fifth of the samples, every fifth in their order, judges the trials; the
/// model is fitted to all of them.
///
/// # Errors
///
/// As [`fit_splines`].
pub fn fit_spline_samples(
    samples: &SampleSet,
    prior: Option<Prior<'_>>,
    settings: &SplineSettings,
    job: &Job<'_>,
) -> Result<SplineFit, SplineError> {
    /// Bytes for each channel of a sample: half a coefficient.
    const BYTES_PER_VALUE: usize = 1;
    check_bytes(settings.bytes)?;
    let symmetry = settings.symmetry.unwrap_or(Symmetry::Both);
    let samples = match settings.channels {
        Channels::Luminance => samples.to_luminance(),
        Channels::Rgb => samples.clone(),
    };
    let channels = samples.channels().count();
    let few = BYTES_PER_VALUE * channels * samples.len();
    let bytes = settings.bytes.min(few.max(*SPLINE_BYTES.start()));
    let size = Size::for_bytes(bytes, symmetry, channels);
    let [trying, fitting] = job.split([1.0, 3.0]);

    let (aside, kept): (Vec<usize>, Vec<usize>) =
        (0..samples.len()).partition(|index| index % 5 == 4);
    let (aside, kept) = (samples.select(&aside), samples.select(&kept));
    check_data(&Nodes::of_samples(&kept, None))?;
    let pairs: Vec<DirectionPair> = aside.pairs().collect();
    let reference: Vec<Rgb> = (0..aside.len()).map(|index| aside.rgb(index)).collect();
    let judge = |products: &Products, channels: &[Channel]| {
        let found = evaluate(products, channels, &pairs);
        let errors = FidelityErrors::of(&pairs, &reference, &found);
        Fidelity { uniform: errors, highlight: errors }.score()
    };
    let trials = match settings.axis {
        Some(axis) => vec![axis],
        None => {
            let nodes: Vec<(f64, Nodes)> = match prior {
                None => vec![(0.0, Nodes::of_samples(&kept, None))],
                Some(prior) => {
                    let model = prior(&kept)?;
                    let of = |share| (share, Nodes::of_samples(&kept, Some((&*model, share))));
                    PRIORS.map(of).into()
                }
            };
            try_axes(&nodes, Size::trial(size), symmetry, &ROUGHNESSES, &judge, &trying)?
        }
    };
    let best = best(&trials);
    let model = prior.map(|prior| prior(&samples)).transpose()?;
    let nodes = Nodes::of_samples(&samples, model.as_deref().map(|model| (model, best.prior)));
    let mut made = finish(&nodes, size, symmetry, best, bytes, &fitting)?;
    made.trials = trials;
    Ok(made)
}

fn check_bytes(bytes: usize) -> Result<(), SplineError> {
    if SPLINE_BYTES.contains(&bytes) {
        return Ok(());
    }
    Err(SplineError::Bytes { bytes, min: *SPLINE_BYTES.start(), max: *SPLINE_BYTES.end() })
}

fn check_data(nodes: &Nodes) -> Result<(), SplineError> {
    let is_black = nodes.known().all(|node| node.value.iter().all(|v| *v <= 0.0));
    if is_black { Err(SplineError::NoData { nodes: nodes.known().count() }) } else { Ok(()) }
}

fn best(trials: &[SplineTrial]) -> SplineTrial {
    let better = |best: SplineTrial, trial: &SplineTrial| {
        if trial.score < best.score { *trial } else { best }
    };
    trials.iter().fold(trials[0], better)
}

fn symmetry_of(asymmetry: Option<[f64; 2]>) -> Symmetry {
    let [mirror, exchange] = asymmetry.unwrap_or_default().map(|error| error < SYMMETRIC);
    match (mirror, exchange) {
        (true, true) => Symmetry::Both,
        (true, false) => Symmetry::Mirror,
        (false, true) => Symmetry::Reciprocal,
        (false, false) => Symmetry::None,
    }
}

/// How many functions a model has, and how many nodes they are fitted to.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Size {
    terms: usize,
    half: usize,
    difference: usize,
    order: usize,
    grid: NodeGrid,
}

impl Size {
    /// Sizes that were the best at their bytes, for mirror symmetry and RGB: bytes, terms, splines over θh and θd, order
    /// of harmonics, nodes over θh, θd and half a turn of φd.
    const MEASURED: [[f64; 8]; 5] = [
        [300.0, 3.0, 16.0, 5.0, 2.0, 96.0, 20.0, 12.0],
        [1_000.0, 5.0, 28.0, 8.0, 4.0, 112.0, 26.0, 16.0],
        [2_700.0, 8.0, 40.0, 12.0, 7.0, 128.0, 32.0, 20.0],
        [8_192.0, 13.0, 56.0, 18.0, 8.0, 136.0, 40.0, 22.0],
        [33_000.0, 22.0, 80.0, 28.0, 13.0, 192.0, 56.0, 28.0],
    ];

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "between numbers of the table"
    )]
    fn for_bytes(bytes: usize, symmetry: Symmetry, channels: usize) -> Self {
        // What symmetry and grey save is spent on more functions.
        let count = |symmetry: Symmetry| symmetry.harmonics(8).len() as f64;
        let saved =
            count(Symmetry::Mirror) / count(symmetry) * if channels == 1 { 2.0 } else { 1.0 };
        let bytes = bytes as f64 * saved.sqrt();
        let table = &Self::MEASURED;
        let above = (1..table.len() - 1).find(|&i| table[i][0] > bytes).unwrap_or(table.len() - 1);
        let [low, high] = [table[above - 1], table[above]];
        let t = ((bytes / low[0]).ln() / (high[0] / low[0]).ln()).max(0.0);
        let at = |i: usize| (low[i] + t * (high[i] - low[i])).round() as usize;
        let order = at(4) + usize::from(symmetry.is_reciprocal() && at(4) % 2 == 1);
        Self {
            terms: at(1),
            half: at(2),
            difference: at(3),
            order,
            grid: NodeGrid { theta_h: at(5), theta_d: at(6), phi_d: at(7) },
        }
    }

    /// A smaller size on fewer nodes, which ranks axes and offsets as the whole one does.
    fn trial(size: Self) -> Self {
        Self {
            terms: size.terms.min(8),
            half: size.half.min(40),
            difference: size.difference.min(10),
            order: size.order.min(4),
            grid: NodeGrid { theta_h: 80, theta_d: 16, phi_d: 8 },
        }
    }

    fn shape(self, alpha: f64, symmetry: Symmetry, channels: usize) -> Shape {
        Shape {
            terms: self.terms,
            half: CubicBasis { count: self.half, is_even: true },
            axis: HalfAxis { alpha: f64::from(narrow(alpha)) },
            difference: CubicBasis { count: self.difference, is_even: false },
            symmetry,
            order: self.order,
            channels,
        }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "what stands in a stream is f32")]
fn narrow(value: f64) -> f32 {
    value as f32
}

/// Offsets and ranges of values for nodes.
fn channels_of(nodes: &Nodes, offset: f64) -> Vec<Channel> {
    let mean = nodes.mean();
    (0..nodes.channels)
        .map(|c| {
            let values = nodes.known().map(|node| narrow(node.value[c]));
            let range = values.fold([f32::MAX, 0.0], |[min, max], v| [v.min(min), v.max(max)]);
            Channel { offset: narrow((offset * mean[c]).max(1e-12)), range }
        })
        .collect()
}

fn offsets_of(channels: &[Channel]) -> [f64; 3] {
    std::array::from_fn(|c| channels.get(c).map_or(1.0, |channel| channel.offset.into()))
}

type Judge<'a> = &'a (dyn Fn(&Products, &[Channel]) -> f64 + Sync);

/// Tries axes, then offsets, then roughnesses, then shares of a prior, for each of which there are nodes; the middle
/// one of each first.
fn try_axes(
    nodes: &[(f64, Nodes)],
    size: Size,
    symmetry: Symmetry,
    roughnesses: &[f64],
    judge: Judge<'_>,
    job: &Job<'_>,
) -> Result<Vec<SplineTrial>, SplineError> {
    let count = ALPHAS.len() + OFFSETS.len() + roughnesses.len() + nodes.len() - 3;
    job.begin("trying axes", count as u64);
    let run = |trial: SplineTrial| {
        let with_prior = nodes.iter().find(|(share, _)| share.total_cmp(&trial.prior).is_eq());
        let nodes = with_prior.map_or(&nodes[0].1, |(_, nodes)| nodes);
        let channels = channels_of(nodes, trial.offset);
        let shape = size.shape(trial.alpha, symmetry, nodes.channels);
        let mut fit = Alternating::new(nodes, shape, offsets_of(&channels), trial.roughness);
        for step in 0..TRIAL_STEPS {
            if job.is_stopped() {
                break;
            }
            fit.step(step == 3);
        }
        job.advance(1);
        SplineTrial { score: judge(&fit.products(), &channels), ..trial }
    };
    let priors: Vec<f64> = nodes.iter().map(|(share, _)| *share).collect();
    let first = SplineTrial {
        alpha: middle(&ALPHAS),
        offset: middle(&OFFSETS),
        roughness: middle(roughnesses),
        prior: middle(&priors),
        score: f64::INFINITY,
    };
    let mut trials: Vec<SplineTrial> =
        ALPHAS.par_iter().map(|&alpha| run(SplineTrial { alpha, ..first })).collect();
    let mut try_others = |values: &[f64], change: fn(SplineTrial, f64) -> SplineTrial| {
        let so_far = best(&trials);
        let others: Vec<f64> =
            values.iter().copied().filter(|v| v.total_cmp(&middle(values)).is_ne()).collect();
        trials.par_extend(others.par_iter().map(|&value| run(change(so_far, value))));
    };
    try_others(&OFFSETS, |trial, offset| SplineTrial { offset, ..trial });
    try_others(roughnesses, |trial, roughness| SplineTrial { roughness, ..trial });
    try_others(&priors, |trial, prior| SplineTrial { prior, ..trial });
    job.check()?;
    Ok(trials)
}

fn middle(values: &[f64]) -> f64 {
    values[values.len() / 2]
}

fn finish(
    nodes: &Nodes,
    size: Size,
    symmetry: Symmetry,
    trial: SplineTrial,
    bytes: usize,
    job: &Job<'_>,
) -> Result<SplineFit, SplineError> {
    let channels = channels_of(nodes, trial.offset);
    let shape = size.shape(trial.alpha, symmetry, nodes.channels);
    let mut fit = Alternating::new(nodes, shape, offsets_of(&channels), trial.roughness);
    job.begin("fitting splines", STEPS as u64 + 2);
    for step in 0..STEPS {
        job.check()?;
        fit.step(REWEIGHED.contains(&step));
        job.advance(1);
    }
    fit.order_terms();
    fit.solve_difference();
    job.check()?;
    let quantized = quantize(&mut fit, &channels, bytes);
    job.advance(2);
    let zeros = nodes.known().flat_map(|node| &node.value[..nodes.channels]);
    Ok(SplineFit {
        zeros: zeros.filter(|v| **v <= 0.0).count(),
        model: SplineBrdf::new(&quantized, channels),
        nodes: nodes.known().count(),
        not_finite: nodes.not_finite,
        trials: Vec::new(),
        asymmetry: None,
    })
}
