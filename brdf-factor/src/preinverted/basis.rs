//! The constraint matrix, given by its singular vectors.

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par, Side};
use serde::{Deserialize, Serialize};

use crate::{FactorError, NormalEquations};

/// A way to damp small singular values s_i, of K in all: the number that takes the place of 1 / s_i.
///
/// Source: Jaroszkiewicz and McCool 2003, section 3.2.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Damping {
    /// No damping: 1 / s_i.
    Truncated,
    /// Linear damping: (1 − i / K) / s_i (Eq. 8).
    Linear,
    /// Damping by α: s_i / (s_i² + α²), with α a share of the largest singular value (Eq. 7).
    Alpha(f64),
}

/// Singular values below this share of the largest are left out.
const LEAST: f64 = 1e-7;

/// The right singular vectors v_i of the constraint matrix B, with a weight for each.
///
/// The paper keeps the left vectors too, to multiply the samples with. Since u_i = B v_i / s_i, the
/// sparse Bᵀ and v_i do the same with as many numbers as there are texels instead of samples.
#[derive(Clone, Debug, PartialEq)]
pub struct SpectralBasis {
    unknowns: usize,
    /// `[component][unknown]`, of unit length.
    vectors: Vec<f64>,
    /// Of v_iᵀBᵀy, for each component.
    weights: Vec<f64>,
}

impl SpectralBasis {
    /// Returns the basis of these parts, or `None` unless they fit together.
    pub fn from_parts(unknowns: usize, vectors: Vec<f64>, weights: Vec<f64>) -> Option<Self> {
        let fits = unknowns > 0
            && !weights.is_empty()
            && unknowns.checked_mul(weights.len()) == Some(vectors.len())
            && vectors.iter().chain(&weights).all(|v| v.is_finite());
        fits.then_some(Self { unknowns, vectors, weights })
    }

    /// By the eigenvectors of BᵀB, which are the singular vectors of B.
    pub(super) fn new(
        equations: &NormalEquations,
        components: usize,
        damping: Damping,
    ) -> Result<Self, FactorError> {
        let unknowns = equations.unknowns();
        let lower = equations.lower();
        let matrix = MatRef::from_column_major_slice(&lower, unknowns, unknowns);
        let eigen = matrix
            .self_adjoint_eigen(Side::Lower)
            .map_err(|_| FactorError::Singular { unknowns, pivot: 0 })?;
        // Ascending, and as squares of singular values.
        let squares: Vec<f64> = (0..unknowns).rev().map(|at| eigen.S()[at]).collect();
        let largest = squares.first().copied().unwrap_or(0.0);
        let kept = squares.iter().take_while(|s| **s > LEAST * LEAST * largest).count();
        let kept = kept.min(components.max(1));
        let vectors = (0..kept)
            .flat_map(|at| {
                let column = eigen.U().col(unknowns - 1 - at);
                (0..unknowns).map(move |row| column[row])
            })
            .collect();
        let weights = squares[..kept]
            .iter()
            .enumerate()
            .map(|(at, square)| match damping {
                Damping::Truncated => square.recip(),
                Damping::Linear => (1.0 - at as f64 / kept as f64) / square,
                Damping::Alpha(alpha) => (square + alpha * alpha * largest).recip(),
            })
            .collect();
        Ok(Self { unknowns, vectors, weights })
    }

    /// Returns the number of texels.
    pub fn unknowns(&self) -> usize {
        self.unknowns
    }

    /// Returns the number of vectors.
    pub fn components(&self) -> usize {
        self.weights.len()
    }

    /// Returns the vectors, `[component][unknown]`.
    pub fn vectors(&self) -> &[f64] {
        &self.vectors
    }

    /// Returns the weights: v_iᵀBᵀy times weight i is the coefficient β_i.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// β, `[channel][component]`, of Bᵀy, `[channel][unknown]`.
    pub(super) fn coefficients(&self, products: &[f64], out: &mut [f64]) {
        let (unknowns, count) = (self.unknowns, self.components());
        let channels = products.len() / unknowns;
        matmul(
            MatMut::from_column_major_slice_mut(out, count, channels),
            Accum::Replace,
            self.matrix(),
            MatRef::from_column_major_slice(products, unknowns, channels),
            1.0,
            Par::Seq,
        );
        for channel in out.chunks_exact_mut(count) {
            channel.iter_mut().zip(&self.weights).for_each(|(beta, weight)| *beta *= weight);
        }
    }

    /// Writes the texels, `[channel][unknown]`, of coefficients β, `[channel][component]`, to `out`.
    pub fn expand(&self, coefficients: &[f64], out: &mut [f64]) {
        let (unknowns, count) = (self.unknowns, self.components());
        let channels = coefficients.len() / count;
        matmul(
            MatMut::from_column_major_slice_mut(out, unknowns, channels),
            Accum::Replace,
            self.matrix().transpose(),
            MatRef::from_column_major_slice(coefficients, count, channels),
            1.0,
            Par::Seq,
        );
    }

    fn matrix(&self) -> MatRef<'_, f64> {
        MatRef::from_row_major_slice(&self.vectors, self.components(), self.unknowns)
    }
}
