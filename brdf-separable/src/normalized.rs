//! One term without iteration: the normalized decomposition.
//!
//! Source: Kautz and McCool 1999, section 3.2: g is the norm of each row, h the mean of the rows
//! divided by it.

use faer::MatRef;

/// g over rows and h over columns with M ≈ g hᵀ, by Euclidean norms.
pub(crate) fn normalized_factors(matrix: MatRef<'_, f64>) -> (Vec<f64>, Vec<f64>) {
    let rows: Vec<f64> = (0..matrix.nrows()).map(|row| matrix.row(row).norm_l2()).collect();
    let lit = rows.iter().filter(|norm| **norm > 0.0).count();
    let share = 1.0 / lit.max(1) as f64;
    let columns = (0..matrix.ncols())
        .map(|column| {
            let sum: f64 = matrix
                .col(column)
                .iter()
                .zip(&rows)
                .filter(|(_, norm)| **norm > 0.0)
                .map(|(value, norm)| value / norm)
                .sum();
            share * sum
        })
        .collect();
    (rows, columns)
}
