//! The samples of a fit, with their coordinates, log values and weights, in an order that keeps
//! neighbours together.

use std::sync::OnceLock;

use brdf_model::{Dropped, MeasuredValue, SampleSet, log_offsets};
use brdf_param::{DirectionPair, DiscRadii, Space, polar_angle};
use glam::DVec3;

use crate::coordinate::Reading;
use crate::isotropic::Angles;
use crate::{
    ChannelTransform, Coordinate, Factor, FactorDescription, FactorError, FactorParams, FactorSpec,
    LogTransform, Weight,
};

/// A set of samples made ready for fitting factors of any coordinates.
///
/// The samples are in Morton order of their standard coordinates, so that samples which follow each
/// other read nearby texels under any projection; [`Problem::in_given_order`] undoes it.
#[derive(Clone, Debug)]
pub struct Problem {
    params: FactorParams,
    samples: SampleSet,
    /// Place of every sample in the set that was given.
    origin: Vec<usize>,
    maps: Vec<ChannelTransform>,
    weights: Vec<f64>,
    /// Fitted values of each channel.
    targets: Vec<Vec<f64>>,
    theta_max: f64,
    spaces: [OnceLock<SpacePoints>; 2],
    angles: OnceLock<Vec<Angles>>,
}

/// The coordinates of all samples in a space.
#[derive(Clone, Debug)]
struct SpacePoints {
    points: Vec<[f64; 4]>,
    radii: DiscRadii,
}

/// How far beyond the largest training radius a texture reaches, so that the outermost sample does
/// not stand on the very rim.
const RADIUS_MARGIN: f64 = 1.0001;
/// A texture is at least this wide, in parabolic units.
const SMALLEST_RADIUS: f64 = 1e-6;

impl Problem {
    /// Returns the problem of fitting these samples.
    ///
    /// # Errors
    ///
    /// [`FactorError::NoSamples`] where none can be fitted; [`FactorError::Option`] for an option outside its
    /// range.
    pub fn new(samples: &SampleSet, params: &FactorParams) -> Result<Self, FactorError> {
        params.check()?;
        let positive = (params.log_map == LogTransform::Log).then(|| samples.positive());
        let samples = positive.as_ref().unwrap_or(samples);
        if samples.is_empty() {
            return Err(FactorError::NoSamples { dropped: samples.dropped().to_string() });
        }
        let maps = ChannelTransform::for_samples(params.log_map, params.offset, samples);
        let origin = morton_order(samples);
        let sorted = samples.rearranged(&origin);
        let weights = weights(&sorted, params.weight, &maps);
        // The lowest direction is the one farthest from the normal.
        let lowest = |a: DVec3, b: DVec3| if b.z < a.z { b } else { a };
        let widest = polar_angle(
            sorted.pairs().fold(DVec3::Z, |low, pair| lowest(low, lowest(pair.wi, pair.wo))),
        );
        // A single direction along the normal would leave no room at all.
        let theta_max = params.theta_max.min(widest).max(1e-3);
        Ok(Self::assemble(*params, sorted, origin, maps, weights, theta_max))
    }

    fn assemble(
        params: FactorParams,
        samples: SampleSet,
        origin: Vec<usize>,
        maps: Vec<ChannelTransform>,
        weights: Vec<f64>,
        theta_max: f64,
    ) -> Self {
        let targets = maps
            .iter()
            .zip(samples.values())
            .map(|(map, values)| values.iter().map(|&f| map.forward(f)).collect())
            .collect();
        let spaces = [OnceLock::new(), OnceLock::new()];
        let angles = OnceLock::new();
        Self { params, samples, origin, maps, weights, targets, theta_max, spaces, angles }
    }

    /// Returns the problem over the first `count` of its samples, in the order in which they were given.
    ///
    /// Every leading part of a drawn set is spread evenly; measured rows should be shuffled first. Log maps
    /// and scales stay those of the whole problem.
    #[must_use]
    pub fn subset(&self, count: usize) -> Self {
        let keep: Vec<usize> = (0..self.len()).filter(|&at| self.origin[at] < count).collect();
        let origin = keep.iter().map(|&at| self.origin[at]).collect();
        let weights = keep.iter().map(|&at| self.weights[at]).collect();
        let samples = self.samples.select(&keep);
        let subset = Self::assemble(
            self.params,
            samples,
            origin,
            self.maps.clone(),
            weights,
            self.theta_max,
        );
        for (mine, theirs) in subset.spaces.iter().zip(&self.spaces) {
            if let Some(whole) = theirs.get() {
                let points = keep.iter().map(|&at| whole.points[at]).collect();
                mine.get_or_init(|| SpacePoints { points, radii: whole.radii });
            }
        }
        subset
    }

    /// Returns the problem of fitting what remains after these log values, one for each channel and sample,
    /// are subtracted.
    ///
    /// # Panics
    ///
    /// If there is not one value per sample and channel.
    #[must_use]
    pub fn subtract(&self, explained: &[Vec<f64>]) -> Self {
        assert_eq!(explained.len(), self.targets.len(), "one array per channel");
        let mut rest = self.clone();
        for (targets, given) in rest.targets.iter_mut().zip(explained) {
            assert_eq!(targets.len(), given.len(), "one value per sample");
            targets.iter_mut().zip(given).for_each(|(target, given)| *target -= given);
        }
        rest
    }

    /// Returns the problem with its smoothing raised to at least `mu`.
    #[must_use]
    pub fn smoothed(mut self, mu: f64) -> Self {
        self.params.smoothing = self.params.smoothing.max(mu);
        self
    }

    /// Returns the number of samples.
    pub fn len(&self) -> usize {
        self.samples.len()
    }

    /// Returns whether there are no samples; [`Problem::new`] makes no such problem.
    pub fn is_empty(&self) -> bool {
        self.samples.is_empty()
    }

    /// Returns the options of the fit.
    pub fn params(&self) -> &FactorParams {
        &self.params
    }

    /// Returns the log map of each channel.
    pub fn maps(&self) -> &[ChannelTransform] {
        &self.maps
    }

    /// Returns the log values of each channel, the targets of the fit; they have no unit.
    pub fn targets(&self) -> &[Vec<f64>] {
        &self.targets
    }

    /// Returns the values of each channel, in sr⁻¹.
    pub fn values(&self) -> &[Vec<f64>] {
        self.samples.values()
    }

    /// Returns the weight of each sample, ≥ 0, which all channels share.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// Returns the sum of the weights.
    pub fn total_weight(&self) -> f64 {
        self.weights.iter().sum()
    }

    /// Returns the largest angle to the normal that the model will be evaluated at, in radians.
    pub fn theta_max(&self) -> f64 {
        self.theta_max
    }

    /// Returns the numbers of samples that were left out, before the fit and by the log map.
    pub fn dropped(&self) -> Dropped {
        self.samples.dropped()
    }

    /// Returns the number of samples with a negative channel that was set to 0.
    pub fn clamped(&self) -> usize {
        self.samples.clamped()
    }

    /// Returns the pairs of the samples.
    pub fn pairs(&self) -> impl ExactSizeIterator<Item = DirectionPair> + '_ {
        self.samples.pairs()
    }

    /// Returns the coordinates of every sample in a space: first.x, first.y, second.x, second.y.
    pub fn points(&self, space: Space) -> &[[f64; 4]] {
        &self.space(space).points
    }

    /// Returns the number of values, of all channels, that are 0.
    pub fn zeros(&self) -> usize {
        self.values().iter().flatten().filter(|value| **value <= 0.0).count()
    }

    /// Returns the largest value of each channel, in sr⁻¹.
    pub fn largest_values(&self) -> Vec<f64> {
        let largest = |values: &Vec<f64>| values.iter().copied().fold(0.0, f64::max);
        self.samples.values().iter().map(largest).collect()
    }

    /// Returns, for each sample, its index in the order in which the samples were given.
    pub fn origin(&self) -> &[usize] {
        &self.origin
    }

    /// Returns one value for each sample, brought back to the order in which the samples were given.
    pub fn in_given_order(&self, values: &[f64]) -> Vec<f64> {
        let mut places: Vec<usize> = (0..self.len()).collect();
        places.sort_unstable_by_key(|&at| self.origin[at]);
        places.into_iter().map(|at| values[at]).collect()
    }

    /// Returns a factor whose texels are 0, scaled to the samples; of `size` texels along a side, unless it says
    /// otherwise.
    ///
    /// # Errors
    ///
    /// [`FactorError::TextureSize`] for a size that a texture cannot have; [`FactorError::Factors`] for
    /// coordinates that make no factor.
    pub fn empty_factor(&self, spec: &FactorSpec, size: usize) -> Result<Factor, FactorError> {
        let none = DiscRadii { first: SMALLEST_RADIUS, second: SMALLEST_RADIUS };
        let largest = spec
            .coordinates
            .iter()
            .map(|coordinate| match coordinate.reading() {
                Reading::Planar(plane) => plane.radii(self.space(plane.space).radii),
                Reading::Isotropic { axes, .. } => Coordinate::largest_angles(&axes, self.angles()),
                Reading::Radial(_) => coordinate.largest_radii(self.samples.pairs()),
            })
            .fold(none, DiscRadii::max);
        let radii = DiscRadii {
            first: RADIUS_MARGIN * largest.first,
            second: RADIUS_MARGIN * largest.second,
        };
        Factor::new(
            FactorDescription::new(&spec.coordinates, spec.grid(size), self.params.bound, radii)?,
            None,
        )
    }

    /// The angles of all samples.
    pub(crate) fn angles(&self) -> &[Angles] {
        let all = || self.samples.pairs().map(|pair| Angles::from_pair(&pair)).collect();
        self.angles.get_or_init(all)
    }

    fn space(&self, space: Space) -> &SpacePoints {
        let slot = match space {
            Space::Standard => &self.spaces[0],
            Space::HalfDifference => &self.spaces[1],
        };
        slot.get_or_init(|| {
            let mut radii = DiscRadii { first: 0.0, second: 0.0 };
            let points = self
                .samples
                .pairs()
                .map(|pair| {
                    let at = space.coordinates(&pair);
                    let (first, second) = (at.first.length(), at.second.length());
                    radii = radii.max(DiscRadii { first, second });
                    [at.first.x, at.first.y, at.second.x, at.second.y]
                })
                .collect();
            SpacePoints { points, radii }
        })
    }
}

/// One weight per sample, the same for all channels, so that one matrix serves them all.
fn weights(samples: &SampleSet, weight: Weight, maps: &[ChannelTransform]) -> Vec<f64> {
    let channels = samples.values().len() as f64;
    let mean = |index: usize| samples.values().iter().map(|c| c[index]).sum::<f64>() / channels;
    let weights: Vec<f64> = match weight {
        Weight::Log => vec![1.0; samples.len()],
        Weight::F => (0..samples.len()).map(mean).collect(),
        Weight::F2 => (0..samples.len()).map(|index| mean(index).powi(2)).collect(),
        Weight::Fidelity => fidelity_weights(samples, maps),
    };
    // A material that is black everywhere has nothing to weight by.
    if weights.iter().any(|&w| w > 0.0) { weights } else { vec![1.0; samples.len()] }
}

/// What the four measures of a [`brdf_model::FidelityErrors`] change with the fitted logarithms: squares of the slopes,
/// each measure over its mean, and none more than so many times the median.
fn fidelity_weights(samples: &SampleSet, maps: &[ChannelTransform]) -> Vec<f64> {
    /// Energy depends on the brightest samples alone.
    const PARTS: [f64; 4] = [1.0, 1.0, 0.3, 1.0];
    const CAP: f64 = 30.0;
    let offsets: Vec<f64> = maps
        .iter()
        .zip(log_offsets(samples))
        .map(|(map, usual)| match map {
            ChannelTransform::Offset { a } => *a,
            _ => usual,
        })
        .collect();
    let squares: Vec<[f64; 4]> = samples
        .pairs()
        .enumerate()
        .map(|(index, pair)| {
            let channels = samples.values().iter().zip(&offsets);
            channels.fold([0.0; 4], |sum, (values, &offset)| {
                let (value, cosine) = (values[index], pair.wi.z);
                let slopes = MeasuredValue { value, cosine, offset }.slopes();
                std::array::from_fn(|m| sum[m] + slopes[m] * slopes[m])
            })
        })
        .collect();
    let count = squares.len() as f64;
    let factors: [f64; 4] = std::array::from_fn(|m| {
        let mean = squares.iter().map(|square| square[m]).sum::<f64>() / count;
        PARTS[m] / mean.max(f64::MIN_POSITIVE)
    });
    let mut weights: Vec<f64> = squares
        .iter()
        .map(|square| square.iter().zip(factors).map(|(square, factor)| square * factor).sum())
        .collect();
    let mut sorted = weights.clone();
    let middle = sorted.len() / 2;
    let (_, median, _) = sorted.select_nth_unstable_by(middle, f64::total_cmp);
    let cap = CAP * *median;
    weights.iter_mut().for_each(|weight| *weight = weight.min(cap));
    weights
}

/// Indices of the samples along a Morton curve through their standard coordinates.
fn morton_order(samples: &SampleSet) -> Vec<usize> {
    let mut keyed: Vec<(u64, usize)> = samples
        .pairs()
        .enumerate()
        .map(|(index, pair)| {
            let at = Space::Standard.coordinates(&pair);
            (morton_key([at.first.x, at.first.y, at.second.x, at.second.y]), index)
        })
        .collect();
    keyed.sort_unstable();
    keyed.into_iter().map(|(_, index)| index).collect()
}

/// Bits of four coordinates in [−1, 1], interleaved.
fn morton_key(point: [f64; 4]) -> u64 {
    const BITS: u32 = 8;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to a byte"
    )]
    let cells = point.map(|x| (128.0 * (x + 1.0)).clamp(0.0, 255.0) as u64);
    let mut key = 0;
    for bit in (0..BITS).rev() {
        for cell in cells {
            key = key << 1 | (cell >> bit & 1);
        }
    }
    key
}

#[cfg(test)]
mod tests {
    use brdf_model::{Channels, PairSampling, Preset};

    use super::*;

    #[test]
    fn thinning_keeps_scales_and_the_given_order_returns() {
        let sampling = PairSampling { count: 500, seed: 1, theta_max: 1.2 };
        let samples = SampleSet::draw(&Preset::ALL[0].brdf(), &sampling, Channels::Luminance);
        let problem = Problem::new(&samples, &FactorParams::default()).unwrap();
        let radius = problem.space(Space::HalfDifference).radii;
        assert_eq!(problem.in_given_order(&problem.values()[0]), samples.values()[0]);
        let thin = problem.subset(50);
        assert_eq!((thin.len(), thin.space(Space::HalfDifference).radii), (50, radius));
        assert_eq!(thin.in_given_order(&thin.values()[0]), samples.values()[0][..50]);
    }
}
