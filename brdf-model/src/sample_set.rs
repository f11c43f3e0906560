//! Sets of BRDF samples, and the counts of samples that were left out.

use std::fmt;

use brdf_param::DirectionPair;
use glam::DVec3;
use rand_core::{Rng as _, SeedableRng as _};
use rand_xoshiro::SplitMix64;
use serde::{Deserialize, Serialize};

use crate::{Brdf, Channels, PairSampling, Rgb};

/// The numbers of samples that were left out of a set, by reason.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Dropped {
    /// A direction lies below the surface or along it.
    pub below_horizon: usize,
    /// A direction lies farther from the normal than the grazing limit.
    pub beyond_grazing_limit: usize,
    /// A direction or value is NaN or infinite.
    pub not_finite: usize,
    /// A channel is negative.
    pub negative: usize,
    /// A tabulated material has no valid data there.
    pub no_data: usize,
    /// A channel is exactly zero and a plain logarithm was asked for.
    pub zero: usize,
}

impl Dropped {
    /// Returns the number of all samples that were left out.
    pub fn total(&self) -> usize {
        self.below_horizon
            + self.beyond_grazing_limit
            + self.not_finite
            + self.negative
            + self.no_data
            + self.zero
    }
}

impl fmt::Display for Dropped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} below the horizon, {} beyond the grazing limit, {} not finite, {} negative, {} \
             without data, {} zero under a plain logarithm",
            self.below_horizon,
            self.beyond_grazing_limit,
            self.not_finite,
            self.negative,
            self.no_data,
            self.zero
        )
    }
}

/// A set of samples: direction pairs with one value for each channel, as a structure of arrays.
///
/// Every pair lies above the horizon and every value is finite and not negative.
///
/// ```
/// use brdf_model::{Channels, PairSampling, Preset, Rgb, SampleSet};
/// use brdf_param::DirectionPair;
///
/// let sampling = PairSampling { count: 100, seed: 1, theta_max: 1.3 };
/// let mut samples = SampleSet::draw(&Preset::ALL[0].brdf(), &sampling, Channels::Rgb);
/// samples.push_rgb(&DirectionPair::from_angles(0.1, 0.0, 0.2, 0.0), Rgb::splat(-1.0));
/// assert_eq!(samples.len(), 100);
/// assert_eq!(samples.dropped().negative, 1);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SampleSet {
    wi: Vec<DVec3>,
    wo: Vec<DVec3>,
    /// One array per channel, each as long as `wi`, in sr⁻¹.
    values: Vec<Vec<f64>>,
    dropped: Dropped,
    clamped: usize,
}

impl SampleSet {
    /// Returns an empty set.
    pub fn new(channels: Channels) -> Self {
        Self {
            wi: Vec::new(),
            wo: Vec::new(),
            values: vec![Vec::new(); channels.count()],
            dropped: Dropped::default(),
            clamped: 0,
        }
    }

    /// Returns the samples of a model at the pairs that `sampling` draws.
    ///
    /// Pairs without valid data are counted, not replaced. Negative channels become 0, and are counted
    /// too.
    pub fn draw(brdf: &dyn Brdf, sampling: &PairSampling, channels: Channels) -> Self {
        let mut set = Self::new(channels);
        for pair in sampling.pairs() {
            if brdf.has_data(&pair) {
                set.push_clamped(&pair, brdf.eval_unclamped(&pair));
            } else {
                set.dropped.no_data += 1;
            }
        }
        set
    }

    /// Adds a sample with its negative channels set to 0, and counts it if there were any.
    ///
    /// Colours outside the gamut have such channels. A set of one channel takes the luminance, which is
    /// positive for most of those colours.
    pub fn push_clamped(&mut self, pair: &DirectionPair, value: Rgb) {
        let value = match self.channels() {
            Channels::Rgb => value,
            Channels::Luminance => Rgb::splat(value.luminance()),
        };
        self.clamped += usize::from(value.channels().iter().any(|&v| v < 0.0));
        self.push_rgb(pair, value.map(|v| if v < 0.0 { 0.0 } else { v }));
    }

    /// Returns the number of samples with a negative channel that was set to 0.
    pub fn clamped(&self) -> usize {
        self.clamped
    }

    /// Adds a sample, or counts why it cannot be used. A set of one channel takes the luminance.
    pub fn push_rgb(&mut self, pair: &DirectionPair, value: Rgb) {
        match self.channels() {
            Channels::Rgb => self.push(pair, &value.channels()),
            Channels::Luminance => self.push(pair, &[value.luminance()]),
        }
    }

    /// Adds a sample, or counts why it cannot be used.
    ///
    /// # Panics
    ///
    /// If `values` has not one entry per channel.
    pub fn push(&mut self, pair: &DirectionPair, values: &[f64]) {
        assert_eq!(values.len(), self.values.len(), "one value per channel");
        let finite = pair.wi.is_finite() && pair.wo.is_finite();
        if !finite || values.iter().any(|v| !v.is_finite()) {
            self.dropped.not_finite += 1;
        } else if pair.wi.z <= 0.0 || pair.wo.z <= 0.0 {
            self.dropped.below_horizon += 1;
        } else if values.iter().any(|&v| v < 0.0) {
            self.dropped.negative += 1;
        } else {
            self.push_unchecked(pair, values.iter().copied());
        }
    }

    fn push_unchecked(&mut self, pair: &DirectionPair, values: impl Iterator<Item = f64>) {
        self.wi.push(pair.wi);
        self.wo.push(pair.wo);
        for (channel, value) in self.values.iter_mut().zip(values) {
            channel.push(value);
        }
    }

    /// Returns the number of samples.
    pub fn len(&self) -> usize {
        self.wi.len()
    }

    /// Returns whether there are no samples.
    pub fn is_empty(&self) -> bool {
        self.wi.is_empty()
    }

    /// Returns the channels of the set: one or three.
    pub fn channels(&self) -> Channels {
        if self.values.len() == 1 { Channels::Luminance } else { Channels::Rgb }
    }

    /// Returns the values of each channel, in sr⁻¹.
    pub fn values(&self) -> &[Vec<f64>] {
        &self.values
    }

    /// Returns the numbers of samples that were left out so far.
    pub fn dropped(&self) -> Dropped {
        self.dropped
    }

    /// Returns the samples whose channels are all positive, for logarithms without an offset.
    ///
    /// The others are counted. A channel that is zero everywhere is not looked at.
    pub fn positive(&self) -> Self {
        let lit: Vec<&Vec<f64>> =
            self.values.iter().filter(|channel| channel.iter().any(|&v| v > 0.0)).collect();
        let keep: Vec<usize> =
            (0..self.len()).filter(|&i| lit.iter().all(|channel| channel[i] > 0.0)).collect();
        let mut kept = self.select(&keep);
        kept.dropped = self.dropped;
        kept.clamped = self.clamped;
        kept.dropped.zero += self.len() - keep.len();
        kept
    }

    /// Returns the pair at `index`.
    ///
    /// # Panics
    ///
    /// If `index` is out of range.
    pub fn pair(&self, index: usize) -> DirectionPair {
        DirectionPair::new(self.wi[index], self.wo[index])
    }

    /// Returns the pairs in order.
    pub fn pairs(&self) -> impl ExactSizeIterator<Item = DirectionPair> + '_ {
        self.wi.iter().zip(&self.wo).map(|(&wi, &wo)| DirectionPair::new(wi, wo))
    }

    /// Returns the value at `index`, in sr⁻¹; that of a set of one channel is grey.
    ///
    /// # Panics
    ///
    /// If `index` is out of range.
    pub fn rgb(&self, index: usize) -> Rgb {
        match &self.values[..] {
            [grey] => Rgb::splat(grey[index]),
            [r, g, b] => Rgb::new(r[index], g[index], b[index]),
            _ => unreachable!("a set has one or three channels"),
        }
    }

    /// Returns the mean value of each channel, in sr⁻¹; 0 for an empty set.
    pub fn mean(&self) -> Vec<f64> {
        let count = self.len().max(1) as f64;
        self.values.iter().map(|channel| channel.iter().sum::<f64>() / count).collect()
    }

    /// Returns the samples that a model has data for; the others are counted.
    pub fn with_data_in(&self, model: &dyn Brdf) -> Self {
        let keep: Vec<usize> = (0..self.len()).filter(|&i| model.has_data(&self.pair(i))).collect();
        let mut kept = Self { dropped: self.dropped, clamped: self.clamped, ..self.select(&keep) };
        kept.dropped.no_data += self.len() - keep.len();
        kept
    }

    /// Returns at most `count` of the samples, evenly spread over their order.
    ///
    /// The counts of samples that were left out are kept.
    pub fn subset(&self, count: usize) -> Self {
        let count = count.min(self.len());
        let keep: Vec<usize> = (0..count).map(|i| i * self.len() / count.max(1)).collect();
        self.rearranged(&keep)
    }

    /// Returns whether the light comes from one azimuth in all samples, to 0.1°.
    ///
    /// Such samples cannot tell whether the material is anisotropic. Directions at the pole have no
    /// azimuth and are not looked at.
    pub fn has_one_light_azimuth(&self) -> bool {
        let azimuths = || self.wi.iter().filter_map(|wi| wi.truncate().try_normalize());
        let first = azimuths().next();
        first.is_none_or(|first| azimuths().all(|other| first.perp_dot(other).abs() < 2e-3))
    }

    /// Returns the samples at these indices; the counts of samples that were left out start at 0.
    ///
    /// # Panics
    ///
    /// If an index is out of range.
    pub fn select(&self, indices: &[usize]) -> Self {
        Self {
            wi: indices.iter().map(|&i| self.wi[i]).collect(),
            wo: indices.iter().map(|&i| self.wo[i]).collect(),
            values: self
                .values
                .iter()
                .map(|channel| indices.iter().map(|&i| channel[i]).collect())
                .collect(),
            dropped: Dropped::default(),
            clamped: 0,
        }
    }

    /// Returns the samples in the order of these indices; the counts of samples that were left out are
    /// kept.
    ///
    /// # Panics
    ///
    /// If an index is out of range.
    #[must_use]
    pub fn rearranged(&self, order: &[usize]) -> Self {
        Self { dropped: self.dropped, clamped: self.clamped, ..self.select(order) }
    }

    /// Returns the samples as luminance, in one channel; a set of one channel stays as it is.
    pub fn to_luminance(&self) -> Self {
        let values = match self.channels() {
            Channels::Luminance => self.values.clone(),
            Channels::Rgb => vec![(0..self.len()).map(|i| self.rgb(i).luminance()).collect()],
        };
        Self {
            wi: self.wi.clone(),
            wo: self.wo.clone(),
            values,
            dropped: self.dropped,
            clamped: self.clamped,
        }
    }

    /// Returns the samples in a random order, so that every leading part is a fair selection.
    #[must_use]
    pub fn shuffled(&self, seed: u64) -> Self {
        let mut rng = SplitMix64::seed_from_u64(seed);
        let mut keyed: Vec<(u64, usize)> = (0..self.len()).map(|i| (rng.next_u64(), i)).collect();
        keyed.sort_unstable();
        self.rearranged(&keyed.into_iter().map(|(_, index)| index).collect::<Vec<_>>())
    }

    /// Returns the samples whose directions both lie within `theta_max` radians of the normal; the
    /// others are counted.
    pub fn within(&self, theta_max: f64) -> Self {
        // A sample measured at exactly the limit, in degrees with six digits, belongs to it.
        let limit = (theta_max + 1e-6).cos();
        let keep: Vec<usize> =
            (0..self.len()).filter(|&i| self.wi[i].z >= limit && self.wo[i].z >= limit).collect();
        let mut kept = self.select(&keep);
        kept.dropped = self.dropped;
        kept.clamped = self.clamped;
        kept.dropped.beyond_grazing_limit += self.len() - keep.len();
        kept
    }

    /// Returns the samples turned about the normal in `rotations` equal steps of a turn, each with its
    /// reciprocal twin where `reciprocal` is set.
    ///
    /// An isotropic, reciprocal material has the same values at all of these pairs, so they extend a
    /// measurement to where nothing was measured.
    ///
    /// ```
    /// use brdf_model::{Channels, Rgb, SampleSet};
    /// use brdf_param::DirectionPair;
    ///
    /// let mut samples = SampleSet::new(Channels::Rgb);
    /// samples.push_rgb(&DirectionPair::from_angles(0.1, 0.0, 0.4, 2.0), Rgb::splat(0.2));
    /// assert_eq!(samples.replicated(4, true).len(), 8);
    /// ```
    pub fn replicated(&self, rotations: u32, reciprocal: bool) -> Self {
        let mut set =
            Self { dropped: self.dropped, clamped: self.clamped, ..Self::new(self.channels()) };
        for index in 0..self.len() {
            let pair = self.pair(index);
            for step in 0..rotations.max(1) {
                let turn = std::f64::consts::TAU * f64::from(step) / f64::from(rotations.max(1));
                let turned = pair.rotated_about_normal(turn);
                let values = |values: &[Vec<f64>]| -> Vec<f64> {
                    values.iter().map(|channel| channel[index]).collect()
                };
                set.push_unchecked(&turned, values(&self.values).into_iter());
                if reciprocal {
                    set.push_unchecked(&turned.swapped(), values(&self.values).into_iter());
                }
            }
        }
        set
    }

    /// Returns the indices of `folds` parts of the samples, of nearly equal size.
    ///
    /// The split depends on `seed` alone. Samples that an isotropic, reciprocal material cannot tell
    /// apart are in the same part.
    pub fn folds(&self, folds: usize, seed: u64) -> Vec<Vec<usize>> {
        let mut groups: Vec<(u64, TwinKey, usize)> = (0..self.len())
            .map(|index| {
                let key = TwinKey::new(&self.pair(index));
                (key.hash(seed), key, index)
            })
            .collect();
        groups.sort_unstable();
        let mut parts = vec![Vec::new(); folds];
        let mut group = 0;
        for (position, entry) in groups.iter().enumerate() {
            if position > 0 && groups[position - 1].1 != entry.1 {
                group += 1;
            }
            parts[group % folds].push(entry.2);
        }
        parts.iter_mut().for_each(|part| part.sort_unstable());
        parts
    }
}

/// What twins under rotation, mirroring and reciprocity have in common, rounded to 1e-6.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct TwinKey([i64; 3]);

impl TwinKey {
    fn new(pair: &DirectionPair) -> Self {
        let (a, b) = (pair.wi.z.min(pair.wo.z), pair.wi.z.max(pair.wo.z));
        #[expect(clippy::cast_possible_truncation, reason = "cosines times a million")]
        let rounded = |v: f64| (v * 1e6).round() as i64;
        Self([rounded(a), rounded(b), rounded(pair.wi.dot(pair.wo))])
    }

    /// A deterministic shuffle key.
    fn hash(self, seed: u64) -> u64 {
        self.0.iter().fold(seed, |state, &part| {
            let mixed = (state ^ part.cast_unsigned()).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            mixed ^ (mixed >> 29)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair() -> DirectionPair {
        DirectionPair::from_angles(0.4, 0.1, 0.7, 2.0)
    }

    #[test]
    fn unusable_samples_are_counted_by_reason() {
        let mut set = SampleSet::new(Channels::Luminance);
        set.push(&pair(), &[f64::NAN]);
        set.push(&pair(), &[-1.0]);
        set.push(&DirectionPair::new(-DVec3::Z, DVec3::Z), &[1.0]);
        set.push(&DirectionPair::new(DVec3::NAN, DVec3::Z), &[1.0]);
        set.push(&pair(), &[0.0]);
        let expected =
            Dropped { below_horizon: 1, not_finite: 2, negative: 1, ..Dropped::default() };
        assert_eq!((set.len(), set.dropped()), (1, expected));
        assert_eq!(set.within(0.5).dropped().beyond_grazing_limit, 1);
    }

    #[test]
    fn twins_never_part() {
        let mut set = SampleSet::new(Channels::Luminance);
        for step in 0..50 {
            set.push(&DirectionPair::from_angles(0.02 * f64::from(step), 0.0, 0.6, 1.0), &[1.0]);
        }
        let twins = set.replicated(4, true);
        let parts = twins.folds(10, 1);
        assert_eq!(parts.iter().map(Vec::len).sum::<usize>(), twins.len());
        for part in parts {
            for index in part.iter() {
                let family = index / 8;
                assert!(
                    (family * 8..family * 8 + 8).all(|twin| part.binary_search(&twin).is_ok()),
                    "family {family} was split"
                );
            }
        }
    }
}
