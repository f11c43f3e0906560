//! Symmetric matrices that are 0 far from the diagonal, as least squares over splines have them.

use pulp::Arch;

/// The lower triangle of a symmetric matrix in which only so many entries of a row, up to the diagonal, are not 0.
#[derive(Clone, Debug)]
pub(crate) struct Banded {
    size: usize,
    width: usize,
    /// Of each row the last `width` entries up to the diagonal, those left of the matrix 0.
    rows: Vec<f64>,
}

/// A factored matrix: L of A = L Lᵀ.
#[derive(Clone, Debug)]
pub(crate) struct Factored {
    lower: Banded,
}

impl Banded {
    pub(crate) fn zeros(size: usize, width: usize) -> Self {
        Self { size, width, rows: vec![0.0; size * width] }
    }

    /// Where row `i` has its entries of columns `from` up to `to`, which are within the band.
    fn range(&self, i: usize, from: usize, to: usize) -> std::ops::Range<usize> {
        let first = i * self.width + self.width - 1 - i;
        first + from..first + to
    }

    /// Entries of row `i` from column `from` on, `count` of them, none right of the diagonal.
    pub(crate) fn row_mut(&mut self, i: usize, from: usize, count: usize) -> &mut [f64] {
        let range = self.range(i, from, from + count);
        &mut self.rows[range]
    }

    /// Adds to an entry; `j` is at most `i`.
    pub(crate) fn add(&mut self, i: usize, j: usize, value: f64) {
        self.row_mut(i, j, 1)[0] += value;
    }

    pub(crate) fn mean_diagonal(&self) -> f64 {
        let diagonal = self.rows.iter().skip(self.width - 1).step_by(self.width);
        diagonal.sum::<f64>() / self.size as f64
    }

    /// Returns the factored matrix, or none if it is not positive definite.
    pub(crate) fn cholesky(mut self) -> Option<Factored> {
        let is_definite = Arch::new().dispatch(|| self.factor());
        is_definite.then_some(Factored { lower: self })
    }

    #[inline(always)]
    fn factor(&mut self) -> bool {
        for i in 0..self.size {
            let left = (i + 1).saturating_sub(self.width);
            let (before, own) = self.rows.split_at_mut(i * self.width);
            let own = &mut own[self.width - 1 - (i - left)..self.width];
            for j in left..i {
                let from = left.max((j + 1).saturating_sub(self.width));
                let row = &before[j * self.width..(j + 1) * self.width];
                let known = dot(
                    &own[from - left..j - left],
                    &row[self.width - 1 - (j - from)..self.width - 1],
                );
                own[j - left] = (own[j - left] - known) / row[self.width - 1];
            }
            let (diagonal, rest) = own.split_last_mut().expect("a row holds its diagonal");
            let square = *diagonal - dot(rest, rest);
            if square <= 0.0 || !square.is_finite() {
                return false;
            }
            *diagonal = square.sqrt();
        }
        true
    }
}

impl Factored {
    /// Number of unknowns.
    pub(crate) fn size(&self) -> usize {
        self.lower.size
    }

    /// Entries of row `i` left of the diagonal, with the column of the first, and the diagonal.
    #[inline(always)]
    fn row(&self, i: usize) -> (usize, &[f64], f64) {
        let Banded { width, rows, .. } = &self.lower;
        let left = (i + 1).saturating_sub(*width);
        let row = &rows[i * width + width - 1 - (i - left)..(i + 1) * width];
        (left, &row[..i - left], row[i - left])
    }

    /// Solves for the right-hand side, in place.
    pub(crate) fn solve(&self, side: &mut [f64]) {
        Arch::new().dispatch(|| {
            for i in 0..side.len() {
                let (left, row, diagonal) = self.row(i);
                side[i] = (side[i] - dot(row, &side[left..i])) / diagonal;
            }
            for i in (0..side.len()).rev() {
                let (left, row, diagonal) = self.row(i);
                let value = side[i] / diagonal;
                side[i] = value;
                add(-value, row, &mut side[left..i]);
            }
        });
    }

    /// Returns multiples of steps near `wanted` in the norm of the matrix: from the last to the first, each makes up
    /// for what rounding did to those after it (L. Babai's nearest plane).
    pub(crate) fn nearest_plane(&self, wanted: &[f64], steps: &[f64]) -> Vec<i32> {
        let mut rounded = vec![0; wanted.len()];
        // Lᵀ times what rounding took from later ones.
        let mut owed = vec![0.0; wanted.len()];
        Arch::new().dispatch(|| {
            for i in (0..wanted.len()).rev() {
                let (left, row, diagonal) = self.row(i);
                let aim = wanted[i] + owed[i] / diagonal;
                let count = (aim / steps[i]).round().clamp(-4e6, 4e6);
                #[expect(clippy::cast_possible_truncation, reason = "within the range of an i32")]
                {
                    rounded[i] = count as i32;
                }
                add(wanted[i] - count * steps[i], row, &mut owed[left..i]);
            }
        });
        rounded
    }
}

/// Returns Σ aᵢ bᵢ, in an order that suits vectors.
#[inline(always)]
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    const LANES: usize = 8;
    let (a, a_rest) = a.as_chunks::<LANES>();
    let (b, b_rest) = b.as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for (a, b) in a.iter().zip(b) {
        for lane in 0..LANES {
            sums[lane] += a[lane] * b[lane];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + rest
}

/// Adds a multiple of `row`.
#[inline(always)]
pub(crate) fn add(factor: f64, row: &[f64], to: &mut [f64]) {
    to.iter_mut().zip(row).for_each(|(to, row)| *to += factor * row);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A matrix of a band of three, and what it is times a vector.
    fn example(size: usize) -> (Banded, Vec<f64>, Vec<f64>) {
        let mut matrix = Banded::zeros(size, 3);
        let entry = |i: usize, j: usize| match i - j {
            0 => 4.0 + (i as f64).sin(),
            1 => 1.0 - 0.1 * i as f64,
            _ => 0.5,
        };
        let vector: Vec<f64> = (0..size).map(|i| (1.7 * i as f64).cos()).collect();
        let mut side = vec![0.0; size];
        for i in 0..size {
            for j in i.saturating_sub(2)..=i {
                matrix.add(i, j, entry(i, j));
                side[i] += entry(i, j) * vector[j];
                if i != j {
                    side[j] += entry(i, j) * vector[i];
                }
            }
        }
        (matrix, vector, side)
    }

    #[test]
    fn solutions_solve() {
        for size in [1, 2, 3, 20] {
            let (matrix, vector, mut side) = example(size);
            matrix.cholesky().expect("definite").solve(&mut side);
            for (found, wanted) in side.iter().zip(&vector) {
                assert!((found - wanted).abs() < 1e-12, "{found} for {wanted} of {size}");
            }
        }
    }

    #[test]
    fn what_is_not_definite_has_no_root() {
        let mut matrix = Banded::zeros(2, 2);
        matrix.row_mut(0, 0, 1)[0] = 1.0;
        matrix.row_mut(1, 0, 2).copy_from_slice(&[2.0, 1.0]);
        assert!(matrix.cholesky().is_none());
    }

    /// Rounded one by one, numbers are nearer in the matrix' norm than each rounded by itself.
    #[test]
    fn rounding_makes_up_for_rounding() {
        let size = 40;
        let mut matrix = Banded::zeros(size, 2);
        for i in 0..size {
            matrix.add(i, i, 1.0);
            if i > 0 {
                matrix.add(i, i - 1, 0.49);
            }
        }
        let wanted: Vec<f64> = (0..size).map(|i| 3.0 * (0.9 * i as f64).sin()).collect();
        let norm = |found: &[i32]| -> f64 {
            let off: Vec<f64> = found.iter().zip(&wanted).map(|(&f, w)| f64::from(f) - w).collect();
            let squares: f64 = off.iter().map(|v| v * v).sum();
            let beside: f64 = off.windows(2).map(|pair| pair[0] * pair[1]).sum();
            squares + 0.98 * beside
        };
        let near = matrix.cholesky().expect("definite").nearest_plane(&wanted, &vec![1.0; size]);
        #[expect(clippy::cast_possible_truncation, reason = "between -3 and 3")]
        let alone: Vec<i32> = wanted.iter().map(|w| w.round() as i32).collect();
        assert!(norm(&near) < 0.8 * norm(&alone), "{} against {}", norm(&near), norm(&alone));
    }
}
