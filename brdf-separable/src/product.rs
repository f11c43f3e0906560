//! Products of a large matrix with a few columns, in parallel over fixed parts, so that the result
//! does not depend on the number of threads.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par};
use rayon::prelude::*;

/// Rows of the result that are computed together.
const PART: usize = 128;

/// A X.
pub(crate) fn product(a: MatRef<'_, f64>, x: MatRef<'_, f64>) -> Mat<f64> {
    in_parts(a.nrows(), x.ncols(), |start, len| times(a.subrows(start, len), x))
}

/// Aᵀ X.
pub(crate) fn transposed_product(a: MatRef<'_, f64>, x: MatRef<'_, f64>) -> Mat<f64> {
    // The few columns on the left: the other order would repack the large matrix.
    let xt = x.transpose().to_owned();
    in_parts(a.ncols(), x.ncols(), |start, len| {
        times(xt.as_ref(), a.subcols(start, len)).transpose().to_owned()
    })
}

/// A B on one thread.
pub(crate) fn times(a: MatRef<'_, f64>, b: MatRef<'_, f64>) -> Mat<f64> {
    let mut out = Mat::zeros(a.nrows(), b.ncols());
    matmul(&mut out, Accum::Replace, a, b, 1.0, Par::Seq);
    out
}

fn in_parts(
    rows: usize,
    columns: usize,
    part: impl Fn(usize, usize) -> Mat<f64> + Sync,
) -> Mat<f64> {
    let parts: Vec<Mat<f64>> = (0..rows.div_ceil(PART))
        .into_par_iter()
        .map(|index| part(index * PART, PART.min(rows - index * PART)))
        .collect();
    let mut out = Mat::zeros(rows, columns);
    for (index, part) in parts.iter().enumerate() {
        out.as_mut().subrows_mut(index * PART, part.nrows()).copy_from(part);
    }
    out
}
