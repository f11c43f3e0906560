//! Random access: any texel for any light and view, straight from the packed books.

use std::array::from_fn;

use brdf_model::LinearDistributions;
use glam::DVec3;

use crate::bits::{PackedEntries, index_bits};
use crate::codebooks::level_size;
use crate::colour::from_luma_chroma;
use crate::{AngularGrid, Chroma, Encoding, LightTaps, Pair, Quantizer, ViewTaps, VqModel};

/// The nodes around a pair of directions and their weights: made once, used for many texels.
///
/// ```
/// use btf_vq::{AngularGrid, Taps};
/// use glam::DVec3;
///
/// let grid = AngularGrid::default();
/// let taps = Taps::new(&grid, DVec3::Z, DVec3::new(0.6, 0.0, 0.8));
/// let sum: f32 = taps.nodes(&grid).iter().map(|(_, weight)| weight).sum();
/// assert!((sum - 1.0).abs() < 1e-5);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Taps {
    /// Nodes around the view direction.
    pub view: ViewTaps,
    /// Nodes around the light direction, relative to the view's azimuth.
    pub light: LightTaps,
}

impl Taps {
    /// Returns the taps of unit directions of the upper hemisphere.
    #[inline]
    pub fn new(grid: &AngularGrid, wi: DVec3, wo: DVec3) -> Self {
        let (view, azimuth) = grid.view_taps(wo);
        Self { view, light: grid.light_taps(wi, azimuth) }
    }

    /// Returns the 16 nodes around the directions, of one channel, and their weights, which sum to 1.
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
    fn new(bytes: &'a [u8], len: usize, target_rows: usize, scale: &Quantizer) -> Self {
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
    fn get(&self, row: usize, at: usize) -> (usize, f32) {
        self.split(self.entries.get(row * self.len + at))
    }

    /// The same of two entries of a row, `at` and the next.
    #[inline]
    fn pair(&self, row: usize, at: usize) -> [(usize, f32); 2] {
        self.entries.pair(row * self.len + at).map(|entry| self.split(entry))
    }

    #[inline]
    #[expect(clippy::cast_possible_truncation, reason = "masked to the bits of a row")]
    fn split(&self, entry: u64) -> (usize, f32) {
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

impl PlainBook<'_> {
    /// Two codes of a row, `at` and the next.
    #[inline]
    #[expect(clippy::cast_possible_truncation, reason = "entries hold an index")]
    fn pair(&self, row: usize, at: usize) -> [usize; 2] {
        self.entries.pair(row * self.len + at).map(|entry| entry as usize)
    }
}

/// Texels that are decoded together.
pub(crate) const ABREAST: usize = 8;

/// A row on the way down the books, the product of scales that led there and the share of its node.
#[derive(Clone, Copy, Debug, Default)]
struct Branch {
    row: usize,
    scale: f32,
    weight: f32,
}

/// Rows of P1 and I1, and the scale of the former.
#[derive(Clone, Copy, Debug, Default)]
struct LineRows {
    p1: usize,
    scale: f32,
    i1: usize,
}

/// A level of a texture, ready to read.
#[derive(Clone, Debug)]
struct Texture<'a> {
    width: usize,
    height: usize,
    p6: ScaledBook<'a>,
}

/// A reader of one texture of a compressed BTF, straight from its packed bits.
#[derive(Clone, Debug)]
pub struct Decoder<'a> {
    grid: AngularGrid,
    encoding: Encoding,
    chroma: Chroma,
    rows: usize,
    /// Codes of P1, a byte each.
    p1: &'a [u8],
    /// Values of P1's codes.
    p1_values: Vec<f32>,
    p2: ScaledBook<'a>,
    /// C, unpacked: it is small and read most.
    colours: Vec<[f32; 2]>,
    i1: PlainBook<'a>,
    i2: PlainBook<'a>,
    m: PackedEntries<'a>,
    m_low_bits: u32,
    p3: ScaledBook<'a>,
    p4: ScaledBook<'a>,
    levels: Vec<Texture<'a>>,
    /// Integrals of rows of P1 over β up to each node, in nodes.
    p1_below: LinearDistributions,
    /// Integrals of rows of P2 over all β and over α up to each node, in nodes.
    p2_below: LinearDistributions,
    /// The last of these: of the whole slice.
    p2_mass: Vec<f32>,
    /// Rectangles between nodes of the light grid.
    pub(crate) cells_per_steradian: f64,
}

impl VqModel {
    /// Returns a reader of one of the textures, or `None` if there are fewer.
    pub fn decoder(&self, material: usize) -> Option<Decoder<'_>> {
        let header = self.header();
        let texture = header.materials.get(material)?;
        let (grid, rows) = (header.grid, header.rows);
        let plain = |stream, len, bits| PlainBook {
            entries: PackedEntries::new(self.stream(stream), bits),
            len,
        };
        let before = header.materials[..material].iter();
        let first = 8 + before.map(|m| m.info.levels).sum::<usize>();
        let levels = (0..texture.info.levels).map(|level| {
            let (width, height) = level_size(texture.info.width, texture.info.height, level);
            let bytes = self.stream(first + level);
            Texture { width, height, p6: ScaledBook::new(bytes, 1, rows.p4, &texture.scale) }
        });
        let m_low_bits = index_bits(rows.p2);
        let chromas = header.c.map(|quantizer| quantizer.table());
        let colours = self.stream(2).as_chunks::<2>().0.iter();
        let mut decoder = Decoder {
            grid,
            encoding: header.encoding,
            chroma: header.chroma,
            rows: rows.p4,
            p1: self.stream(0),
            p1_values: header.p1.table(),
            p2: ScaledBook::new(self.stream(1), grid.alphas, rows.p1, &header.p2),
            colours: colours
                .map(|c| [chromas[0][usize::from(c[0])], chromas[1][usize::from(c[1])]])
                .collect(),
            i1: plain(3, grid.betas, index_bits(rows.c)),
            i2: plain(4, grid.alphas, index_bits(rows.i1)),
            m: PackedEntries::new(self.stream(5), m_low_bits + index_bits(rows.i2)),
            m_low_bits,
            p3: ScaledBook::new(self.stream(6), grid.thetas, rows.m, &header.p3),
            p4: ScaledBook::new(self.stream(7), grid.phis, rows.p3, &header.p4),
            levels: levels.collect(),
            p1_below: LinearDistributions::default(),
            p2_below: LinearDistributions::default(),
            p2_mass: Vec::new(),
            cells_per_steradian: grid.cell_solid_angle().recip(),
        };
        decoder.p1_below =
            LinearDistributions::new(grid.betas, rows.p1, |row, at| decoder.p1_value(row, at));
        decoder.p2_below = LinearDistributions::new(grid.alphas, rows.p2, |row, at| {
            let (p1, scale) = decoder.p2.get(row, at);
            scale * decoder.p1_below.total(p1)
        });
        decoder.p2_mass = (0..rows.p2).map(|row| decoder.p2_below.total(row)).collect();
        Some(decoder)
    }
}

impl Decoder<'_> {
    /// Returns the grid of directions.
    pub fn grid(&self) -> &AngularGrid {
        &self.grid
    }

    /// Returns what values mean.
    pub fn encoding(&self) -> Encoding {
        self.encoding
    }

    /// Returns the number of resolutions.
    pub fn levels(&self) -> usize {
        self.levels.len()
    }

    /// Returns the texels in a row, and the rows, of a level; levels past the last are the last.
    pub fn size(&self, level: usize) -> (usize, usize) {
        let texture = &self.levels[level.min(self.levels.len() - 1)];
        (texture.width, texture.height)
    }

    /// Returns the RGB, as [`Decoder::encoding`] says, of a texel (row-major) of a level, interpolated between the
    /// nodes of `taps`.
    ///
    /// # Panics
    ///
    /// If there is no such level, or taps are of a larger grid. Texels past the end give some other
    /// texel's value.
    #[inline]
    pub fn texel(&self, level: usize, texel: usize, taps: &Taps) -> [f32; 3] {
        let [value] = self.texels(level, [texel], [taps]);
        value
    }

    #[inline]
    fn texels<const N: usize>(
        &self,
        level: usize,
        texels: [usize; N],
        taps: [&Taps; N],
    ) -> [[f32; 3]; N] {
        let (mut p4, mut scales) = ([0; N], [0.0; N]);
        for ((texel, p4), scale) in texels.into_iter().zip(&mut p4).zip(&mut scales) {
            (*p4, *scale) = self.levels[level].p6.get(texel, 0);
        }
        let mut values = self.rows(p4, taps);
        for (value, scale) in values.iter_mut().zip(scales) {
            *value = self.scaled(*value, scale);
        }
        values
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

    /// Luminance of unit scale and chrominances of rows of P4 between the nodes around `taps`.
    ///
    /// Rows go down the books abreast: what one waits for in memory, the others need not.
    #[inline]
    fn rows<const N: usize>(&self, p4: [usize; N], taps: [&Taps; N]) -> [[f32; 3]; N] {
        let views = self.views(p4, taps.map(|taps| &taps.view));
        let mut slices = [[(0, 0); 4]; N];
        for (views, slices) in views.iter().zip(&mut slices) {
            for (view, slice) in views.iter().zip(slices) {
                *slice = self.merged(view.row);
            }
        }
        let mut lines = [[[LineRows::default(); 2]; 4]; N];
        for ((slices, taps), lines) in slices.iter().zip(taps).zip(&mut lines) {
            for ((p2, i2), lines) in slices.iter().zip(lines) {
                let alpha = taps.light.alpha.at[0];
                let (p1, i1) = (self.p2.pair(*p2, alpha), self.i2.pair(*i2, alpha));
                for i in 0..2 {
                    lines[i] = LineRows { p1: p1[i].0, scale: p1[i].1, i1: i1[i] };
                }
            }
        }
        let mut sums = [[0.0; 3]; N];
        for (((views, lines), taps), sum) in views.iter().zip(&lines).zip(taps).zip(&mut sums) {
            for (view, lines) in views.iter().zip(lines) {
                let mut slice = [0.0; 3];
                for (line, weight) in lines.iter().zip(taps.light.alpha.weight) {
                    let part = self.line(line, &taps.light.beta);
                    slice.iter_mut().zip(part).for_each(|(s, v)| *s += weight * v);
                }
                let weight = view.weight * view.scale;
                let chroma = if self.chroma == Chroma::Relative { weight } else { view.weight };
                sum[0] += weight * slice[0];
                sum[1] += chroma * slice[1];
                sum[2] += chroma * slice[2];
            }
        }
        sums
    }

    /// Rows of M at the four nodes around each view.
    #[inline]
    fn views<const N: usize>(&self, p4: [usize; N], taps: [&ViewTaps; N]) -> [[Branch; 4]; N] {
        let mut views = [[Branch::default(); 4]; N];
        for ((p4, ViewTaps { phi, theta }), views) in p4.into_iter().zip(taps).zip(&mut views) {
            for (i, pair) in views.as_chunks_mut::<2>().0.iter_mut().enumerate() {
                let (p3, scale) = self.p4.get(p4, phi.at[i]);
                // Rows of P3, until the next loop.
                *pair = theta.weight.map(|w| Branch { row: p3, scale, weight: phi.weight[i] * w });
            }
        }
        for (views, taps) in views.iter_mut().zip(taps) {
            for pair in views.as_chunks_mut::<2>().0 {
                let entries = self.p3.pair(pair[0].row, taps.theta.at[0]);
                for (view, (m, scale)) in pair.iter_mut().zip(entries) {
                    (view.row, view.scale) = (m, view.scale * scale);
                }
            }
        }
        views
    }

    /// Luminance and chrominances along β.
    #[inline(always)] // left to the compiler it stays a call
    fn line(&self, line: &LineRows, beta: &Pair) -> [f32; 3] {
        let values = self.p1_pair(line.p1, beta.at[0]);
        let colours = self.i1.pair(line.i1, beta.at[0]);
        let mut sum = [0.0; 3];
        for i in 0..2 {
            let luma = beta.weight[i] * line.scale * values[i];
            let chroma = if self.chroma == Chroma::Relative { luma } else { beta.weight[i] };
            let [a, b] = self.colours[colours[i]];
            sum[0] += luma;
            sum[1] += chroma * a;
            sum[2] += chroma * b;
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

    /// Two values of a row of P1, at a β and the next.
    #[inline]
    pub(crate) fn p1_pair(&self, row: usize, beta: usize) -> [f32; 2] {
        let codes = &self.p1[row * self.grid.betas + beta..][..2];
        [self.p1_values[usize::from(codes[0])], self.p1_values[usize::from(codes[1])]]
    }

    /// A value of a row of P1.
    #[inline]
    fn p1_value(&self, row: usize, beta: usize) -> f32 {
        self.p1_values[usize::from(self.p1[row * self.grid.betas + beta])]
    }

    /// Integrals over β of a row of P1 up to each node, in nodes.
    #[inline]
    pub(crate) fn p1_below(&self, row: usize) -> &[f32] {
        self.p1_below.row(row)
    }

    /// Rows of P1 and scales that a row of P2 has at an α and the next.
    #[inline]
    pub(crate) fn p1_rows(&self, p2: usize, alpha: usize) -> [(usize, f32); 2] {
        self.p2.pair(p2, alpha)
    }

    /// Integrals over all β, and over α up to each node, of a row of P2.
    #[inline]
    pub(crate) fn p2_below(&self, row: usize) -> &[f32] {
        self.p2_below.row(row)
    }

    /// Integral over α and β of a row of P2.
    #[inline]
    pub(crate) fn slice_mass(&self, p2: usize) -> f32 {
        self.p2_mass[p2]
    }

    /// Rows of P2 of texels of the finest level at the four nodes around each view, and what they count,
    /// without the scale of P6.
    #[inline]
    pub(crate) fn view_slices<const N: usize>(
        &self,
        texels: [usize; N],
        views: [&ViewTaps; N],
    ) -> [[(usize, f32); 4]; N] {
        let mut p4 = [0; N];
        for (p4, texel) in p4.iter_mut().zip(texels) {
            *p4 = self.levels[0].p6.get(texel, 0).0;
        }
        let mut slices = [[(0, 0.0); 4]; N];
        for (views, slices) in self.views(p4, views).iter().zip(&mut slices) {
            for (view, slice) in views.iter().zip(slices) {
                *slice = (self.merged(view.row).0, view.scale * view.weight);
            }
        }
        slices
    }

    /// A row of P2 between nodes: the lower ones along α and β, and the parts beyond them.
    #[inline]
    pub(crate) fn slice_luminance(
        &self,
        p2: usize,
        [alpha, beta]: [usize; 2],
        [across, along]: [f32; 2],
    ) -> f32 {
        let lines = self.p2.pair(p2, alpha).map(|(p1, scale)| {
            let [low, high] = self.p1_pair(p1, beta);
            scale * ((1.0 - along) * low + along * high)
        });
        (1.0 - across) * lines[0] + across * lines[1]
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

    /// Writes the RGB of many texels of the finest level, each with taps of its own, into `out`.
    ///
    /// # Panics
    ///
    /// Unless `out` is as long as `queries`.
    pub fn batch(&self, queries: &[(usize, Taps)], out: &mut [[f32; 3]]) {
        assert_eq!(queries.len(), out.len(), "a value for each query");
        let (groups, rest) = queries.as_chunks::<ABREAST>();
        let (out_groups, out_rest) = out.as_chunks_mut::<ABREAST>();
        for (group, values) in groups.iter().zip(out_groups) {
            *values = self.texels(0, from_fn(|q| group[q].0), from_fn(|q| &group[q].1));
        }
        for ((texel, taps), value) in rest.iter().zip(out_rest) {
            *value = self.texel(0, *texel, taps);
        }
    }

    /// Writes the RGB of consecutive texels of a level, from `first` on, for one pair of directions into `out`.
    ///
    /// # Panics
    ///
    /// If there is no such level.
    pub fn run(&self, level: usize, first: usize, taps: &Taps, out: &mut [[f32; 3]]) {
        let (groups, rest) = out.as_chunks_mut::<ABREAST>();
        let mut texel = first;
        for values in groups {
            *values = self.texels(level, from_fn(|q| texel + q), [taps; ABREAST]);
            texel += ABREAST;
        }
        for value in rest {
            *value = self.texel(level, texel, taps);
            texel += 1;
        }
    }

    /// Writes the RGB of a whole level for one pair of directions into `out`. Every row of P4 is decoded once.
    ///
    /// # Panics
    ///
    /// If there is no such level or `out` is of another size.
    pub fn image(&self, level: usize, taps: &Taps, out: &mut [[f32; 3]]) {
        let texture = &self.levels[level];
        assert_eq!(out.len(), texture.width * texture.height, "a value for each texel");
        let rows: Vec<[f32; 3]> = (0..self.rows).flat_map(|p4| self.rows([p4], [taps])).collect();
        for (texel, value) in out.iter_mut().enumerate() {
            let (p4, scale) = texture.p6.get(texel, 0);
            *value = self.scaled(rows[p4], scale);
        }
    }
}
