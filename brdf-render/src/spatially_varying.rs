//! Materials that vary over a tile: bidirectional texture functions and their like.

use std::f64::consts::PI;
use std::fmt;

use brdf_model::{Brdf, Rgb, cosine_hemisphere};
use brdf_param::DirectionPair;
use glam::DVec3;

use crate::half_lobe::HalfLobe;

/// A place of a tile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TexturePoint {
    /// Tiles to the right, [0, 1).
    pub u: f64,
    /// Tiles upwards, [0, 1).
    pub v: f64,
    /// Side of what a sample stands for, tiles, 0 and above; 0 asks for the finest level. Beyond 1
    /// the whole tile is seen at once.
    pub footprint: f64,
}

/// A material over a tile that repeats along u, to the right, and v, upwards.
///
/// Unit directions in the local frame: x along u, y along v, z the normal.
pub trait SpatiallyVarying: Sync {
    /// Writes f cosθi, sr⁻¹, for each of the lights; 0 where a direction is not above the surface.
    /// `out` is as long as `lights`.
    fn reflect(&self, at: &TexturePoint, wo: DVec3, lights: &[DVec3], out: &mut [Rgb]);

    /// A direction to a light where the material may be bright, from two numbers in [0, 1), and its
    /// pdf per steradian; none where the draw found no direction. The cosine unless overridden.
    fn sample(&self, at: &TexturePoint, wo: DVec3, u1: f64, u2: f64) -> Option<(DVec3, f64)> {
        let _ = (at, wo);
        Some(cosine_hemisphere(u1, u2))
    }

    /// The pdf, per steradian, with which [`SpatiallyVarying::sample`] gives a direction above
    /// the surface. Override both or neither.
    fn pdf(&self, at: &TexturePoint, wo: DVec3, wi: DVec3) -> f64 {
        let _ = (at, wo);
        wi.z.max(0.0) / PI
    }
}

/// The same BRDF everywhere; dark where it has no data.
#[derive(Clone, Copy)]
pub struct Uniform<'a>(pub &'a dyn Brdf);

impl fmt::Debug for Uniform<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Uniform").finish_non_exhaustive()
    }
}

impl SpatiallyVarying for Uniform<'_> {
    fn reflect(&self, _at: &TexturePoint, wo: DVec3, lights: &[DVec3], out: &mut [Rgb]) {
        for (value, &wi) in out.iter_mut().zip(lights) {
            let pair = DirectionPair::new(wi, wo);
            let covered = wi.z > 0.0 && self.0.has_data(&pair);
            *value = if covered { self.0.eval(&pair) * wi.z } else { Rgb::BLACK };
        }
    }

    fn sample(&self, _at: &TexturePoint, wo: DVec3, u1: f64, u2: f64) -> Option<(DVec3, f64)> {
        let lobe = HalfLobe { wo };
        let wi = lobe.sample(u1, u2);
        (wi.z > 0.0).then(|| (wi, lobe.pdf(wi)))
    }

    fn pdf(&self, _at: &TexturePoint, wo: DVec3, wi: DVec3) -> f64 {
        HalfLobe { wo }.pdf(wi)
    }
}
