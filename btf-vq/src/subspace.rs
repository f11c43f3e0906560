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
        let combine = leading(&gram, count, dims);
        let kept = combine.len() / count.max(1);
        Self { len, dims: kept, basis: products(&combine, count, rows) }
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

/// Rounds of the subspace iteration: enough for what decides clusters, the last digits of the smallest
/// directions do not matter.
const ROUNDS: usize = 6;
/// Directions beyond those wanted, which speed it up.
const SPARE: usize = 16;

/// Combinations of a sample, `[dim][vector]`, that make orthonormal vectors along its leading
/// directions, from its products with itself.
#[expect(clippy::cast_possible_truncation, reason = "bases are stored in f32")]
fn leading(gram: &[f32], count: usize, dims: usize) -> Vec<f32> {
    let matrix = MatRef::from_row_major_slice(gram, count, count);
    let width = (dims + SPARE).min(count);
    // Every step-th vector of the sample starts a direction.
    let mut block =
        Mat::<f32>::from_fn(count, width, |i, j| f32::from(u8::from(i * width / count == j)));
    for _ in 0..ROUNDS {
        let image = products_of(matrix, &block);
        block = image.qr().compute_thin_Q();
    }
    let image = products_of(matrix, &block);
    let mut small = Mat::<f32>::zeros(width, width);
    let target = small.as_mut();
    matmul(target, Accum::Replace, block.as_ref().transpose(), image.as_ref(), 1.0, Par::Seq);
    let wide = Mat::from_fn(width, width, |i, j| f64::from(small[(i, j)]));
    let Ok(eigen) = wide.self_adjoint_eigen(Side::Lower) else { return Vec::new() };
    let (values, vectors) = (eigen.S().column_vector(), eigen.U());
    // Ascending order; directions lost in rounding are left out.
    let floor = values[width - 1] * 1e-7;
    let kept: Vec<usize> =
        (0..dims).map(|d| width - 1 - d).filter(|&i| values[i] > floor).collect();
    let turn = Mat::<f32>::from_fn(width, kept.len(), |i, d| {
        (vectors[(i, kept[d])] / values[kept[d]].sqrt()) as f32
    });
    let combined = &block * &turn;
    (0..kept.len()).flat_map(|d| (0..count).map(move |i| (i, d))).map(|at| combined[at]).collect()
}

/// A symmetric matrix times columns, in parallel.
fn products_of(matrix: MatRef<'_, f32>, columns: &Mat<f32>) -> Mat<f32> {
    let count = matrix.nrows();
    let parts: Vec<Mat<f32>> = (0..count.div_ceil(ROWS))
        .into_par_iter()
        .map(|part| {
            let first = part * ROWS;
            let rows = matrix.subrows(first, ROWS.min(count - first));
            let mut out = Mat::zeros(rows.nrows(), columns.ncols());
            matmul(out.as_mut(), Accum::Replace, rows, columns.as_ref(), 1.0, Par::Seq);
            out
        })
        .collect();
    Mat::from_fn(count, columns.ncols(), |i, j| parts[i / ROWS][(i % ROWS, j)])
}
