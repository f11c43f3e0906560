//! Fits: which axis, which offset, how many functions, and how coarse coefficients may be.

use brdf_job::Job;
use brdf_model::{Brdf, Channels};

use crate::alternating::ROUGHNESS;
use crate::error::SplineError;
use crate::harmonics::Symmetry;
use crate::judges::Judges;
use crate::model::SplineBrdf;
use crate::nodes::Nodes;
use crate::rounding::quantize;
use crate::size::Size;
use crate::trials::{Choices, SplineTrial, best, channels_of, started, try_out};

/// Bytes that a model may have.
pub const SPLINE_BYTES: std::ops::RangeInclusive<usize> = 300..=200_000;

/// α of the axis of θh that are tried, radians.
pub(crate) const ALPHAS: [f64; 3] = [0.004, 0.014, 0.05];
/// Offsets a that are tried, relative to the mean of a channel.
pub(crate) const OFFSETS: [f64; 3] = [1e-3, 1e-4, 5e-3];
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
    /// What was chosen for an earlier fit, to be taken as it is; none to try.
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
    /// What was chosen: of the trials, if there were any.
    pub chosen: SplineTrial,
    /// What was tried, with its errors.
    pub trials: Vec<SplineTrial>,
    /// Errors of the material against its mirror image, and against itself with light and viewer exchanged, as far as
    /// that was looked at.
    pub asymmetry: Option<[f64; 2]>,
}

/// Returns the model of an isotropic material in at most so many bytes.
///
/// The material is read at nodes that crowd at the mirror direction, all at azimuth φh = 0. Weights are such that the
/// geometric mean of the errors of [`Fidelity`](brdf_model::Fidelity) falls. Which axis of θh and which offset of the logarithm suit the
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
    let trials = match settings.axis {
        Some(axis) => vec![axis],
        None => {
            let choices = Choices {
                alphas: &ALPHAS,
                offsets: &OFFSETS,
                roughnesses: &[ROUGHNESS],
                lobes: &[0],
                base_weights: &[0.0],
                symmetries: &[symmetry],
                sizes: &[settings.bytes],
            };
            let score = |trial: &SplineTrial| {
                let (products, channels) =
                    try_out(&nodes, Size::trial(size), trial, TRIAL_STEPS, &trying);
                judges.score(&products, &channels)
            };
            choices.try_all(&score, &trying)?
        }
    };
    let best = best(&trials);

    let nodes = Nodes::of_grid(brdf, size.grid, symmetry, channels);
    let mut made = finish(&nodes, size, best, settings.bytes, &fitting)?;
    made.trials = trials;
    made.asymmetry = found;
    Ok(made)
}

pub(crate) fn check_bytes(bytes: usize) -> Result<(), SplineError> {
    if SPLINE_BYTES.contains(&bytes) {
        return Ok(());
    }
    Err(SplineError::Bytes { bytes, min: *SPLINE_BYTES.start(), max: *SPLINE_BYTES.end() })
}

pub(crate) fn check_data(nodes: &Nodes) -> Result<(), SplineError> {
    let is_black = nodes.measured().all(|node| node.value.iter().all(|v| *v <= 0.0));
    if is_black { Err(SplineError::NoData { nodes: nodes.measured().count() }) } else { Ok(()) }
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

/// Returns the rounded model by what was chosen.
pub(crate) fn finish(
    nodes: &Nodes,
    size: Size,
    trial: SplineTrial,
    bytes: usize,
    job: &Job<'_>,
) -> Result<SplineFit, SplineError> {
    let channels = channels_of(nodes, trial.offset);
    let mut fit = started(nodes, size, &trial, &channels);
    job.begin("fitting splines", STEPS as u64 + 2);
    for step in 0..STEPS {
        job.check()?;
        fit.step(REWEIGHED.contains(&step));
        job.advance(1);
    }
    fit.order_terms();
    fit.solve_difference();
    job.check()?;
    let base = nodes.base.as_ref().map(|base| base.lobes.clone());
    let quantized = quantize(&mut fit, &channels, base.as_ref(), bytes);
    job.advance(2);
    let zeros = nodes.measured().flat_map(|node| &node.value[..nodes.channels]);
    Ok(SplineFit {
        zeros: zeros.filter(|v| **v <= 0.0).count(),
        model: SplineBrdf::new(&quantized, channels, base),
        nodes: nodes.measured().count(),
        not_finite: nodes.not_finite,
        chosen: trial,
        trials: Vec::new(),
        asymmetry: None,
    })
}
