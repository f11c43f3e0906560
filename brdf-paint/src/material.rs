//! What is extracted: a sum of products weighted by maps.

use std::f64::consts::PI;

use brdf_factor::SurfaceProduct;
use brdf_model::Rgb;
use brdf_param::DirectionPair;
use brdf_render::{SpatiallyVarying, TexturePoint};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::{CoefficientMap, PaintSamples};

/// One summand.
#[derive(Clone, Debug, PartialEq)]
pub struct Component {
    /// How much of it there is where; 1 everywhere without.
    pub coefficients: Option<CoefficientMap>,
    /// Its reflectance, f π.
    pub product: SurfaceProduct,
}

/// A material over a surface: Σ c_j(u, v) f_j(wi, wo) (Eq. 19).
#[derive(Clone, Debug, PartialEq)]
pub struct PaintedMaterial {
    /// The summands.
    pub components: Vec<Component>,
    /// The brightest value of each channel that was painted. Values are not above it: between directions that
    /// were painted and the horizon products of factors reach any height.
    pub limit: [f64; 3],
}

impl PaintedMaterial {
    /// f π at a place, linear RGB, from 0 to the brightest that was painted.
    pub fn value(&self, pair: &DirectionPair, place: DVec2) -> Rgb {
        let parts = self.components.iter().map(|component| {
            let share = component.coefficients.as_ref().map_or(1.0, |map| map.at(place));
            if share > 0.0 {
                component.product.eval(pair, place) * f64::from(share)
            } else {
                Rgb::BLACK
            }
        });
        let [r, g, b] = parts.sum::<Rgb>().channels();
        Rgb::new(r.min(self.limit[0]), g.min(self.limit[1]), b.min(self.limit[2]))
    }

    /// Values for samples, in parallel.
    #[expect(clippy::cast_possible_truncation, reason = "pictures are f32")]
    pub fn predict(&self, samples: &PaintSamples) -> Vec<[f32; 3]> {
        samples
            .pairs
            .par_iter()
            .zip(&samples.places)
            .map(|(pair, place)| self.value(pair, *place).channels().map(|v| v as f32))
            .collect()
    }

    /// Bytes of textures and maps as stored, f32.
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
