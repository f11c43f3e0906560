//! Coarser levels of a source: means of its texels in linear light.

use std::ops::Range;

use crate::codebooks::level_size;
use crate::{BtfLayout, BtfSource, Encoding, SourceError};
use brdf_model::{linear_to_srgb, srgb_to_linear};

/// A source at a coarser level; level 1 has half as many texels in a row.
#[derive(Clone)]
pub struct Mipped<'a> {
    source: &'a dyn BtfSource,
    layout: BtfLayout,
}

impl std::fmt::Debug for Mipped<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Mipped").field("width", &self.layout.width).finish_non_exhaustive()
    }
}

impl<'a> Mipped<'a> {
    /// Returns a level of a source; level 0 is the source itself.
    pub fn new(source: &'a dyn BtfSource, level: usize) -> Self {
        let mut layout = source.layout().clone();
        (layout.width, layout.height) = level_size(layout.width, layout.height, level);
        Self { source, layout }
    }

    /// Returns the number of levels until a single texel is left, the finest counted.
    pub fn count(layout: &BtfLayout) -> usize {
        layout.width.max(layout.height).checked_ilog2().map_or(1, |log| log as usize + 1)
    }
}

impl BtfSource for Mipped<'_> {
    fn layout(&self) -> &BtfLayout {
        &self.layout
    }

    fn read_texels(&self, texels: Range<usize>, out: &mut [f32]) -> Result<(), SourceError> {
        let fine = self.source.layout();
        let (width, height) = (self.layout.width, self.layout.height);
        let count = texels.len();
        let images = fine.image_count();
        let is_srgb = fine.encoding == Encoding::Srgb;
        let mut row = Vec::new();
        for (at, texel) in texels.enumerate() {
            let (x, y) = (texel % width, texel / width);
            let columns = x * fine.width / width..(x + 1) * fine.width / width;
            let rows = y * fine.height / height..(y + 1) * fine.height / height;
            let share = 1.0 / (columns.len() * rows.len()) as f32;
            let mut sums = vec![[0.0_f32; 3]; images];
            for y in rows {
                row.resize(images * 3 * columns.len(), 0.0);
                let start = y * fine.width;
                self.source.read_texels(start + columns.start..start + columns.end, &mut row)?;
                for (sum, values) in sums.iter_mut().zip(row.chunks_exact(3 * columns.len())) {
                    for (i, v) in values.iter().enumerate() {
                        sum[i % 3] += share * if is_srgb { srgb_to_linear(*v) } else { *v };
                    }
                }
            }
            for (image, sum) in sums.into_iter().enumerate() {
                let mean = if is_srgb { sum.map(linear_to_srgb) } else { sum };
                out[(image * count + at) * 3..][..3].copy_from_slice(&mean);
            }
        }
        Ok(())
    }
}
