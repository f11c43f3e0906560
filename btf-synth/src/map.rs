//! A map of one channel over a tile that repeats in both directions.

use crate::SynthError;

/// The longest side of a map that is read: a scan of 16k texels, 1 GiB in f32.
const LARGEST_SIDE: usize = 16_384;

/// A map of one channel over a tile; row-major, the first row has the largest y. All values are finite.
///
/// ```
/// use btf_synth::Map;
///
/// let ramp = Map::new(4, 1, vec![0.0, 1.0, 2.0, 5.0])?;
/// assert_eq!(ramp.stretched(1.0).range(), [0.0, 1.0]);
/// assert_eq!(ramp.box_filtered(2, 1)?.values(), [0.5, 3.5]);
/// # Ok::<(), btf_synth::SynthError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    width: usize,
    height: usize,
    values: Vec<f32>,
}

impl Map {
    /// Returns a map of row-major values.
    ///
    /// # Errors
    ///
    /// [`SynthError::Size`] for an empty or overlong side; [`SynthError::Length`];
    /// [`SynthError::Value`] for a value that is not finite.
    pub fn new(width: usize, height: usize, values: Vec<f32>) -> Result<Self, SynthError> {
        let sides = 1..=LARGEST_SIDE;
        if !sides.contains(&width) || !sides.contains(&height) {
            return Err(SynthError::Size { width, height, largest: LARGEST_SIDE });
        }
        let expected = width * height;
        if values.len() != expected {
            return Err(SynthError::Length { what: "map", found: values.len(), expected });
        }
        if let Some(texel) = values.iter().position(|value| !value.is_finite()) {
            let value = values[texel];
            return Err(SynthError::Value {
                what: "map",
                texel,
                value,
                expected: "a finite number",
            });
        }
        Ok(Self { width, height, values })
    }

    /// Returns a map with the same value everywhere.
    ///
    /// # Errors
    ///
    /// As [`Map::new`].
    pub fn constant(width: usize, height: usize, value: f32) -> Result<Self, SynthError> {
        let sides = 1..=LARGEST_SIDE;
        if !sides.contains(&width) || !sides.contains(&height) {
            return Err(SynthError::Size { width, height, largest: LARGEST_SIDE });
        }
        Self::new(width, height, vec![value; width * height])
    }

    /// Returns the number of texels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Returns the number of rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Returns the values, row-major.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// Returns the smallest and the largest value.
    pub fn range(&self) -> [f32; 2] {
        self.values.iter().fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], &value| {
            [low.min(value), high.max(value)]
        })
    }

    /// Returns the map with hills and valleys exchanged: every value is subtracted from the sum of the smallest and
    /// the largest.
    #[must_use]
    pub fn inverted(&self) -> Self {
        let [low, high] = self.range();
        self.with(|value| low + high - value)
    }

    /// Returns the map with every value times a factor.
    #[must_use]
    pub fn scaled(&self, factor: f32) -> Self {
        self.with(|value| factor * value)
    }

    /// Returns the map stretched and shifted so that the smallest value is 0 and the largest `span`. A constant map
    /// becomes 0.
    #[must_use]
    pub fn stretched(&self, span: f32) -> Self {
        let [low, high] = self.range();
        let scale = if high > low { span / (high - low) } else { 0.0 };
        self.with(|value| (value - low) * scale)
    }

    /// Returns the whole map resampled to `width` × `height` texels, each the mean over the area that it covers; a
    /// texel larger than that area is repeated.
    ///
    /// # Errors
    ///
    /// [`SynthError::Size`].
    pub fn box_filtered(&self, width: usize, height: usize) -> Result<Self, SynthError> {
        let sides = 1..=LARGEST_SIDE;
        if !sides.contains(&width) || !sides.contains(&height) {
            return Err(SynthError::Size { width, height, largest: LARGEST_SIDE });
        }
        if [width, height] == [self.width, self.height] {
            return Ok(self.clone());
        }
        let columns = BoxFilter::new(self.width, width);
        let rows = BoxFilter::new(self.height, height);
        let narrowed: Vec<f64> =
            self.values.chunks_exact(self.width).flat_map(|row| columns.apply(row)).collect();
        let values = (0..height)
            .flat_map(|row| (0..width).map(move |column| (row, column)))
            .map(|(row, column)| rows.mean(row, |from| narrowed[from * width + column]))
            .collect();
        Self::new(width, height, values)
    }

    fn with(&self, change: impl Fn(f32) -> f32) -> Self {
        let values = self.values.iter().map(|&value| change(value)).collect();
        Self { values, ..*self }
    }
}

/// Which texels a resampled one covers, and by how much.
struct BoxFilter {
    /// First texel and the weights from there on, which sum to 1; one entry for each result.
    taps: Vec<(usize, Vec<f64>)>,
}

impl BoxFilter {
    fn new(from: usize, to: usize) -> Self {
        // Exact in integers: both rasters are laid over one of from · to cells.
        let tap = |target: usize| {
            let (start, end) = (target * from, (target + 1) * from);
            let (first, last) = (start / to, (end - 1) / to);
            let weights = (first..=last)
                .map(|texel| {
                    let overlap = end.min((texel + 1) * to) - start.max(texel * to);
                    overlap as f64 / from as f64
                })
                .collect();
            (first, weights)
        };
        Self { taps: (0..to).map(tap).collect() }
    }

    fn apply<'a>(&'a self, row: &'a [f32]) -> impl Iterator<Item = f64> + 'a {
        self.taps.iter().map(|(first, weights)| {
            weights.iter().zip(&row[*first..]).map(|(w, &v)| w * f64::from(v)).sum()
        })
    }

    #[expect(clippy::cast_possible_truncation, reason = "means of f32 values, stored as f32")]
    fn mean(&self, target: usize, value: impl Fn(usize) -> f64) -> f32 {
        let (first, weights) = &self.taps[target];
        weights.iter().enumerate().map(|(i, w)| w * value(first + i)).sum::<f64>() as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_filter_keeps_the_mean_and_weighs_by_area() {
        let map = Map::new(3, 1, vec![0.0, 3.0, 6.0]).unwrap();
        let narrow = map.box_filtered(2, 1).unwrap();
        assert_eq!(narrow.values(), [1.0, 5.0]);
        let wide = map.box_filtered(6, 2).unwrap();
        assert_eq!(wide.values()[..6], [0.0, 0.0, 3.0, 3.0, 6.0, 6.0]);
    }

    #[test]
    fn sizes_lengths_and_values_are_checked() {
        assert!(matches!(Map::new(0, 4, vec![]), Err(SynthError::Size { .. })));
        assert!(matches!(Map::new(2, 2, vec![0.0; 3]), Err(SynthError::Length { .. })));
        let nan = Map::new(2, 1, vec![0.0, f32::NAN]);
        assert!(matches!(nan, Err(SynthError::Value { texel: 1, .. })));
        let map = Map::constant(2, 2, 1.0).unwrap();
        assert!(map.box_filtered(0, 2).is_err());
    }

    #[test]
    fn inverting_and_stretching_keep_the_order_they_promise() {
        let map = Map::new(3, 1, vec![2.0, 3.0, 6.0]).unwrap();
        assert_eq!(map.inverted().values(), [6.0, 5.0, 2.0]);
        assert_eq!(map.stretched(8.0).values(), [0.0, 2.0, 8.0]);
        assert_eq!(Map::constant(2, 1, 5.0).unwrap().stretched(1.0).values(), [0.0, 0.0]);
    }
}
