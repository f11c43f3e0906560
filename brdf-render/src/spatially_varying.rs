//! Materials that vary over a tile: bidirectional texture functions and their like.

use std::f64::consts::PI;
use std::fmt;

use brdf_model::{Brdf, Rgb, cosine_hemisphere};
use brdf_param::DirectionPair;
use glam::DVec3;

use crate::half_lobe::HalfLobe;

/// A place of a tile, and the size of what is seen there.
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

/// A material that varies over a tile, which repeats along u, to the right, and v, upwards.
///
/// Unit directions in the local frame: x along u, y along v, z the normal.
///
/// ```
/// use brdf_model::Rgb;
/// use brdf_render::{SpatiallyVarying, TexturePoint};
/// use glam::DVec3;
///
/// /// Black and white stripes.
/// struct Stripes;
///
/// impl SpatiallyVarying for Stripes {
///     fn reflect(&self, at: &TexturePoint, _wo: DVec3, lights: &[DVec3], out: &mut [Rgb]) {
///         let albedo = if at.u < 0.5 { 0.9 } else { 0.1 };
///         for (value, wi) in out.iter_mut().zip(lights) {
///             *value = Rgb::splat(albedo / std::f64::consts::PI * wi.z.max(0.0));
///         }
///     }
/// }
///
/// let (place, mut out) = (TexturePoint { u: 0.2, v: 0.0, footprint: 0.0 }, [Rgb::BLACK]);
/// Stripes.reflect(&place, DVec3::Z, &[DVec3::Z], &mut out);
/// assert!(out[0].g > 0.28);
/// ```
#[doc(alias = "SVBRDF")]
pub trait SpatiallyVarying: Sync {
    /// Writes f cosθi, sr⁻¹, for each of the lights into `out`, which is as long as `lights`; 0 where a direction is
    /// not above the surface.
    fn reflect(&self, at: &TexturePoint, wo: DVec3, lights: &[DVec3], out: &mut [Rgb]);

    /// Returns a direction to a light where the material may be bright, drawn from two numbers in [0, 1), and its
    /// pdf, sr⁻¹; `None` where the draw found no direction. Distributed by the cosine unless overridden.
    fn sample(&self, at: &TexturePoint, wo: DVec3, u1: f64, u2: f64) -> Option<(DVec3, f64)> {
        let _ = (at, wo);
        Some(cosine_hemisphere(u1, u2))
    }

    /// Returns the pdf, sr⁻¹, with which [`SpatiallyVarying::sample`] draws a direction above the surface. Override
    /// both or neither.
    fn pdf(&self, at: &TexturePoint, wo: DVec3, wi: DVec3) -> f64 {
        let _ = (at, wo);
        wi.z.max(0.0) / PI
    }
}

/// A material that has the same BRDF everywhere; dark where it has no data.
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
