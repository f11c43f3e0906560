//! Compressed BTFs of either kind, read alike.

use brdf_model::srgb_to_linear;
use glam::DVec3;
use rayon::prelude::*;

use crate::sample::LightSampler;
use crate::{AngularGrid, Decoder, Encoding, LpcaDecoder, LpcaModel, Taps, TextureInfo, VqModel};

/// A compressed BTF, by nested codebooks or by local principal components.
#[derive(Clone, Debug)]
pub enum BtfModel {
    /// Nested codebooks.
    Vq(VqModel),
    /// Local principal components.
    Lpca(LpcaModel),
}

impl BtfModel {
    /// Returns name, size and meaning of each texture.
    pub fn textures(&self) -> Vec<TextureInfo> {
        match self {
            Self::Vq(model) => model.header().materials.iter().map(|m| m.info.clone()).collect(),
            Self::Lpca(model) => model.header().materials.clone(),
        }
    }

    /// Returns the index of the texture of this name, or of this number, counted from 1; `None` if there is none.
    pub fn texture_named(&self, name: &str) -> Option<usize> {
        let textures = self.textures();
        let number = name.parse::<usize>().ok().and_then(|number| number.checked_sub(1));
        let named = textures.iter().position(|texture| texture.name == name);
        named.or(number).filter(|index| *index < textures.len())
    }

    /// Returns the name and the bytes of each stream, without headers.
    pub fn stream_bytes(&self) -> Vec<(String, usize)> {
        match self {
            Self::Vq(model) => model.stream_bytes(),
            Self::Lpca(model) => {
                let names = model.header().stream_names().into_iter();
                names.enumerate().map(|(at, name)| (name, model.stream(at).len())).collect()
            }
        }
    }

    /// Returns the bytes of a stream, by its place in [`BtfModel::stream_bytes`].
    pub fn stream(&self, at: usize) -> &[u8] {
        match self {
            Self::Vq(model) => model.stream(at),
            Self::Lpca(model) => model.stream(at),
        }
    }

    /// Returns a reader of one of the textures, or `None` if there are fewer.
    pub fn reader(&self, texture: usize) -> Option<BtfReader<'_>> {
        match self {
            Self::Vq(model) => model.decoder(texture).map(BtfReader::Vq),
            Self::Lpca(model) => model.decoder(texture).map(BtfReader::Lpca),
        }
    }
}

/// A reader of one texture of a [`BtfModel`].
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "there is one for each texture")]
pub enum BtfReader<'a> {
    /// Reader of nested codebooks.
    Vq(Decoder<'a>),
    /// Reader of local principal components.
    Lpca(LpcaDecoder<'a>),
}

impl BtfReader<'_> {
    /// Returns the grid of directions.
    pub fn grid(&self) -> &AngularGrid {
        match self {
            Self::Vq(decoder) => decoder.grid(),
            Self::Lpca(decoder) => decoder.grid(),
        }
    }

    /// Returns what values mean.
    pub fn encoding(&self) -> Encoding {
        match self {
            Self::Vq(decoder) => decoder.encoding(),
            Self::Lpca(decoder) => decoder.encoding(),
        }
    }

    /// Returns the number of resolutions.
    pub fn levels(&self) -> usize {
        match self {
            Self::Vq(decoder) => decoder.levels(),
            Self::Lpca(decoder) => decoder.levels(),
        }
    }

    /// Returns the texels in a row, and the rows, of a level; levels past the last are the last.
    pub fn size(&self, level: usize) -> (usize, usize) {
        match self {
            Self::Vq(decoder) => decoder.size(level),
            Self::Lpca(decoder) => decoder.size(level),
        }
    }

    /// Returns the texel (row-major) of a level at tile coordinates, u to the right and v upwards; the tile repeats.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "reduced to the tile"
    )]
    pub fn texel_at(&self, level: usize, u: f64, v: f64) -> usize {
        let (width, height) = self.size(level);
        let x = (u.rem_euclid(1.0) * width as f64) as usize;
        let y = ((1.0 - v.rem_euclid(1.0)) * height as f64) as usize;
        y.min(height - 1) * width + x.min(width - 1)
    }

    /// Returns the taps of a pair of unit directions of the upper hemisphere.
    pub fn taps(&self, wi: DVec3, wo: DVec3) -> Taps {
        Taps::new(self.grid(), wi, wo)
    }

    /// Returns the RGB, as [`BtfReader::encoding`] says, of a texel (row-major) of a level.
    ///
    /// # Panics
    ///
    /// If there is no such level or texel.
    pub fn texel(&self, level: usize, texel: usize, taps: &Taps) -> [f32; 3] {
        match self {
            Self::Vq(decoder) => decoder.texel(level, texel, taps),
            Self::Lpca(decoder) => decoder.texel(level, texel, taps),
        }
    }

    /// Returns the linear radiance, 0 and above, of a texel (row-major) of a level under a light of irradiance π.
    ///
    /// # Panics
    ///
    /// As [`BtfReader::texel`].
    pub fn linear(&self, level: usize, texel: usize, taps: &Taps) -> [f32; 3] {
        let rgb = self.texel(level, texel, taps).map(|v| v.max(0.0));
        match self.encoding() {
            Encoding::Srgb => rgb.map(srgb_to_linear),
            Encoding::Linear => rgb,
        }
    }

    /// Writes the RGB of a whole level for one pair of directions into `out`.
    ///
    /// # Panics
    ///
    /// If there is no such level or `out` is of another size.
    pub fn image(&self, level: usize, taps: &Taps, out: &mut [[f32; 3]]) {
        match self {
            Self::Vq(decoder) => decoder.image(level, taps, out),
            Self::Lpca(decoder) => decoder.image(level, taps, out),
        }
    }

    /// Writes linear radiance of a whole level for one view under each of some lights, `[light][texel][rgb]`.
    ///
    /// # Panics
    ///
    /// If there is no such level or `out` is of another size.
    pub fn linear_images(&self, level: usize, wo: DVec3, lights: &[DVec3], out: &mut [f32]) {
        let (width, height) = self.size(level);
        let texels = width * height;
        assert_eq!(out.len(), 3 * texels * lights.len(), "room for all images");
        out.par_chunks_exact_mut(3 * texels).zip(lights).for_each(|(out, wi)| {
            let mut image = vec![[0.0; 3]; texels];
            self.image(level, &self.taps(*wi, wo), &mut image);
            for (target, value) in out.as_chunks_mut::<3>().0.iter_mut().zip(image) {
                *target = value.map(|v| match self.encoding() {
                    Encoding::Srgb => srgb_to_linear(v.max(0.0)),
                    Encoding::Linear => v.max(0.0),
                });
            }
        });
    }

    /// Returns a sampler of directions to lights for a texel of a level and a unit view direction.
    ///
    /// # Panics
    ///
    /// As [`BtfReader::texel`].
    pub fn light_sampler(&self, level: usize, texel: usize, wo: DVec3) -> LightSampler {
        match self {
            Self::Vq(decoder) => decoder.light_sampler(level, texel, wo),
            Self::Lpca(decoder) => decoder.light_sampler(level, texel, wo),
        }
    }

    /// Returns the share of light, from everywhere alike, that a texel of a level reflects to a viewer: the integral
    /// of f cosθi (eq. 6), by the rule of the grid's nodes.
    ///
    /// # Panics
    ///
    /// As [`BtfReader::texel`].
    pub fn albedo(&self, level: usize, texel: usize, wo: DVec3, cosine_included: bool) -> [f64; 3] {
        let grid = *self.grid();
        let (view, azimuth) = grid.view_taps(wo);
        let mut sum = [0.0; 3];
        for (alpha, w_alpha) in AngularGrid::trapezoid(grid.alphas).enumerate() {
            for (beta, w_beta) in AngularGrid::trapezoid(grid.betas).enumerate() {
                let [wi, _] = grid.node_directions(alpha, beta, azimuth);
                let taps = Taps { view, light: grid.light_taps(wi, azimuth) };
                let cosine = if cosine_included { 1.0 } else { wi.z };
                let weight = f64::from(w_alpha * w_beta) * cosine * grid.cell_solid_angle();
                let value = self.linear(level, texel, &taps);
                sum.iter_mut().zip(value).for_each(|(s, v)| *s += weight * f64::from(v));
            }
        }
        sum.map(|s| s / std::f64::consts::PI)
    }
}
