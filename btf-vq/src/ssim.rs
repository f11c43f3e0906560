//! Structural similarity of slices over light directions.
//!
//! Source: Z. Wang, A. Bovik, H. Sheikh and E. Simoncelli, "Image Quality Assessment: From Error
//! Visibility to Structural Similarity", IEEE Transactions on Image Processing 13(4), 2004; the window
//! lies in the angular domain, 5 × 5 nodes of (α, β) or 5 along β, mirrored at the rim.

/// Stabilizing constants for values in [0, 1].
const C1: f32 = 0.01 * 0.01;
const C2: f32 = 0.03 * 0.03;
/// Nodes on either side of the window's centre.
const RADIUS: usize = 2;

/// Buffers for slices `[rows][columns]`; one row for one-dimensional slices.
#[derive(Clone, Debug)]
pub(crate) struct SliceSsim {
    rows: usize,
    columns: usize,
    maps: [Vec<f32>; 5],
    scratch: Vec<f32>,
    /// A row with what the window sees beyond its ends.
    padded: Vec<f32>,
}

impl SliceSsim {
    pub(crate) fn new(rows: usize, columns: usize) -> Self {
        let map = vec![0.0; rows * columns];
        let padded = vec![0.0; columns + 2 * RADIUS];
        Self { rows, columns, maps: std::array::from_fn(|_| map.clone()), scratch: map, padded }
    }

    /// Adds 1 − SSIM at every node of every slice of `a` and `b`, values around [0, 1] after
    /// `offset` is added.
    pub(crate) fn dissimilarities(
        &mut self,
        a: &[f32],
        b: &[f32],
        offset: f32,
        out: &mut Vec<f32>,
    ) {
        let len = self.rows * self.columns;
        for (a, b) in a.chunks_exact(len).zip(b.chunks_exact(len)) {
            for (i, (a, b)) in a.iter().zip(b).enumerate() {
                let (a, b) = (a + offset, b + offset);
                let products = [a, b, a * a, b * b, a * b];
                self.maps.iter_mut().zip(products).for_each(|(map, v)| map[i] = v);
            }
            for map in &mut self.maps {
                box_filter(map, &mut self.padded, &mut self.scratch, self.rows, self.columns);
            }
            let [ma, mb, aa, bb, ab] = &self.maps;
            out.extend((0..len).map(|i| {
                let (product, squares) = (ma[i] * mb[i], ma[i] * ma[i] + mb[i] * mb[i]);
                let (covariance, variances) = (ab[i] - product, aa[i] + bb[i] - squares);
                let alike = (2.0 * product + C1) * (2.0 * covariance + C2);
                1.0 - alike / ((squares + C1) * (variances.max(0.0) + C2))
            }));
        }
    }
}

/// Means over the window, in place.
fn box_filter(
    map: &mut [f32],
    padded: &mut [f32],
    scratch: &mut [f32],
    rows: usize,
    columns: usize,
) {
    let width = 2 * RADIUS + 1;
    let share = 1.0 / width as f32;
    for (target, source) in scratch.chunks_exact_mut(columns).zip(map.chunks_exact(columns)) {
        padded[RADIUS..RADIUS + columns].copy_from_slice(source);
        for i in 0..RADIUS {
            padded[i] = source[mirrored(i, columns)];
            padded[RADIUS + columns + i] = source[mirrored(RADIUS + columns + i, columns)];
        }
        for (value, window) in target.iter_mut().zip(padded.array_windows::<{ 2 * RADIUS + 1 }>()) {
            *value = share * window.iter().sum::<f32>();
        }
    }
    if rows == 1 {
        map.copy_from_slice(scratch);
        return;
    }
    map.fill(0.0);
    for (i, target) in map.chunks_exact_mut(columns).enumerate() {
        for k in 0..width {
            let source = &scratch[mirrored(i + k, rows) * columns..][..columns];
            target.iter_mut().zip(source).for_each(|(t, s)| *t += share * s);
        }
    }
}

/// Place of `shifted` − 2 with the outermost value twice.
fn mirrored(shifted: usize, count: usize) -> usize {
    if shifted < RADIUS {
        (RADIUS - 1 - shifted).min(count - 1)
    } else if shifted - RADIUS < count {
        shifted - RADIUS
    } else {
        (2 * count + RADIUS - 1).saturating_sub(shifted).min(count - 1)
    }
}

/// The value below which 98 % lie, by nearest rank; 0 of none.
pub(crate) fn percentile_98(values: &mut [f32]) -> f32 {
    if values.is_empty() {
        return 0.0;
    }
    let rank = (values.len() * 98).div_ceil(100).max(1);
    *values.select_nth_unstable_by(rank - 1, f32::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_slices_are_alike_and_shifted_ones_are_not() {
        let a: Vec<f32> = (0..121_u8).map(|i| f32::from(i % 7) / 7.0).collect();
        let mut ssim = SliceSsim::new(11, 11);
        let mut same = Vec::new();
        ssim.dissimilarities(&a, &a, 0.0, &mut same);
        assert!(same.iter().all(|d| d.abs() < 1e-4), "{same:?}");
        let shifted: Vec<f32> = (0..121_u8).map(|i| f32::from((i + 3) % 7) / 7.0).collect();
        let mut other = Vec::new();
        ssim.dissimilarities(&a, &shifted, 0.0, &mut other);
        assert!(percentile_98(&mut other) > 0.5);
    }

    #[test]
    fn the_rim_is_mirrored() {
        let places: Vec<usize> = (0..15).map(|i| mirrored(i, 11)).collect();
        assert_eq!(places, [1, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 10, 9]);
    }

    #[test]
    fn ranks_are_the_nearest() {
        let mut values: Vec<f32> = (1..=100_u8).map(f32::from).collect();
        assert!((percentile_98(&mut values) - 98.0).abs() < 1e-6);
    }
}
