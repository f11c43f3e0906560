//! What is extracted: a sum of products weighted by maps.

use std::f64::consts::PI;

use brdf_factor::SurfaceProduct;
use brdf_model::Rgb;
use brdf_param::DirectionPair;
use brdf_render::{SpatiallyVarying, TexturePoint};
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use serde::Serialize;

use crate::{CoefficientMap, PaintErrors, PaintSamples};

/// One summand of a [`PaintedMaterial`].
#[derive(Clone, Debug, PartialEq)]
pub struct Component {
    /// Weight of the summand at each place; 1 everywhere without a map.
    pub coefficients: Option<CoefficientMap>,
    /// Reflectance of the summand, f π.
    pub product: SurfaceProduct,
}

/// Counts of values that a material cannot have, and that were cut.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Clamped {
    /// Samples at which a product was below 0.
    pub below_zero: usize,
    /// Samples above the brightest that was painted.
    pub above_limit: usize,
}

/// A material that varies over a surface: Σ c_j(u, v) f_j(wi, wo) (Eq. 19).
#[doc(alias = "SVBRDF")]
#[derive(Clone, Debug, PartialEq)]
pub struct PaintedMaterial {
    /// The summands.
    pub components: Vec<Component>,
    /// The brightest value of each channel that was painted. Values are not above it: between directions that
    /// were painted and the horizon products of factors reach any height.
    pub limit: [f64; 3],
}

impl PaintedMaterial {
    /// Returns how many samples have a product that was negative and counted as 0, or a sum above the brightest that
    /// was painted, which was cut to it.
    pub fn clamped(&self, samples: &PaintSamples) -> Clamped {
        let each = samples.pairs.par_iter().zip(&samples.places).map(|(pair, place)| {
            let products = self.components.iter().map(|c| c.product.eval_unclamped(pair, *place));
            let is_negative =
                products.into_iter().any(|value| value.channels().iter().any(|v| *v < 0.0));
            let sum = self.sum(pair, *place).channels();
            let is_above = sum.iter().zip(self.limit).any(|(v, limit)| *v > limit);
            Clamped { below_zero: usize::from(is_negative), above_limit: usize::from(is_above) }
        });
        each.reduce(Clamped::default, |a, b| Clamped {
            below_zero: a.below_zero + b.below_zero,
            above_limit: a.above_limit + b.above_limit,
        })
    }

    /// Returns f π at a place, linear RGB, from 0 to the brightest that was painted.
    pub fn value(&self, pair: &DirectionPair, place: DVec2) -> Rgb {
        let [r, g, b] = self.sum(pair, place).channels();
        Rgb::new(r.min(self.limit[0]), g.min(self.limit[1]), b.min(self.limit[2]))
    }

    fn sum(&self, pair: &DirectionPair, place: DVec2) -> Rgb {
        let parts = self.components.iter().map(|component| {
            let share = component.coefficients.as_ref().map_or(1.0, |map| map.at(place));
            if share > 0.0 {
                component.product.eval(pair, place) * f64::from(share)
            } else {
                Rgb::BLACK
            }
        });
        parts.sum()
    }

    /// Returns the values, f π, at the places and directions of samples, in parallel.
    #[expect(clippy::cast_possible_truncation, reason = "pictures are f32")]
    pub fn predict(&self, samples: &PaintSamples) -> Vec<[f32; 3]> {
        samples
            .pairs
            .par_iter()
            .zip(&samples.places)
            .map(|(pair, place)| self.value(pair, *place).channels().map(|v| v as f32))
            .collect()
    }

    /// Returns how far the material is from samples.
    pub fn errors(&self, samples: &PaintSamples) -> PaintErrors {
        samples.errors_of(&self.predict(samples))
    }

    /// Returns the bytes of textures and maps as stored, `f32`.
    pub fn payload_bytes(&self) -> usize {
        let maps = self.components.iter().flat_map(|c| &c.coefficients);
        let maps: usize = maps.map(|map| 4 * map.values.len()).sum();
        maps + self.components.iter().map(|c| c.product.payload_bytes()).sum::<usize>()
    }
}

impl SpatiallyVarying for PaintedMaterial {
    fn reflect(&self, at: &TexturePoint, wo: DVec3, lights: &[DVec3], out: &mut [Rgb]) {
        let place = DVec2::new(at.u, at.v);
        for (value, wi) in out.iter_mut().zip(lights) {
            let pair = DirectionPair::new(*wi, wo);
            *value = self.value(&pair, place) * (wi.z.max(0.0) / PI);
        }
    }
}
