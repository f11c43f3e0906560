//! The trait that every reflectance model of the project answers to.

use brdf_param::DirectionPair;

use crate::{DirectionBatch, Rgb, RgbBatch};

/// A bidirectional reflectance distribution function.
///
/// Implementors return values in sr⁻¹ without the cosine, never negative from [`Brdf::eval`], and
/// 0 where a direction is not above the surface (z > 0).
pub trait Brdf: Sync {
    /// The value for a pair of unit directions.
    fn eval(&self, pair: &DirectionPair) -> Rgb;

    /// The value before negative results were clamped to 0. The same as [`Brdf::eval`] for models
    /// that cannot go negative.
    fn eval_unclamped(&self, pair: &DirectionPair) -> Rgb {
        self.eval(pair)
    }

    /// Whether the model has data for the pair: measured tables have holes, and nothing has data
    /// below the horizon.
    fn has_data(&self, pair: &DirectionPair) -> bool {
        is_lit(pair)
    }

    /// Values for many pairs at once; `out` is resized to fit.
    ///
    /// Directions are f32 here, so values differ from [`Brdf::eval`] by rounding.
    fn eval_batch(&self, pairs: &DirectionBatch, out: &mut RgbBatch) {
        out.resize(pairs.len());
        for index in 0..pairs.len() {
            out.set(index, self.eval(&pairs.get(index)));
        }
    }
}

/// Both directions are strictly above the surface.
pub(crate) fn is_lit(pair: &DirectionPair) -> bool {
    pair.wi.z > 0.0 && pair.wo.z > 0.0
}
