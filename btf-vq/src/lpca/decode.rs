//! Random access to texels.

use super::{LpcaHeader, LpcaModel};
use crate::codebooks::level_size;
use crate::colour::from_luma_chroma;
use crate::{AngularGrid, Encoding, Taps};

/// A reader of one texture of an [`LpcaModel`](crate::LpcaModel).
#[derive(Clone, Debug)]
pub struct LpcaDecoder<'a> {
    header: &'a LpcaHeader,
    basis: &'a [u8],
    levels: Vec<(usize, usize, &'a [u8])>,
}

impl LpcaModel {
    /// Returns a reader of one of the textures, or `None` if there are fewer.
    pub fn decoder(&self, material: usize) -> Option<LpcaDecoder<'_>> {
        let texture = self.header().materials.get(material)?;
        let first = 1 + self.header().materials[..material].iter().map(|m| m.levels).sum::<usize>();
        let levels = (0..texture.levels)
            .map(|level| {
                let (width, height) = level_size(texture.width, texture.height, level);
                (width, height, self.stream(first + level))
            })
            .collect();
        Some(LpcaDecoder::new(self.header(), self.stream(0), levels))
    }
}

/// Most vectors of a space, the mean counted.
const MAX_VECTORS: usize = 65;

impl<'a> LpcaDecoder<'a> {
    /// `levels`: width, height and texels of each.
    pub(super) fn new(
        header: &'a LpcaHeader,
        basis: &'a [u8],
        levels: Vec<(usize, usize, &'a [u8])>,
    ) -> Self {
        Self { header, basis, levels }
    }
}

impl LpcaDecoder<'_> {
    /// Returns the grid of directions.
    pub fn grid(&self) -> &AngularGrid {
        &self.header.grid
    }

    /// Returns what values mean.
    pub fn encoding(&self) -> Encoding {
        self.header.encoding
    }

    /// Returns the number of resolutions.
    pub fn levels(&self) -> usize {
        self.levels.len()
    }

    /// Returns the texels in a row, and the rows, of a level; levels past the last are the last.
    pub fn size(&self, level: usize) -> (usize, usize) {
        let (width, height, _) = self.levels[level.min(self.levels.len() - 1)];
        (width, height)
    }

    /// Cluster of a texel, and the factors of its vectors' codes and their sum of minima.
    fn factors(
        &self,
        level: usize,
        texel: usize,
        factors: &mut [f32; MAX_VECTORS],
    ) -> (usize, f32) {
        let header = self.header;
        let bytes = &self.levels[level].2[texel * header.texel_len()..][..header.texel_len()];
        let (cluster, codes) = match header.clusters {
            1 => (0, bytes),
            _ => (usize::from(bytes[0]), &bytes[1..]),
        };
        let vectors = header.components + 1;
        let lines = &header.coefficients[cluster * header.components..][..header.components];
        let basis = &header.basis[cluster * vectors..][..vectors];
        factors[0] = basis[0].step;
        let mut constant = basis[0].min;
        for (at, (line, code)) in lines.iter().zip(codes).enumerate() {
            let x = line.decode(*code);
            factors[at + 1] = x * basis[at + 1].step;
            constant += x * basis[at + 1].min;
        }
        (cluster, constant)
    }

    /// Luminance and chrominances of a node of a cluster, given factors.
    #[inline]
    fn node(&self, cluster: usize, node: usize, factors: &[f32], constant: f32) -> [f32; 3] {
        let vectors = self.header.components + 1;
        let at = (cluster * self.header.grid.node_count() + node) * 3 * vectors;
        let codes = &self.basis[at..at + 3 * vectors];
        std::array::from_fn(|channel| {
            let row = &codes[channel * vectors..][..vectors];
            constant + row.iter().zip(factors).map(|(c, f)| f32::from(*c) * f).sum::<f32>()
        })
    }

    /// Returns the RGB, as [`LpcaDecoder::encoding`] says, of a texel of a level, interpolated between the nodes of
    /// `taps`.
    ///
    /// # Panics
    ///
    /// If there is no such level or texel.
    pub fn texel(&self, level: usize, texel: usize, taps: &Taps) -> [f32; 3] {
        let mut factors = [0.0; MAX_VECTORS];
        let (cluster, constant) = self.factors(level, texel, &mut factors);
        let mut sum = [0.0; 3];
        for (node, weight) in taps.nodes(&self.header.grid) {
            let value = self.node(cluster, node, &factors, constant);
            sum.iter_mut().zip(value).for_each(|(s, v)| *s += weight * v);
        }
        self.rgb(sum)
    }

    fn rgb(&self, [y, a, b]: [f32; 3]) -> [f32; 3] {
        match self.header.encoding {
            Encoding::Srgb => from_luma_chroma(Encoding::Srgb, [y.max(0.0), a, b]),
            Encoding::Linear if y > 0.0 => from_luma_chroma(Encoding::Linear, [y, a / y, b / y]),
            Encoding::Linear => [0.0; 3],
        }
    }

    /// Writes the RGB of a whole level for one pair of directions into `out`. Bases are interpolated once.
    ///
    /// # Panics
    ///
    /// If there is no such level or `out` is of another size.
    pub fn image(&self, level: usize, taps: &Taps, out: &mut [[f32; 3]]) {
        let (width, height, _) = self.levels[level];
        assert_eq!(out.len(), width * height, "a value for each texel");
        let vectors = self.header.components + 1;
        let nodes = taps.nodes(&self.header.grid);
        let mut basis = vec![0.0; self.header.clusters * 3 * vectors];
        for (cluster, target) in basis.chunks_exact_mut(3 * vectors).enumerate() {
            for (node, weight) in nodes {
                let at = (cluster * self.header.grid.node_count() + node) * 3 * vectors;
                let codes = &self.basis[at..at + 3 * vectors];
                target.iter_mut().zip(codes).for_each(|(t, c)| *t += weight * f32::from(*c));
            }
        }
        let mut factors = [0.0; MAX_VECTORS];
        for (texel, value) in out.iter_mut().enumerate() {
            let (cluster, constant) = self.factors(level, texel, &mut factors);
            let rows = &basis[cluster * 3 * vectors..][..3 * vectors];
            *value = self.rgb(std::array::from_fn(|channel| {
                let row = &rows[channel * vectors..][..vectors];
                constant + row.iter().zip(&factors).map(|(c, f)| c * f).sum::<f32>()
            }));
        }
    }

    /// Writes the luminance of a texel at all light nodes of a view of the grid into `out`: `[alpha][beta]`, at
    /// least 0.
    ///
    /// # Panics
    ///
    /// If there is no such level, texel or view, or `out` is shorter.
    pub fn view_luminance(&self, level: usize, texel: usize, view: usize, out: &mut [f32]) {
        let mut factors = [0.0; MAX_VECTORS];
        let (cluster, constant) = self.factors(level, texel, &mut factors);
        let slice = self.header.grid.slice_len();
        for (offset, value) in out[..slice].iter_mut().enumerate() {
            let node = view * slice + offset;
            *value = self.node(cluster, node, &factors, constant)[0].max(0.0);
        }
    }
}
