//! Vectors of many values by a few coefficients, for searches that would take too long otherwise.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, MatRef, Par, Side};
use rayon::prelude::*;

use crate::nearest::dot;

/// Rows that meet the basis together.
const ROWS: usize = 128;

/// An orthonormal basis of the directions in which vectors differ most.
#[derive(Clone, Debug)]
pub(crate) struct Subspace {
    pub(crate) len: usize,
    pub(crate) dims: usize,
    /// `[dim][len]`.
    pub(crate) basis: Vec<f32>,
}

impl Subspace {
    /// The basis of at most `dims` dimensions that holds most of a sample `[vector][len]`, without
    /// taking out a mean.
    pub(crate) fn of(sample: &[f32], len: usize, dims: usize) -> Self {
        let count = sample.len() / len;
        let dims = dims.min(count).min(len);
        let rows = MatRef::from_row_major_slice(sample, count, len);
        let gram = products(sample, len, rows.transpose());
        let wide = Mat::from_fn(count, count, |i, j| f64::from(gram[i * count + j]));
        let Ok(eigen) = wide.self_adjoint_eigen(Side::Lower) else {
            // Not reached for finite values; the coordinates themselves are a basis too.
            return Self { len, dims, basis: coordinates(len, dims) };
        };
        let (values, vectors) = (eigen.S().column_vector(), eigen.U());
        // Ascending order; directions lost in rounding are left out.
        let floor = values[count - 1] * 1e-9;
        let kept: Vec<usize> = (0..dims).map(|d| count - 1 - d).filter(|&i| values[i] > floor).collect();
        #[expect(clippy::cast_possible_truncation, reason = "the basis is stored in f32")]
        let combine: Vec<f32> = kept
            .iter()
            .flat_map(|&d| {
                (0..count).map(move |i| (vectors[(i, d)] / values[d].sqrt()) as f32)
            })
            .collect();
        Self { len, dims: kept.len(), basis: products(&combine, count, rows) }
    }

    /// Coefficients `[vector][dim]` of vectors `[vector][len]`.
    pub(crate) fn project(&self, vectors: &[f32]) -> Vec<f32> {
        products(vectors, self.len, self.matrix().transpose())
    }

    /// The same of a few vectors, on one thread.
    pub(crate) fn project_block(&self, vectors: &[f32], out: &mut [f32]) {
        let rows = vectors.len() / self.len;
        matmul(
            MatMut::from_row_major_slice_mut(out, rows, self.dims),
            Accum::Replace,
            MatRef::from_row_major_slice(vectors, rows, self.len),
            self.matrix().transpose(),
            1.0,
            Par::Seq,
        );
    }

    /// The vectors of coefficients `[vector][dim]`.
    pub(crate) fn lift(&self, coefficients: &[f32]) -> Vec<f32> {
        products(coefficients, self.dims, self.matrix())
    }

    fn matrix(&self) -> MatRef<'_, f32> {
        MatRef::from_row_major_slice(&self.basis, self.dims, self.len)
    }
}

/// Rows `[row][len]` times a matrix, in parallel.
pub(crate) fn products(rows: &[f32], len: usize, matrix: MatRef<'_, f32>) -> Vec<f32> {
    let columns = matrix.ncols();
    if len == 0 || columns == 0 {
        return Vec::new();
    }
    let mut out = vec![0.0; rows.len() / len * columns];
    out.par_chunks_mut(ROWS * columns).zip(rows.par_chunks(ROWS * len)).for_each(|(out, rows)| {
        let count = rows.len() / len;
        matmul(
            MatMut::from_row_major_slice_mut(out, count, columns),
            Accum::Replace,
            MatRef::from_row_major_slice(rows, count, len),
            matrix,
            1.0,
            Par::Seq,
        );
    });
    out
}

/// Squared length of each vector.
pub(crate) fn energies(vectors: &[f32], len: usize) -> Vec<f32> {
    vectors.par_chunks_exact(len).map(|v| dot(v, v)).collect()
}

fn coordinates(len: usize, dims: usize) -> Vec<f32> {
    let mut basis = vec![0.0; dims * len];
    (0..dims).for_each(|d| basis[d * len + d] = 1.0);
    basis
}
