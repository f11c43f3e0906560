//! Light directions drawn for a view, all over a texture or at one place.

use std::f64::consts::PI;

use brdf_model::{DirectionSampler as _, ScrambledSobol};
use glam::DVec3;

use crate::reader::BtfReader;

/// Options of [`draw_lights`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawParams {
    /// Number of directions.
    pub count: u32,
    /// One place of the tile, u to the right and v upwards in [0, 1), instead of all places.
    pub at: Option<[f64; 2]>,
    /// Seed of the scramble of the Sobol sequence.
    pub seed: u64,
    /// Whether the texture's values contain the cosine of the light's polar angle.
    pub cosine_included: bool,
}

/// A light direction that was drawn, its density and the radiance that it causes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawnLight {
    /// Unit direction to the light.
    pub wi: DVec3,
    /// Density with which it was drawn, sr⁻¹.
    pub pdf: f64,
    /// Linear radiance of the texel.
    pub radiance: [f32; 3],
}

/// Draws directions to lights for a view, distributed as the stored luminance.
///
/// Returns them with an estimate of the albedo of the place, or of the mean over the tile.
pub fn draw_lights(
    reader: &BtfReader<'_>,
    wo: DVec3,
    params: &DrawParams,
) -> (Vec<DrawnLight>, [f64; 3]) {
    let (places, draws) = (ScrambledSobol::new(params.seed), ScrambledSobol::new(!params.seed));
    let mut albedo = [0.0; 3];
    let drawn = (0..params.count).map(|index| {
        let [u, v] = params.at.unwrap_or_else(|| places.planar_point(index));
        let texel = reader.texel_at(0, u, v);
        let sampler = reader.light_sampler(0, texel, wo);
        let (wi, pdf) = sampler.sample(draws.planar_point(index));
        let radiance = reader.linear(0, texel, &reader.taps(wi, wo));
        let cosine = if params.cosine_included { 1.0 } else { wi.z };
        for (sum, v) in albedo.iter_mut().zip(radiance) {
            let share = f64::from(v) * cosine / (pdf.max(1e-12) * PI);
            *sum += share / f64::from(params.count);
        }
        DrawnLight { wi, pdf, radiance }
    });
    let drawn = drawn.collect();
    (drawn, albedo)
}
