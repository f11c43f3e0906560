//! Random access: any texel for any light and view, straight from the packed books.

use glam::DVec3;

use crate::bits::{PackedEntries, index_bits};
use crate::books::level_size;
use crate::colour::from_luma_chroma;
use crate::{AngularGrid, Chroma, Encoding, LightTaps, Quantiser, ViewTaps, VqModel};

/// Where a pair of directions lies in the grid: made once, used for many texels.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Taps {
    /// Of the view.
    pub view: ViewTaps,
    /// Of the light, relative to the view's azimuth.
    pub light: LightTaps,
}

impl Taps {
    /// The taps of unit directions of the upper hemisphere.
    pub fn new(grid: &AngularGrid, wi: DVec3, wo: DVec3) -> Self {
        let (view, phi_v) = grid.view_taps(wo);
        Self { view, light: grid.light_taps(wi, phi_v) }
    }

    /// The 16 nodes, of one channel, and their weights.
    pub fn nodes(&self, grid: &AngularGrid) -> [(usize, f32); 16] {
        let mut taps = [(0, 0.0); 16];
        let mut next = taps.iter_mut();
        for (phi, w_phi) in self.view.phi.iter() {
            for (theta, w_theta) in self.view.theta.iter() {
                for (alpha, w_alpha) in self.light.alpha.iter() {
                    for ((beta, w_beta), tap) in self.light.beta.iter().zip(&mut next) {
                        let view = phi * grid.thetas + theta;
                        let node = (view * grid.alphas + alpha) * grid.betas + beta;
                        *tap = (node, w_phi * w_theta * w_alpha * w_beta);
                    }
                }
            }
        }
        taps
    }
}

/// A book of indices with scales, ready to read.
#[derive(Clone, Debug)]
struct ScaledBook<'a> {
    entries: PackedEntries<'a>,
    len: usize,
    index_bits: u32,
    index_mask: u64,
    scales: Vec<f32>,
}

impl<'a> ScaledBook<'a> {
    fn new(bytes: &'a [u8], len: usize, target_rows: usize, scale: &Quantiser) -> Self {
        let index_bits = index_bits(target_rows);
        Self {
            entries: PackedEntries::new(bytes, index_bits + scale.bits),
            len,
            index_bits,
            index_mask: (1 << index_bits) - 1,
            scales: scale.table(),
        }
    }

    /// Index and scale of an entry of a row.
    #[inline]
    #[expect(clippy::cast_possible_truncation, reason = "masked to the bits of a row")]
    fn get(&self, row: usize, at: usize) -> (usize, f32) {
        let entry = self.entries.get(row * self.len + at);
        let scale = self.scales.get((entry >> self.index_bits) as usize).copied();
        ((entry & self.index_mask) as usize, scale.unwrap_or(0.0))
    }
}

/// A book of codes without scales.
#[derive(Clone, Copy, Debug)]
struct PlainBook<'a> {
    entries: PackedEntries<'a>,
    len: usize,
}

impl<'a> PlainBook<'a> {
    #[inline]
    #[expect(clippy::cast_possible_truncation, reason = "entries hold an index")]
    fn get(&self, row: usize, at: usize) -> usize {
        self.entries.get(row * self.len + at) as usize
    }
}

/// Codes to values by a straight line.
#[derive(Clone, Copy, Debug)]
struct Line {
    min: f32,
    step: f32,
}

impl Line {
    fn new(quantiser: &Quantiser) -> Self {
        let min = quantiser.decode(0);
        Self { min, step: quantiser.decode(1) - min }
    }

    #[inline]
    #[expect(clippy::cast_precision_loss, reason = "codes have at most 8 bits")]
    fn at(self, code: usize) -> f32 {
        self.min + self.step * code as f32
    }
}

/// A level of a texture, ready to read.
#[derive(Clone, Debug)]
struct Texture<'a> {
    width: usize,
    height: usize,
    p6: ScaledBook<'a>,
}

/// Reads a texture of a compressed BTF.
#[derive(Clone, Debug)]
pub struct Decoder<'a> {
    grid: AngularGrid,
    encoding: Encoding,
    chroma: Chroma,
    rows: usize,
    p1: PlainBook<'a>,
    p1_line: Line,
    p2: ScaledBook<'a>,
    c: PlainBook<'a>,
    c_lines: [Line; 2],
    i1: PlainBook<'a>,
    i2: PlainBook<'a>,
    m: PackedEntries<'a>,
    m_low_bits: u32,
    p3: ScaledBook<'a>,
    p4: ScaledBook<'a>,
    levels: Vec<Texture<'a>>,
    /// Integral of each row of P1 over β, and of each row of P2 over both, in nodes.
    p1_mass: Vec<f32>,
    p2_mass: Vec<f32>,
}

impl VqModel {
    /// A reader of one of the textures; `None` if there are fewer.
    pub fn decoder(&self, material: usize) -> Option<Decoder<'_>> {
        let header = self.header();
        let texture = header.materials.get(material)?;
        let (grid, rows) = (header.grid, header.rows);
        let plain = |stream, len, bits| PlainBook {
            entries: PackedEntries::new(self.stream(stream), bits),
            len,
        };
        let first = 8 + header.materials[..material].iter().map(|m| m.levels).sum::<usize>();
        let levels = (0..texture.levels).map(|level| {
            let (width, height) = level_size(texture.width, texture.height, level);
            let bytes = self.stream(first + level);
            Texture { width, height, p6: ScaledBook::new(bytes, 1, rows.p4, &texture.scale) }
        });
        let m_low_bits = index_bits(rows.p2);
        let mut decoder = Decoder {
            grid,
            encoding: header.encoding,
            chroma: header.chroma,
            rows: rows.p4,
            p1: plain(0, grid.betas, header.p1.bits),
            p1_line: Line::new(&header.p1),
            p2: ScaledBook::new(self.stream(1), grid.alphas, rows.p1, &header.p2),
            c: plain(2, 2, 8),
            c_lines: [Line::new(&header.c[0]), Line::new(&header.c[1])],
            i1: plain(3, grid.betas, index_bits(rows.c)),
            i2: plain(4, grid.alphas, index_bits(rows.i1)),
            m: PackedEntries::new(self.stream(5), m_low_bits + index_bits(rows.i2)),
            m_low_bits,
            p3: ScaledBook::new(self.stream(6), grid.thetas, rows.m, &header.p3),
            p4: ScaledBook::new(self.stream(7), grid.phis, rows.p3, &header.p4),
            levels: levels.collect(),
            p1_mass: Vec::new(),
            p2_mass: Vec::new(),
        };
        decoder.p1_mass = (0..rows.p1)
            .map(|row| {
                let values = (0..grid.betas).map(|at| decoder.p1_value(row, at));
                values.zip(AngularGrid::trapezoid(grid.betas)).map(|(v, w)| v * w).sum()
            })
            .collect();
        decoder.p2_mass = (0..rows.p2)
            .map(|row| {
                let masses = (0..grid.alphas).map(|at| decoder.row_mass(row, at));
                masses.zip(AngularGrid::trapezoid(grid.alphas)).map(|(v, w)| v * w).sum()
            })
            .collect();
        Some(decoder)
    }
}

impl Decoder<'_> {
    /// The grid.
    pub fn grid(&self) -> &AngularGrid {
        &self.grid
    }

    /// What values mean.
    pub fn encoding(&self) -> Encoding {
        self.encoding
    }

    /// Resolutions.
    pub fn levels(&self) -> usize {
        self.levels.len()
    }

    /// Texels in a row, and rows, of a level; levels past the last are the last.
    pub fn size(&self, level: usize) -> (usize, usize) {
        let texture = &self.levels[level.min(self.levels.len() - 1)];
        (texture.width, texture.height)
    }

    /// RGB, as [`Decoder::encoding`] says, of a texel (row-major) of a level between the nodes around
    /// `taps`.
    ///
    /// # Panics
    ///
    /// If there is no such level. Texels past the end give some other texel's value.
    #[inline]
    pub fn texel(&self, level: usize, texel: usize, taps: &Taps) -> [f32; 3] {
        let (p4, scale) = self.levels[level].p6.get(texel, 0);
        self.scaled(self.row(p4, taps), scale)
    }

    /// Values of a row of P4 with the scale of P6, as RGB.
    #[inline]
    fn scaled(&self, [y, a, b]: [f32; 3], scale: f32) -> [f32; 3] {
        let chroma = match (self.chroma, self.encoding) {
            (Chroma::Relative, Encoding::Srgb) => scale,
            // Chromaticities are weighted by luminance alone.
            (Chroma::Relative, Encoding::Linear) if y > 0.0 => y.recip(),
            _ => 1.0,
        };
        from_luma_chroma(self.encoding, [y * scale, a * chroma, b * chroma])
    }

    /// Luminance of unit scale and chrominances of a row of P4 between the nodes around `taps`.
    #[inline]
    fn row(&self, p4: usize, taps: &Taps) -> [f32; 3] {
        let mut sum = [0.0; 3];
        for (phi, w_phi) in taps.view.phi.iter() {
            let (p3, s4) = self.p4.get(p4, phi);
            for (theta, w_theta) in taps.view.theta.iter() {
                let (m, s3) = self.p3.get(p3, theta);
                let [y, a, b] = self.slice(m, &taps.light);
                let (weight, scale) = (w_phi * w_theta, s4 * s3);
                let chroma = if self.chroma == Chroma::Relative { weight * scale } else { weight };
                sum[0] += weight * scale * y;
                sum[1] += chroma * a;
                sum[2] += chroma * b;
            }
        }
        sum
    }

    /// Halves of an entry of M.
    #[inline]
    #[expect(clippy::cast_possible_truncation, reason = "masked to the bits of a row")]
    fn merged(&self, m: usize) -> (usize, usize) {
        let entry = self.m.get(m);
        ((entry & ((1 << self.m_low_bits) - 1)) as usize, (entry >> self.m_low_bits) as usize)
    }

    /// The same of a row of M.
    #[inline]
    fn slice(&self, m: usize, light: &LightTaps) -> [f32; 3] {
        let (p2, i2) = self.merged(m);
        let is_relative = self.chroma == Chroma::Relative;
        let mut sum = [0.0; 3];
        for (alpha, w_alpha) in light.alpha.iter() {
            let (p1, s2) = self.p2.get(p2, alpha);
            let i1 = self.i2.get(i2, alpha);
            for (beta, w_beta) in light.beta.iter() {
                let y = s2 * self.p1_line.at(self.p1.get(p1, beta));
                let c = self.i1.get(i1, beta);
                let weight = w_alpha * w_beta;
                let chroma = if is_relative { weight * y } else { weight };
                sum[0] += weight * y;
                sum[1] += chroma * self.c_lines[0].at(self.c.get(c, 0));
                sum[2] += chroma * self.c_lines[1].at(self.c.get(c, 1));
            }
        }
        sum
    }

    /// A value of a row of P1.
    #[inline]
    pub(crate) fn p1_value(&self, row: usize, beta: usize) -> f32 {
        self.p1_line.at(self.p1.get(row, beta))
    }

    /// Row of P1 and scale that a row of P2 has at an α.
    #[inline]
    pub(crate) fn p1_row(&self, p2: usize, alpha: usize) -> (usize, f32) {
        self.p2.get(p2, alpha.min(self.grid.alphas - 1))
    }

    /// Integral over β of a row of P2 at an α.
    #[inline]
    pub(crate) fn row_mass(&self, p2: usize, alpha: usize) -> f32 {
        let (p1, scale) = self.p1_row(p2, alpha);
        scale * self.p1_mass[p1]
    }

    /// Integral over α and β of a row of P2.
    #[inline]
    pub(crate) fn slice_mass(&self, p2: usize) -> f32 {
        self.p2_mass[p2]
    }

    /// Row of P2 and scale, without that of P6, of a texel of the finest level for a view `[phi][theta]`.
    #[inline]
    pub(crate) fn view_slice(&self, texel: usize, view: usize) -> (usize, f32) {
        let (p4, _) = self.levels[0].p6.get(texel, 0);
        let (p3, s4) = self.p4.get(p4, view / self.grid.thetas);
        let (m, s3) = self.p3.get(p3, view % self.grid.thetas);
        (self.merged(m).0, s4 * s3)
    }

    /// Luminance of a texel of the finest level, without the scale of P6.
    #[inline]
    pub(crate) fn luminance(&self, texel: usize, taps: &Taps) -> f32 {
        let (p4, _) = self.levels[0].p6.get(texel, 0);
        let mut sum = 0.0;
        for (phi, w_phi) in taps.view.phi.iter() {
            let (p3, s4) = self.p4.get(p4, phi);
            for (theta, w_theta) in taps.view.theta.iter() {
                let (m, s3) = self.p3.get(p3, theta);
                let (p2, _) = self.merged(m);
                let weight = w_phi * w_theta * s4 * s3;
                for (alpha, w_alpha) in taps.light.alpha.iter() {
                    let (p1, s2) = self.p2.get(p2, alpha);
                    for (beta, w_beta) in taps.light.beta.iter() {
                        sum += weight * w_alpha * w_beta * s2 * self.p1_value(p1, beta);
                    }
                }
            }
        }
        sum
    }

    /// Adds the luminance of a texel for a view of the grid, `[phi][theta]`, times a weight.
    pub(crate) fn add_view_luminance(
        &self,
        level: usize,
        texel: usize,
        view: usize,
        weight: f32,
        out: &mut [f32],
    ) {
        let (p4, s6) = self.levels[level].p6.get(texel, 0);
        let (p3, s4) = self.p4.get(p4, view / self.grid.thetas);
        let (m, s3) = self.p3.get(p3, view % self.grid.thetas);
        let (p2, _) = self.merged(m);
        for (alpha, slice) in out.chunks_exact_mut(self.grid.betas).enumerate() {
            let (p1, s2) = self.p2.get(p2, alpha);
            let scale = weight * s6 * s4 * s3 * s2;
            for (beta, value) in slice.iter_mut().enumerate() {
                *value += scale * self.p1_value(p1, beta);
            }
        }
    }

    /// RGB of many texels of the finest level, each with taps of its own.
    ///
    /// # Panics
    ///
    /// Unless `out` is as long as `queries`.
    pub fn batch(&self, queries: &[(usize, Taps)], out: &mut [[f32; 3]]) {
        assert_eq!(queries.len(), out.len(), "a value for each query");
        for ((texel, taps), value) in queries.iter().zip(out) {
            *value = self.texel(0, *texel, taps);
        }
    }

    /// RGB of consecutive texels of a level for one pair of directions.
    ///
    /// # Panics
    ///
    /// If there is no such level.
    pub fn run(&self, level: usize, first: usize, taps: &Taps, out: &mut [[f32; 3]]) {
        for (offset, value) in out.iter_mut().enumerate() {
            *value = self.texel(level, first + offset, taps);
        }
    }

    /// A whole level for one pair of directions: every row of P4 is decoded once.
    ///
    /// # Panics
    ///
    /// If there is no such level or `out` is of another size.
    pub fn image(&self, level: usize, taps: &Taps, out: &mut [[f32; 3]]) {
        let texture = &self.levels[level];
        assert_eq!(out.len(), texture.width * texture.height, "a value for each texel");
        let rows: Vec<[f32; 3]> = (0..self.rows).map(|p4| self.row(p4, taps)).collect();
        for (texel, value) in out.iter_mut().enumerate() {
            let (p4, scale) = texture.p6.get(texel, 0);
            *value = self.scaled(rows[p4], scale);
        }
    }
}
