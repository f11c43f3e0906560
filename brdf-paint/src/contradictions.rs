//! Where views do not agree.

use std::collections::BTreeMap;

use crate::PaintSamples;
use crate::coefficient_map::nearest;

/// A measure of how far views are from each other in what they show of each place of the surface.
///
/// A place that one view shows brighter than the material is and another darker cannot be both. The measure is the
/// range, over the views, of the mean difference between a view's pixels in a cell and the material, in the channel
/// where it is largest. Views that show too few pixels of a cell do not count.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contradictions {
    /// Cells along each side of the texture coordinates.
    pub size: usize,
    /// Measure of each cell, row by row from v = 0, in f π (1 is a white diffuser).
    pub apart: Vec<f32>,
}

/// Cells along each side.
const CELLS: usize = 64;
/// Pixels of a cell that a view has to show.
const LEAST_PIXELS: f64 = 4.0;

impl Contradictions {
    /// Difference beyond which views contradict each other, in f π.
    pub const THRESHOLD: f64 = 0.25;

    /// Of samples and what a material gives for them.
    pub(crate) fn of(samples: &PaintSamples, predicted: &[[f32; 3]], wraps: bool) -> Self {
        let mut means: BTreeMap<(usize, usize), ([f64; 3], f64)> = BTreeMap::new();
        let found = predicted.iter().zip(&samples.values);
        for (((view, _), place), (found, wanted)) in
            samples.origins.iter().zip(&samples.places).zip(found)
        {
            let cell = nearest(CELLS, wraps, *place);
            let (sums, count) = means.entry((cell, *view)).or_default();
            for (sum, (found, wanted)) in sums.iter_mut().zip(found.iter().zip(wanted)) {
                *sum += f64::from(wanted - found);
            }
            *count += 1.0;
        }
        let mut ranges = vec![None::<([f64; 3], [f64; 3])>; CELLS * CELLS];
        for ((cell, _), (sums, count)) in means {
            if count < LEAST_PIXELS {
                continue;
            }
            let mean = sums.map(|sum| sum / count);
            let (low, high) = ranges[cell].get_or_insert((mean, mean));
            for (channel, mean) in mean.into_iter().enumerate() {
                low[channel] = low[channel].min(mean);
                high[channel] = high[channel].max(mean);
            }
        }
        let width = |(low, high): ([f64; 3], [f64; 3])| {
            high.iter().zip(low).map(|(high, low)| high - low).fold(0.0, f64::max)
        };
        #[expect(clippy::cast_possible_truncation, reason = "a picture")]
        let apart = ranges.into_iter().map(|range| range.map_or(0.0, width) as f32).collect();
        Self { size: CELLS, apart }
    }

    /// Returns the number of cells that contradict themselves.
    pub fn count(&self) -> usize {
        self.apart.iter().filter(|apart| f64::from(**apart) > Self::THRESHOLD).count()
    }
}
