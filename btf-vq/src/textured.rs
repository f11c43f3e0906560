//! A texture of a compressed BTF as a material of pictures.

use std::f64::consts::PI;

use brdf_model::{DirectionSampler as _, Rgb};
use brdf_render::{SpatiallyVarying, TexturePoint};
use glam::DVec3;

use crate::decode::Taps;
use crate::reader::BtfReader;

/// A texture of a compressed BTF that pictures can show. The tile repeats, and coarser levels, where there are some,
/// are taken where a pixel sees more than a texel.
#[derive(Clone, Debug)]
pub struct TexturedBtf<'a> {
    /// Reader of the texture.
    pub reader: BtfReader<'a>,
    /// Whether its values contain the cosine of the light's polar angle.
    pub cosine_included: bool,
}

impl TexturedBtf<'_> {
    /// The level whose texels are about as large as a footprint, and the texel there.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "levels are few")]
    fn place(&self, at: &TexturePoint) -> (usize, usize) {
        let (width, height) = self.reader.size(0);
        let texels = at.footprint * width.max(height) as f64;
        let level = (texels.max(1.0).log2().round() as usize).min(self.reader.levels() - 1);
        (level, self.reader.texel_at(level, at.u, at.v))
    }
}

impl SpatiallyVarying for TexturedBtf<'_> {
    fn reflect(&self, at: &TexturePoint, wo: DVec3, lights: &[DVec3], out: &mut [Rgb]) {
        let (level, texel) = self.place(at);
        let (view, azimuth) = self.reader.grid().view_taps(wo);
        for (value, &wi) in out.iter_mut().zip(lights) {
            if wi.z <= 0.0 || wo.z <= 0.0 {
                *value = Rgb::BLACK;
                continue;
            }
            let taps = Taps { view, light: self.reader.grid().light_taps(wi, azimuth) };
            let cosine = if self.cosine_included { 1.0 } else { wi.z };
            let radiance = self.reader.linear(level, texel, &taps);
            *value = Rgb::from(radiance.map(|v| f64::from(v) * cosine / PI));
        }
    }

    fn sample(&self, at: &TexturePoint, wo: DVec3, u1: f64, u2: f64) -> Option<(DVec3, f64)> {
        let (level, texel) = self.place(at);
        Some(self.reader.light_sampler(level, texel, wo).sample([u1, u2]))
    }

    fn pdf(&self, at: &TexturePoint, wo: DVec3, wi: DVec3) -> f64 {
        let (level, texel) = self.place(at);
        self.reader.light_sampler(level, texel, wo).pdf(wi)
    }
}
