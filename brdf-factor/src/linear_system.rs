//! The least-squares problem of a set of factors: log f = Σ_j A_j x_j, with smoothing.
//!
//! Source: Cole 2002, section 3.2.

use std::sync::Arc;

use crate::Columns;

/// A least-squares problem min ‖A x − y‖², whose matrix A is never formed.
///
/// The rows of A are those of the samples, each multiplied by the root of its weight, then for every factor
/// the Laplacians of its texels and its ridge.
#[derive(Clone, Debug)]
pub struct LinearSystem {
    columns: Vec<Arc<Columns>>,
    weights: Vec<f64>,
    weight_roots: Vec<f64>,
}

impl LinearSystem {
    /// Returns the system of these factors, with one weight ≥ 0 for each sample.
    pub fn new(columns: Vec<Arc<Columns>>, weights: &[f64]) -> Self {
        let weight_roots = weights.iter().map(|w| w.sqrt()).collect();
        Self { columns, weights: weights.to_vec(), weight_roots }
    }

    /// Returns the columns of each factor.
    pub fn columns(&self) -> &[Arc<Columns>] {
        &self.columns
    }

    /// Returns the weight of each sample.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// Returns the number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.columns.iter().map(|columns| columns.unknowns()).sum()
    }

    /// Returns the number of rows of A.
    pub fn row_count(&self) -> usize {
        self.weights.len() + self.columns.iter().map(|c| c.regularizer_rows()).sum::<usize>()
    }

    /// Returns the right-hand side y for one target of each sample: weighted targets, then zeros for the
    /// rows of smoothing and ridge.
    ///
    /// # Panics
    ///
    /// If there is not one target per sample.
    pub fn right_hand_side(&self, targets: &[f64]) -> Vec<f64> {
        assert_eq!(targets.len(), self.weights.len(), "one target per sample");
        let mut side = self.weighted(targets);
        side.resize(self.row_count(), 0.0);
        side
    }

    /// Returns A x.
    pub fn apply(&self, x: &[f64]) -> Vec<f64> {
        let mut rows = self.weighted(&self.predict(x));
        for (index, columns) in self.columns.iter().enumerate() {
            rows.extend(columns.regularized(self.part(index, x)));
        }
        rows
    }

    /// Returns Aᵀ y.
    pub fn apply_transposed(&self, y: &[f64]) -> Vec<f64> {
        let (samples, mut below) = y.split_at(self.weights.len());
        let weighted = self.weighted(samples);
        let mut x = Vec::with_capacity(self.unknowns());
        for columns in &self.columns {
            let (own, rest) = below.split_at(columns.regularizer_rows());
            below = rest;
            let mut part = vec![0.0; columns.unknowns()];
            columns.add_transposed(&weighted, &mut part);
            columns.add_regularized_transposed(own, &mut part);
            x.extend(part);
        }
        x
    }

    /// Returns the squared length of every column of A.
    pub fn column_norms_sq(&self) -> Vec<f64> {
        self.columns.iter().flat_map(|columns| columns.norms_sq(&self.weights)).collect()
    }

    /// Returns the log value that a solution gives for every sample.
    pub fn predict(&self, x: &[f64]) -> Vec<f64> {
        let mut values = vec![0.0; self.weights.len()];
        for (index, columns) in self.columns.iter().enumerate() {
            columns.add_values(self.part(index, x), &mut values);
        }
        values
    }

    /// Returns the part of a solution that belongs to a factor.
    ///
    /// # Panics
    ///
    /// If there is no such factor, or `x` has not one entry per unknown.
    pub fn part<'a>(&self, factor: usize, x: &'a [f64]) -> &'a [f64] {
        let start: usize = self.columns[..factor].iter().map(|columns| columns.unknowns()).sum();
        &x[start..][..self.columns[factor].unknowns()]
    }

    fn weighted(&self, values: &[f64]) -> Vec<f64> {
        values.iter().zip(&self.weight_roots).map(|(value, root)| value * root).collect()
    }
}
