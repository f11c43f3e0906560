//! A small BTF without files: bumps of two colours, rough and glossy, over 81 × 81 directions.

use std::ops::Range;

use btf_vq::{
    AngularGrid, BtfLayout, BtfSource, BtfView, Chroma, Codebooks, CompressedTexture, Encoding,
    IndexCodebook, Resampler, SourceError, TextureInfo,
};
use glam::DVec3;

/// The 81 directions of UBO2003.
pub(crate) fn directions() -> Vec<DVec3> {
    let radians = |degrees: u32| f64::from(degrees).to_radians();
    btf_synth::ubo_directions()
        .into_iter()
        .map(|(theta, phi)| brdf_param::spherical_direction(radians(theta), radians(phi)))
        .collect()
}

/// A source whose values are a formula.
pub(crate) struct Formula {
    pub(crate) layout: BtfLayout,
    gloss: f64,
}

impl Formula {
    pub(crate) fn new(side: usize, gloss: f64, encoding: Encoding) -> Self {
        let lights = directions();
        let views = directions().into_iter().map(|wo| BtfView { wo, lights: lights.clone() });
        let layout = BtfLayout {
            width: side,
            height: side,
            views: views.collect(),
            encoding,
            cosine_included: true,
        };
        Self { layout, gloss }
    }

    /// RGB in the source's encoding.
    pub(crate) fn value(&self, texel: usize, wi: DVec3, wo: DVec3) -> [f32; 3] {
        let (x, y) = (texel % self.layout.width, texel / self.layout.width);
        let tilt = |i: usize| 0.4 * ((i * 7 % 5) as f64 / 4.0 - 0.5);
        let normal = DVec3::new(tilt(x), tilt(y + 2), 1.0).normalize();
        let half = (wi + wo).normalize_or(DVec3::Z);
        let shine = self.gloss * normal.dot(half).max(0.0).powf(40.0);
        let diffuse = normal.dot(wi).max(0.0);
        let albedo = if (x / 2 + y / 2) % 2 == 0 { [0.7, 0.3, 0.2] } else { [0.2, 0.4, 0.6] };
        albedo.map(|a| {
            #[expect(clippy::cast_possible_truncation, reason = "pixels are f32")]
            let linear = (a * diffuse + shine * wi.z) as f32;
            match self.layout.encoding {
                Encoding::Srgb => brdf_model::linear_to_srgb(linear).clamp(0.0, 1.0),
                Encoding::Linear => linear,
            }
        })
    }
}

impl BtfSource for Formula {
    fn layout(&self) -> &BtfLayout {
        &self.layout
    }

    fn read_texels(&self, texels: Range<usize>, out: &mut [f32]) -> Result<(), SourceError> {
        let views = self.layout.views.iter();
        let pairs = views.flat_map(|v| v.lights.iter().map(move |wi| (*wi, v.wo)));
        for ((wi, wo), out) in pairs.zip(out.chunks_exact_mut(3 * texels.len())) {
            for (texel, rgb) in texels.clone().zip(out.as_chunks_mut::<3>().0) {
                *rgb = self.value(texel, wi, wo);
            }
        }
        Ok(())
    }
}

pub(crate) fn resampler(source: &Formula) -> Resampler {
    Resampler::new(&source.layout, AngularGrid::default()).unwrap()
}

/// No books yet.
pub(crate) fn empty(source: &Formula, chroma: Chroma) -> Codebooks {
    Codebooks::new(AngularGrid::default(), source.layout.encoding, chroma)
}

/// A texture of one level.
pub(crate) fn info(source: &Formula) -> TextureInfo {
    TextureInfo {
        name: "formula".to_owned(),
        width: source.layout.width,
        height: source.layout.height,
        cosine_included: true,
        levels: 1,
    }
}

/// One texture of one level.
pub(crate) fn material(source: &Formula, texture: IndexCodebook) -> CompressedTexture {
    CompressedTexture { info: info(source), levels: vec![texture] }
}
