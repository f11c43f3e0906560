//! The traits that reflectance models and whatever draws directions answer to.

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
    /// Returns the value for a pair of unit directions.
    fn eval(&self, pair: &DirectionPair) -> Rgb;

    /// Returns the value before negative results are clamped to 0. The same as [`Brdf::eval`] for models
    /// that cannot go negative.
    fn eval_unclamped(&self, pair: &DirectionPair) -> Rgb {
        self.eval(pair)
    }

    /// Returns whether the model has data for the pair: measured tables have holes, and nothing has data
    /// below the horizon.
    fn has_data(&self, pair: &DirectionPair) -> bool {
        is_lit(pair)
    }

    /// Writes the values of many pairs, in f64: those of [`Brdf::eval`]. `out` is resized to fit.
    fn eval_pairs(&self, pairs: &[DirectionPair], out: &mut Vec<Rgb>) {
        out.clear();
        out.extend(pairs.iter().map(|pair| self.eval(pair)));
    }

    /// Writes the values of many pairs, in f32, which differ from [`Brdf::eval`] by rounding; `out` is resized to
    /// fit. The fast way for models that have one.
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

/// Something that draws directions.
#[doc(alias = "importance sampling")]
pub trait DirectionSampler {
    /// Returns a unit direction and its pdf per steradian, from two numbers in [0, 1).
    fn sample(&self, u: [f64; 2]) -> (DVec3, f64);

    /// Returns the pdf, per steradian, with which [`DirectionSampler::sample`] gives a unit direction.
    fn pdf(&self, direction: DVec3) -> f64;
}

/// Both directions are strictly above the surface.
pub(crate) fn is_lit(pair: &DirectionPair) -> bool {
    pair.wi.z > 0.0 && pair.wo.z > 0.0
}
