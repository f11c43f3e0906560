//! The traits of reflectance models and of samplers of directions.

use brdf_param::DirectionPair;
use glam::DVec3;

use crate::{DirectionSlices, Rgb, RgbBatch};

/// A bidirectional reflectance distribution function.
///
/// Implementors return values in sr⁻¹ without the cosine, never negative from [`Brdf::eval`], and
/// 0 where a direction is not above the surface (z > 0).
///
/// ```
/// use brdf_model::{Brdf, Rgb};
/// use brdf_param::DirectionPair;
///
/// struct White;
///
/// impl Brdf for White {
///     fn eval(&self, pair: &DirectionPair) -> Rgb {
///         let is_lit = pair.wi.z > 0.0 && pair.wo.z > 0.0;
///         Rgb::splat(if is_lit { std::f64::consts::FRAC_1_PI } else { 0.0 })
///     }
/// }
///
/// let pair = DirectionPair::from_angles(0.2, 0.0, 0.7, 1.0);
/// assert!(White.has_data(&pair) && White.eval(&pair).g > 0.3);
/// ```
#[doc(alias = "BxDF")]
pub trait Brdf: Send + Sync {
    /// Returns the value for a pair of unit directions, in sr⁻¹, without the cosine, never negative.
    fn eval(&self, pair: &DirectionPair) -> Rgb;

    /// Returns the value for a pair before negative results are clamped to 0.
    ///
    /// It equals [`Brdf::eval`] for models that cannot go negative.
    fn eval_unclamped(&self, pair: &DirectionPair) -> Rgb {
        self.eval(pair)
    }

    /// Returns whether the model has data for the pair.
    ///
    /// Measured tables have holes, and nothing has data below the horizon.
    fn has_data(&self, pair: &DirectionPair) -> bool {
        is_lit(pair)
    }

    /// Writes the values of many pairs to `out`, in f64, equal to those of [`Brdf::eval`]; `out` is
    /// resized to fit.
    fn eval_pairs(&self, pairs: &[DirectionPair], out: &mut Vec<Rgb>) {
        out.clear();
        out.extend(pairs.iter().map(|pair| self.eval(pair)));
    }

    /// Writes the values of many pairs to `out`, in f32; `out` is resized to fit.
    ///
    /// The values differ from those of [`Brdf::eval`] by rounding. Some models have a fast way for
    /// this; the others are evaluated pair by pair.
    ///
    /// ```
    /// use brdf_model::{Brdf, DirectionBatch, PairSampling, Preset, RgbBatch};
    ///
    /// let paint = Preset::ALL[0].brdf();
    /// let pairs: Vec<_> = PairSampling { count: 100, seed: 1, theta_max: 1.3 }.pairs().collect();
    /// let batch: DirectionBatch = pairs.iter().collect();
    /// let mut values = RgbBatch::default();
    /// paint.eval_batch(batch.as_slices(), &mut values);
    /// let expected = paint.eval(&pairs[7]).g;
    /// assert!((values.get(7).g - expected).abs() < 1e-4 * expected);
    /// ```
    fn eval_batch(&self, pairs: DirectionSlices<'_>, out: &mut RgbBatch) {
        out.resize(pairs.len());
        for index in 0..pairs.len() {
            out.set(index, self.eval(&pairs.get(index)));
        }
    }
}

impl<B: Brdf + ?Sized> Brdf for &B {
    fn eval(&self, pair: &DirectionPair) -> Rgb {
        (**self).eval(pair)
    }

    fn eval_unclamped(&self, pair: &DirectionPair) -> Rgb {
        (**self).eval_unclamped(pair)
    }

    fn has_data(&self, pair: &DirectionPair) -> bool {
        (**self).has_data(pair)
    }

    fn eval_pairs(&self, pairs: &[DirectionPair], out: &mut Vec<Rgb>) {
        (**self).eval_pairs(pairs, out);
    }

    fn eval_batch(&self, pairs: DirectionSlices<'_>, out: &mut RgbBatch) {
        (**self).eval_batch(pairs, out);
    }
}

/// A sampler of unit directions whose pdf is known.
///
/// ```
/// use brdf_model::{DirectionSampler, cosine_hemisphere};
/// use glam::DVec3;
///
/// struct Cosine;
///
/// impl DirectionSampler for Cosine {
///     fn sample(&self, [u, v]: [f64; 2]) -> (DVec3, f64) {
///         cosine_hemisphere(u, v)
///     }
///
///     fn pdf(&self, direction: DVec3) -> f64 {
///         direction.z.max(0.0) / std::f64::consts::PI
///     }
/// }
///
/// let (direction, pdf) = Cosine.sample([0.3, 0.8]);
/// assert!((pdf - Cosine.pdf(direction)).abs() < 1e-12);
/// ```
#[doc(alias = "importance sampling")]
pub trait DirectionSampler {
    /// Returns a unit direction and its pdf per steradian, from two numbers in [0, 1).
    fn sample(&self, u: [f64; 2]) -> (DVec3, f64);

    /// Returns the pdf, per steradian, with which [`DirectionSampler::sample`] draws a unit direction.
    fn pdf(&self, direction: DVec3) -> f64;
}

/// Both directions are strictly above the surface.
pub(crate) fn is_lit(pair: &DirectionPair) -> bool {
    pair.wi.z > 0.0 && pair.wo.z > 0.0
}
