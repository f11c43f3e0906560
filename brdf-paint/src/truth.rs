//! Materials whose values are known everywhere, to judge by.

use std::f64::consts::{PI, TAU};

use brdf_model::{Brdf, Rgb};
use brdf_render::{SpatiallyVarying, TexturePoint};
use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

use brdf_param::DirectionPair;

use crate::{PaintedImage, ViewBuffers};

/// Pictures by which rendered scenes are judged, and scaled, are no larger.
pub(crate) const JUDGED_SIZE: usize = 512;

/// A record of the material that pictures were rendered with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct TruthRecord {
    /// The materials that are blended, as they were given.
    pub materials: [String; 3],
    /// Factor by which f π was multiplied.
    pub scale: f64,
}

/// A material whose value is known everywhere, to judge by: three BRDFs blended over a surface. A wavy border lies
/// between the first two, sharp on one half of the surface and soft on the other, and there are round spots of the
/// third.
#[derive(Clone, Copy)]
pub struct GroundTruth<'a> {
    /// The BRDFs that are blended.
    pub brdfs: [&'a dyn Brdf; 3],
    /// Factor by which values f π are multiplied before they are clipped at 1.
    pub scale: f64,
}

impl std::fmt::Debug for GroundTruth<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("GroundTruth").field("scale", &self.scale).finish_non_exhaustive()
    }
}

fn smooth_step(x: f64, width: f64) -> f64 {
    let t = (0.5 + x / width).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

impl GroundTruth<'_> {
    /// Returns the shares of the three BRDFs at a place; periodic in u.
    pub fn shares(place: DVec2) -> [f64; 3] {
        let border = 0.5 + 0.12 * (3.0 * TAU * place.x).sin();
        let width = if (place.x - 0.5).abs() < 0.25 { 0.01 } else { 0.2 };
        let second = smooth_step(place.y - border, width);
        let cell = DVec2::new((6.0 * place.x).fract() - 0.5, (5.0 * place.y).fract() - 0.5);
        let third = smooth_step(0.22 - cell.length(), if place.y < 0.5 { 0.03 } else { 0.25 });
        [(1.0 - third) * (1.0 - second), (1.0 - third) * second, third]
    }

    /// Returns f π, scaled and clipped, at a place.
    pub fn value(&self, pair: &DirectionPair, place: DVec2) -> Rgb {
        (self.blend(pair, place) * self.scale).map(|v| v.clamp(0.0, 1.0))
    }

    /// f π.
    fn blend(&self, pair: &DirectionPair, place: DVec2) -> Rgb {
        let shares = Self::shares(place);
        let sum: Rgb = self.brdfs.iter().zip(shares).map(|(f, share)| f.eval(pair) * share).sum();
        sum * PI
    }

    /// Returns the picture that a camera takes of it: f π cosθi in linear RGB, times the irradiance.
    #[expect(clippy::cast_possible_truncation, reason = "pictures are f32")]
    pub fn paint(&self, buffers: &ViewBuffers) -> PaintedImage {
        let pixels = buffers.pixels.iter().map(|surface| match surface {
            None => [0.0; 4],
            Some(surface) if !surface.is_seen_and_lit() => [0.0, 0.0, 0.0, 1.0],
            Some(surface) => {
                let pair = DirectionPair::new(surface.wi, surface.wo);
                let lit = surface.wi.z * surface.irradiance;
                let [r, g, b] = (self.value(&pair, surface.uv) * lit).channels();
                [r as f32, g as f32, b as f32, 1.0]
            }
        });
        PaintedImage { width: buffers.width, height: buffers.height, pixels: pixels.collect() }
    }

    /// Returns the material with the scale at which the 99.5th percentile of all channels over these views is 1.
    pub fn scaled_for<'a>(self, views: impl IntoIterator<Item = &'a ViewBuffers>) -> Self {
        let mut values: Vec<f64> = views
            .into_iter()
            .flat_map(|buffers| buffers.pixels.iter().flatten())
            .filter(|surface| surface.is_seen_and_lit() && surface.wi.z >= 0.1)
            .flat_map(|surface| {
                let pair = DirectionPair::new(surface.wi, surface.wo);
                self.blend(&pair, surface.uv).channels()
            })
            .collect();
        if values.is_empty() {
            return Self { scale: 1.0, ..self };
        }
        let at = (values.len() - 1) * 995 / 1000;
        let (_, limit, _) = values.select_nth_unstable_by(at, f64::total_cmp);
        Self { scale: if *limit > 0.0 { limit.recip() } else { 1.0 }, ..self }
    }
}

impl SpatiallyVarying for GroundTruth<'_> {
    fn reflect(&self, at: &TexturePoint, wo: DVec3, lights: &[DVec3], out: &mut [Rgb]) {
        for (value, wi) in out.iter_mut().zip(lights) {
            let pair = DirectionPair::new(*wi, wo);
            let lit = if wi.z > 0.0 && wo.z > 0.0 { wi.z / PI } else { 0.0 };
            *value = self.value(&pair, DVec2::new(at.u, at.v)) * lit;
        }
    }
}
