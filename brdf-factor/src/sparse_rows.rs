//! A sparse matrix in compressed rows, and the products that least squares needs.

use faer::Mat;

/// Rows of (column, value) entries; a column may occur more than once in a row and its values add.
#[derive(Clone, Debug, PartialEq)]
pub struct SparseRows {
    columns: usize,
    /// Where each row ends.
    ends: Vec<usize>,
    entries: Vec<(u32, f64)>,
}

impl SparseRows {
    /// A matrix without rows.
    pub fn new(columns: usize) -> Self {
        Self { columns, ends: Vec::new(), entries: Vec::new() }
    }

    /// Adds an entry to the row under construction.
    pub(crate) fn push(&mut self, column: usize, value: f64) {
        debug_assert!(column < self.columns, "column {column} of {}", self.columns);
        self.entries.push((u32::try_from(column).unwrap_or(u32::MAX), value));
    }

    /// Makes room for rows and entries to come.
    pub(crate) fn reserve(&mut self, rows: usize, entries: usize) {
        self.ends.reserve(rows);
        self.entries.reserve(entries);
    }

    /// Ends the row under construction; its entries are put in the order of columns.
    pub(crate) fn end_row(&mut self) {
        let start = self.ends.last().copied().unwrap_or(0);
        self.entries[start..].sort_unstable_by_key(|&(column, _)| column);
        self.ends.push(self.entries.len());
    }

    /// Multiplies the row under construction.
    pub(crate) fn scale_open_row(&mut self, factor: f64) {
        let start = self.ends.last().copied().unwrap_or(0);
        for (_, value) in &mut self.entries[start..] {
            *value *= factor;
        }
    }

    /// Number of rows.
    pub fn row_count(&self) -> usize {
        self.ends.len()
    }

    /// Number of columns.
    pub fn column_count(&self) -> usize {
        self.columns
    }

    /// The rows in order.
    pub fn rows(&self) -> impl Iterator<Item = &[(u32, f64)]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| &self.entries[start..end])
    }

    /// A x.
    pub fn apply(&self, x: &[f64]) -> Vec<f64> {
        self.rows().map(|row| dot(row, x)).collect()
    }

    /// Aᵀ y.
    pub fn apply_transposed(&self, y: &[f64]) -> Vec<f64> {
        let mut x = vec![0.0; self.columns];
        for (row, &value) in self.rows().zip(y) {
            if value != 0.0 {
                for &(column, entry) in row {
                    x[column as usize] += entry * value;
                }
            }
        }
        x
    }

    /// The lower triangle of AᵀA; the rest is zero.
    pub fn gram(&self) -> Mat<f64> {
        let mut gram = Mat::<f64>::zeros(self.columns, self.columns);
        for row in self.rows() {
            for (index, &(column, weight)) in row.iter().enumerate() {
                let Some(target) = gram.col_mut(column as usize).try_as_col_major_mut() else {
                    continue;
                };
                let target = target.as_slice_mut();
                // Columns ascend, so the rest of the row lies below the diagonal; a column that
                // repeats meets itself twice.
                target[column as usize] += weight * weight;
                for &(other, value) in &row[index + 1..] {
                    let twice = if other == column { 2.0 } else { 1.0 };
                    target[other as usize] += twice * (weight * value);
                }
            }
        }
        gram
    }

    /// Squared length of every column.
    pub fn column_norms_sq(&self) -> Vec<f64> {
        let mut norms = vec![0.0; self.columns];
        let mut dense = vec![0.0; self.columns];
        for row in self.rows() {
            for &(column, value) in row {
                dense[column as usize] += value;
            }
            for &(column, _) in row {
                let value = std::mem::take(&mut dense[column as usize]);
                norms[column as usize] += value * value;
            }
        }
        norms
    }
}

fn dot(row: &[(u32, f64)], x: &[f64]) -> f64 {
    row.iter().map(|&(column, value)| value * x[column as usize]).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repeated_columns_add_up_in_every_product() {
        let mut rows = SparseRows::new(2);
        rows.push(1, 2.0);
        rows.push(0, 1.0);
        rows.push(1, 3.0);
        rows.end_row();
        assert_eq!(rows.apply(&[1.0, 10.0]), [51.0]);
        assert_eq!(rows.apply_transposed(&[2.0]), [2.0, 10.0]);
        assert_eq!(rows.column_norms_sq(), [1.0, 25.0]);
        let gram = rows.gram();
        let lower = [gram[(0, 0)], gram[(1, 0)], gram[(1, 1)]];
        assert!(
            lower.iter().zip([1.0, 5.0, 25.0]).all(|(a, b)| (a - b).abs() < 1e-15),
            "{lower:?}"
        );
    }
}
