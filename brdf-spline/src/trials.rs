//! Trials of what suits a material: small models, made fast and not rounded.

use brdf_job::{Job, Stopped};
use rayon::prelude::*;

use crate::alternating::Alternating;
use crate::channel::Channel;
use crate::harmonics::Symmetry;
use crate::nodes::Nodes;
use crate::products::Products;
use crate::size::Size;

/// What was chosen for a model, and what that came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SplineTrial {
    /// Angle up to which splines over θh are evenly spaced, radians.
    pub alpha: f64,
    /// a of ln(a + f), relative to the mean value of a channel.
    pub offset: f64,
    /// Weight of second differences, relative to that of what is fitted.
    pub roughness: f64,
    /// Lobes of the base of scattered samples, 0 without one.
    pub lobes: usize,
    /// Weight of the base beside the samples, relative to that of all samples.
    pub base_weight: f64,
    /// Which exchanges leave the model unchanged.
    pub symmetry: Symmetry,
    /// Bytes that the number of functions is usual for.
    pub size: usize,
    /// The geometric mean of errors of [`Fidelity::score`](brdf_model::Fidelity::score), or over scattered samples of
    /// [`FidelityErrors::score`](brdf_model::FidelityErrors::score).
    pub score: f64,
}

/// What is tried of each choice; those that are first stand in until their turn comes.
pub(crate) struct Choices<'a> {
    pub(crate) alphas: &'a [f64],
    pub(crate) offsets: &'a [f64],
    pub(crate) roughnesses: &'a [f64],
    pub(crate) lobes: &'a [usize],
    pub(crate) base_weights: &'a [f64],
    pub(crate) symmetries: &'a [Symmetry],
    pub(crate) sizes: &'a [usize],
}

impl<'a> Choices<'a> {
    /// Tries one choice after another, each with the best of those before.
    pub(crate) fn try_all(
        &self,
        score: &(dyn Fn(&SplineTrial) -> f64 + Sync),
        job: &Job<'_>,
    ) -> Result<Vec<SplineTrial>, Stopped> {
        let first = SplineTrial {
            alpha: self.alphas[0],
            offset: self.offsets[0],
            roughness: self.roughnesses[0],
            lobes: self.lobes[0],
            base_weight: self.base_weights[0],
            symmetry: self.symmetries[0],
            size: self.sizes[0],
            score: f64::INFINITY,
        };
        let choices = [
            self.alphas.len(),
            self.offsets.len(),
            self.roughnesses.len(),
            self.lobes.len(),
            self.base_weights.len(),
            self.symmetries.len(),
            self.sizes.len(),
        ];
        job.begin("trying axes", (1 + choices.map(|count| count - 1).iter().sum::<usize>()) as u64);
        let mut trials: Vec<SplineTrial> = Vec::new();
        let mut run = |changed: Vec<SplineTrial>| {
            trials.par_extend(changed.into_par_iter().map(|trial| {
                let score = score(&trial);
                job.advance(1);
                SplineTrial { score, ..trial }
            }));
            best(&trials)
        };
        let others = |values: &'a [f64]| values[1..].iter().copied();
        let at = run(self.alphas.iter().map(|&alpha| SplineTrial { alpha, ..first }).collect());
        let at = run(self.lobes[1..].iter().map(|&lobes| SplineTrial { lobes, ..at }).collect());
        let at = run(others(self.offsets).map(|offset| SplineTrial { offset, ..at }).collect());
        let at = run(others(self.roughnesses)
            .map(|roughness| SplineTrial { roughness, ..at })
            .collect());
        let at = run(others(self.base_weights)
            .map(|base_weight| SplineTrial { base_weight, ..at })
            .collect());
        let others = self.symmetries[1..].iter();
        let at = run(others.map(|&symmetry| SplineTrial { symmetry, ..at }).collect());
        run(self.sizes[1..].iter().map(|&size| SplineTrial { size, ..at }).collect());
        job.check()?;
        Ok(trials)
    }
}

/// What a symmetry is worth, as a part of the error: chance alone may favour a model without it.
const SYMMETRY_WORTH: f64 = 0.03;

/// Returns the first of the trials with the lowest error, those without a symmetry at a disadvantage.
pub(crate) fn best(trials: &[SplineTrial]) -> SplineTrial {
    let error = |trial: &SplineTrial| {
        let given_up = match trial.symmetry {
            Symmetry::Both => 0.0,
            Symmetry::Mirror | Symmetry::Reciprocal => 1.0,
            Symmetry::None => 2.0,
        };
        trial.score * (1.0 + SYMMETRY_WORTH * given_up)
    };
    let better = |best: SplineTrial, trial: &SplineTrial| {
        if error(trial) < error(&best) { *trial } else { best }
    };
    trials.iter().fold(trials[0], better)
}

/// Returns the model of a trial after so many steps.
pub(crate) fn try_out(
    nodes: &Nodes,
    size: Size,
    trial: &SplineTrial,
    steps: usize,
    job: &Job<'_>,
) -> (Products, Vec<Channel>) {
    let channels = channels_of(nodes, trial.offset);
    let mut fit = started(nodes, size, trial, &channels);
    for step in 0..steps {
        if job.is_stopped() {
            break;
        }
        fit.step(step == 3);
    }
    (fit.products(), channels)
}

/// Returns a fit by what was chosen, before its first step.
pub(crate) fn started<'a>(
    nodes: &'a Nodes,
    size: Size,
    trial: &SplineTrial,
    channels: &[Channel],
) -> Alternating<'a> {
    let shape = size.shape(trial.alpha, trial.symmetry, nodes.channels);
    let offsets =
        std::array::from_fn(|c| channels.get(c).map_or(1.0, |channel| channel.offset.into()));
    Alternating::new(nodes, shape, offsets, trial.roughness)
}

/// Offsets and ranges of values for nodes.
pub(crate) fn channels_of(nodes: &Nodes, offset: f64) -> Vec<Channel> {
    let mean = nodes.mean();
    (0..nodes.channels)
        .map(|c| {
            let values = nodes.known().map(|node| narrow(node.value[c]));
            let range = values.fold([f32::MAX, 0.0], |[min, max], v| [v.min(min), v.max(max)]);
            Channel { offset: narrow((offset * mean[c]).max(1e-12)), range }
        })
        .collect()
}

#[expect(clippy::cast_possible_truncation, reason = "what stands in a stream is f32")]
fn narrow(value: f64) -> f32 {
    value as f32
}
