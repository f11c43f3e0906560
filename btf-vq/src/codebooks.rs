//! The nested codebooks, unpacked: what encoders build.
//!
//! A texel is a row of P6, `index, scale`; it points into P4 (views by azimuth), that into P3 (by
//! polar angle), that into M, which joins luminance (P2 over α, P1 along β) and chrominance (I2 over
//! α, I1 along β, C). Luminance is the product of all scales on the way with the value in P1 (eq. 4).

use serde::{Deserialize, Serialize};

use crate::{AngularGrid, Encoding, VqError};

/// The relation of the stored chrominance to luminance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Chroma {
    /// C holds chrominance itself, as in the paper.
    Absolute,
    /// C holds chrominance over luminance, so that scales brighten colours as a whole.
    Relative,
}

/// A codebook whose rows are values (P1 and C).
#[derive(Clone, Debug, PartialEq, Default)]
pub struct ValueBook {
    /// Values in a row.
    pub len: usize,
    /// `[row][len]`.
    pub values: Vec<f32>,
}

impl ValueBook {
    /// Returns the number of rows.
    pub fn rows(&self) -> usize {
        self.values.len() / self.len.max(1)
    }

    /// Returns the values of a row.
    pub fn row(&self, row: usize) -> &[f32] {
        &self.values[row * self.len..][..self.len]
    }
}

/// A codebook whose rows are indices into another book, with scales where the book has them.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct IndexCodebook {
    /// Entries in a row.
    pub len: usize,
    /// `[row][len]`.
    pub index: Vec<u32>,
    /// `[row][len]`, 0 and above; empty in I1, I2 and M.
    pub scale: Vec<f32>,
}

impl IndexCodebook {
    /// Returns the number of rows.
    pub fn rows(&self) -> usize {
        self.index.len() / self.len.max(1)
    }

    /// Returns the indices of a row.
    pub fn row(&self, row: usize) -> &[u32] {
        &self.index[row * self.len..][..self.len]
    }

    /// Returns the scales of a row.
    pub fn row_scale(&self, row: usize) -> &[f32] {
        &self.scale[row * self.len..][..self.len]
    }

    /// Returns the indices of a row, each with its scale.
    pub fn entries(&self, row: usize) -> impl Iterator<Item = (usize, f32)> + '_ {
        self.row(row).iter().zip(self.row_scale(row)).map(|(i, s)| (*i as usize, *s))
    }
}

/// The nested codebooks that textures share, unpacked.
#[derive(Clone, Debug, PartialEq)]
pub struct Codebooks {
    /// Lengths of rows and meaning of nodes.
    pub grid: AngularGrid,
    /// Meaning of the values.
    pub encoding: Encoding,
    /// Relation of chrominance to luminance.
    pub chroma: Chroma,
    /// Luminance along β, of unit integral (trapezoidal rule over nodes).
    pub p1: ValueBook,
    /// Rows over α of entries that point into P1.
    pub p2: IndexCodebook,
    /// Two chrominances in each row.
    pub c: ValueBook,
    /// Rows along β of entries that point into C.
    pub i1: IndexCodebook,
    /// Rows over α of entries that point into I1.
    pub i2: IndexCodebook,
    /// Rows of two entries, which point into P2 and into I2.
    pub m: IndexCodebook,
    /// Rows over θv of entries that point into M.
    pub p3: IndexCodebook,
    /// Rows over φv of entries that point into P3.
    pub p4: IndexCodebook,
}

/// Name, size and meaning of one texture of a compressed BTF.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TextureInfo {
    /// Name of the texture.
    pub name: String,
    /// Texels in a row of the finest level.
    pub width: usize,
    /// Rows of the finest level.
    pub height: usize,
    /// Whether values contain the cosine of the light's polar angle.
    pub cosine_included: bool,
    /// Number of resolutions, the finest and those below; each has half as many texels in a row as the one before.
    pub levels: usize,
}

impl TextureInfo {
    /// Returns the number of texels of each level, the finest first.
    pub fn level_lens(&self) -> impl Iterator<Item = usize> + use<> {
        let (width, height) = (self.width, self.height);
        (0..self.levels).map(move |level| {
            let (width, height) = level_size(width, height, level);
            width * height
        })
    }

    /// Checks numbers from a file.
    pub(crate) fn check(&self) -> Result<(), VqError> {
        let Self { width, height, levels, .. } = *self;
        let texels = width.checked_mul(height).filter(|n| (1..=1 << 28).contains(n));
        if texels.is_none() || !(1..=28).contains(&levels) {
            return Err(VqError::Header {
                what: "a texture's size",
                found: format!("{width} × {height}, {levels} levels"),
                expected: "1 to 2^28 texels and 1 to 28 levels",
            });
        }
        Ok(())
    }
}

/// One texture as rows of indices into the shared books.
#[derive(Clone, Debug, PartialEq)]
pub struct CompressedTexture {
    /// Name, size and meaning.
    pub info: TextureInfo,
    /// P6: into P4, one entry a texel; the finest level first, each next one half as large.
    pub levels: Vec<IndexCodebook>,
}

/// Returns the width and height, in texels, of a level of a texture whose finest level has `width` × `height`.
///
/// ```
/// assert_eq!(btf_vq::level_size(256, 64, 3), (32, 8));
/// ```
pub fn level_size(width: usize, height: usize, level: usize) -> (usize, usize) {
    ((width >> level).max(1), (height >> level).max(1))
}

impl Codebooks {
    /// Returns books without rows.
    pub fn new(grid: AngularGrid, encoding: Encoding, chroma: Chroma) -> Self {
        let values = |len| ValueBook { len, values: Vec::new() };
        let indices = |len| IndexCodebook { len, index: Vec::new(), scale: Vec::new() };
        Self {
            grid,
            encoding,
            chroma,
            p1: values(grid.betas),
            p2: indices(grid.alphas),
            c: values(2),
            i1: indices(grid.betas),
            i2: indices(grid.alphas),
            m: indices(2),
            p3: indices(grid.thetas),
            p4: indices(grid.phis),
        }
    }

    /// Writes the luminance of a row of P2 into `out`: `[alpha][beta]`.
    pub fn expand_p2(&self, row: usize, out: &mut [f32]) {
        for ((index, scale), slice) in
            self.p2.entries(row).zip(out.chunks_exact_mut(self.grid.betas))
        {
            slice.iter_mut().zip(self.p1.row(index)).for_each(|(v, p)| *v = scale * p);
        }
    }

    /// Writes a chrominance, 0 or 1, of a row of I2 into `out`: `[alpha][beta]`.
    pub fn expand_i2(&self, row: usize, channel: usize, out: &mut [f32]) {
        for (i1, slice) in self.i2.row(row).iter().zip(out.chunks_exact_mut(self.grid.betas)) {
            for (c, value) in self.i1.row(*i1 as usize).iter().zip(slice) {
                *value = self.c.row(*c as usize)[channel];
            }
        }
    }

    /// Writes both chrominances of a row of I1 into `out`: `[channel][beta]`.
    pub fn expand_i1(&self, row: usize, out: &mut [f32]) {
        let (first, second) = out.split_at_mut(self.grid.betas);
        for ((c, a), b) in self.i1.row(row).iter().zip(first).zip(second) {
            let colour = self.c.row(*c as usize);
            (*a, *b) = (colour[0], colour[1]);
        }
    }

    /// Writes a row of M into `out`, `[channel][alpha][beta]`: luminance of unit scale and both chrominances;
    /// relative chrominance is multiplied by luminance.
    pub fn expand_m(&self, row: usize, out: &mut [f32]) {
        let [p2, i2] = [self.m.row(row)[0], self.m.row(row)[1]].map(|i| i as usize);
        let slice = self.grid.slice_len();
        let (luma, chroma) = out.split_at_mut(slice);
        self.expand_p2(p2, luma);
        for (channel, values) in chroma.chunks_exact_mut(slice).enumerate() {
            self.expand_i2(i2, channel, values);
            if self.chroma == Chroma::Relative {
                values.iter_mut().zip(&*luma).for_each(|(c, y)| *c *= y);
            }
        }
    }

    /// How a scale on the way changes a channel: luminance always, chrominance if relative.
    fn channel_scale(&self, channel: usize, scale: f32) -> f32 {
        if channel == 0 || self.chroma == Chroma::Relative { scale } else { 1.0 }
    }

    /// Writes a row of P3 of unit scale into `out`: `[channel][theta][alpha][beta]`.
    pub fn expand_p3(&self, row: usize, out: &mut [f32]) {
        let slice = self.grid.slice_len();
        let mut view = vec![0.0; 3 * slice];
        for (theta, (m, scale)) in self.p3.entries(row).enumerate() {
            self.expand_m(m, &mut view);
            for channel in 0..3 {
                let factor = self.channel_scale(channel, scale);
                let target = &mut out[(channel * self.grid.thetas + theta) * slice..][..slice];
                let source = &view[channel * slice..][..slice];
                target.iter_mut().zip(source).for_each(|(t, s)| *t = factor * s);
            }
        }
    }

    /// Writes a row of P4 of unit scale into `out`: `[channel][node]`.
    pub fn expand_p4(&self, row: usize, out: &mut [f32]) {
        let part = self.grid.thetas * self.grid.slice_len();
        let mut three = vec![0.0; 3 * part];
        for (phi, (p3, scale)) in self.p4.entries(row).enumerate() {
            self.expand_p3(p3, &mut three);
            for channel in 0..3 {
                let factor = self.channel_scale(channel, scale);
                let target = &mut out[(channel * self.grid.phis + phi) * part..][..part];
                let source = &three[channel * part..][..part];
                target.iter_mut().zip(source).for_each(|(t, s)| *t = factor * s);
            }
        }
    }

    /// Moves factors upwards until every slice has a unit integral over light directions (counted in
    /// nodes) or sum over views, and P6 carries the rest. Rows of zeros stay zeros.
    pub fn normalize(&mut self, materials: &mut [CompressedTexture]) {
        let (alphas, betas) = (self.grid.alphas, self.grid.betas);
        let sums = self.p1.values.chunks_exact_mut(betas).map(|row| {
            let sum = row.iter().zip(AngularGrid::trapezoid(betas)).map(|(v, w)| v * w).sum();
            scale_row(row, sum);
            sum
        });
        let p1: Vec<f32> = sums.collect();
        let p2 = normalize_book(&mut self.p2, &p1, AngularGrid::trapezoid(alphas));
        let m: Vec<f32> = self.m.index.chunks_exact(2).map(|pair| p2[pair[0] as usize]).collect();
        let p3 = normalize_book(&mut self.p3, &m, std::iter::repeat(1.0));
        let p4 = normalize_book(&mut self.p4, &p3, std::iter::repeat(1.0));
        for level in materials.iter_mut().flat_map(|material| &mut material.levels) {
            for (scale, index) in level.scale.iter_mut().zip(&level.index) {
                *scale *= p4[*index as usize];
            }
        }
    }
}

fn scale_row(row: &mut [f32], sum: f32) {
    if sum > 0.0 {
        row.iter_mut().for_each(|v| *v /= sum);
    }
}

/// Multiplies in what the rows below gave up, and returns what these rows give up.
fn normalize_book(
    book: &mut IndexCodebook,
    below: &[f32],
    weights: impl Iterator<Item = f32> + Clone,
) -> Vec<f32> {
    let rows = book.scale.chunks_exact_mut(book.len).zip(book.index.chunks_exact(book.len));
    rows.map(|(scale, index)| {
        scale.iter_mut().zip(index).for_each(|(s, i)| *s *= below[*i as usize]);
        let sum = scale.iter().zip(weights.clone()).map(|(s, w)| s * w).sum();
        scale_row(scale, sum);
        sum
    })
    .collect()
}
