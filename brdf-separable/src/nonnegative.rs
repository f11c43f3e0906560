//! Non-negative factors by hierarchical alternating least squares (HALS), several passes over the
//! terms for each product with the matrix.
//!
//! Sources: A. Cichocki and A.-H. Phan, "Fast Local Algorithms for Large Scale Nonnegative Matrix and
//! Tensor Factorizations", 2009; N. Gillis and F. Glineur, "Accelerated Multiplicative Updates and
//! Hierarchical ALS Algorithms for Nonnegative Matrix Factorization", 2012. The start is that of C.
//! Boutsidis and E. Gallopoulos, "SVD based initialization", 2008, with its zeros raised so that no
//! entry is stuck.

use brdf_job::Job;
use faer::{Mat, MatRef};

use crate::product::{product, times, transposed_product};
use crate::{KrylovParams, SeparableError, top_singular_triplets};

/// The options of the non-negative iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NonnegativeParams {
    /// Number of terms.
    pub rank: usize,
    /// Largest number of sweeps over all terms.
    pub sweeps: usize,
    /// Share by which the squared residual must fall in 20 sweeps; with less the iteration stops.
    pub tolerance: f64,
}

impl Default for NonnegativeParams {
    fn default() -> Self {
        Self { rank: 4, sweeps: 400, tolerance: 3e-3 }
    }
}

/// Passes over the terms of a side for one product with the matrix. Against one pass, six reach a
/// residual in a quarter of the products; more gain nothing.
const PASSES: usize = 6;
/// Sweeps between two looks at the residual.
const CHECK_EVERY: usize = 20;
/// What zeros of the start are lifted to, relative to the mean of the term.
const LIFT: f64 = 0.05;

/// Returns W (rows × rank) and H (columns × rank) with M ≈ W Hᵀ, neither with a negative entry, and the
/// number of sweeps.
///
/// Terms are ordered by falling ‖w‖‖h‖; the two vectors of a term have equal norms.
///
/// ```
/// use brdf_job::Job;
/// use brdf_separable::{NonnegativeParams, nonnegative_factors};
/// use faer::Mat;
///
/// let matrix = Mat::from_fn(6, 5, |i, j| (i + 1) as f64 * (j + 2) as f64);
/// let params = NonnegativeParams { rank: 1, ..NonnegativeParams::default() };
/// let (w, h, _) = nonnegative_factors(matrix.as_ref(), &params, &Job::new())?;
/// assert!((w[(3, 0)] * h[(2, 0)] - 16.0).abs() < 1e-6);
/// # Ok::<(), brdf_separable::SeparableError>(())
/// ```
///
/// # Errors
///
/// [`SeparableError::Negative`] for a matrix with negative entries; [`SeparableError::Rank`] for a rank that
/// it cannot have; [`SeparableError::Stopped`] where the job is stopped.
pub fn nonnegative_factors(
    matrix: MatRef<'_, f64>,
    params: &NonnegativeParams,
    job: &Job<'_>,
) -> Result<(Mat<f64>, Mat<f64>, usize), SeparableError> {
    let (rows, columns) = (matrix.nrows(), matrix.ncols());
    let entries = || (0..columns).flat_map(|c| matrix.col(c).iter());
    let count = entries().filter(|v| **v < 0.0).count();
    if count > 0 {
        return Err(SeparableError::Negative {
            count,
            cells: rows * columns,
            expected: "a linear value map, or a decomposition with signs",
        });
    }
    let energy: f64 = entries().map(|v| v * v).sum();
    let (mut w, mut h) = start(matrix, params.rank)?;
    let mut last = f64::INFINITY;
    let mut sweeps = 0;
    while sweeps < params.sweeps {
        job.check()?;
        let image = transposed_product(matrix, w.as_ref());
        update(&mut h, &image, &times(w.transpose(), w.as_ref()));
        let image = product(matrix, h.as_ref());
        let gram = times(h.transpose(), h.as_ref());
        update(&mut w, &image, &gram);
        sweeps += 1;
        if sweeps % CHECK_EVERY == 0 {
            let residual = squared_residual(energy, &w, &image, &gram);
            if residual > (1.0 - params.tolerance) * last {
                break;
            }
            last = residual;
        }
    }
    balance(&mut w, &mut h);
    Ok((w, h, sweeps))
}

/// Passes over the terms of a side: each column becomes the best non-negative one given the others.
/// `image` is the matrix (or its transpose) times the other side, `gram` that side's.
fn update(side: &mut Mat<f64>, image: &Mat<f64>, gram: &Mat<f64>) {
    let terms = side.ncols();
    let mut others = vec![0.0; side.nrows()];
    for term in (0..PASSES * terms).map(|index| index % terms) {
        let own = gram[(term, term)];
        if own <= 0.0 {
            continue;
        }
        others.fill(0.0);
        for k in (0..terms).filter(|k| *k != term) {
            let weight = gram[(k, term)];
            others.iter_mut().zip(side.col(k).iter()).for_each(|(sum, v)| *sum += weight * v);
        }
        let column = side.col_mut(term).iter_mut();
        for ((value, others), image) in column.zip(&others).zip(image.col(term).iter()) {
            *value = ((image - others) / own).max(0.0);
        }
    }
}

/// ‖M − W Hᵀ‖² = ‖M‖² − 2 ⟨MH, W⟩ + ⟨WᵀW, HᵀH⟩.
fn squared_residual(energy: f64, w: &Mat<f64>, mh: &Mat<f64>, hh: &Mat<f64>) -> f64 {
    let ww = times(w.transpose(), w.as_ref());
    let dot = |a: &Mat<f64>, b: &Mat<f64>| -> f64 {
        (0..a.ncols()).flat_map(|c| a.col(c).iter().zip(b.col(c).iter())).map(|(a, b)| a * b).sum()
    };
    (energy - 2.0 * dot(mh, w) + dot(&ww, hh)).max(0.0)
}

/// The positive or negative parts of singular vectors, whichever pair is larger.
fn start(matrix: MatRef<'_, f64>, rank: usize) -> Result<(Mat<f64>, Mat<f64>), SeparableError> {
    let params = KrylovParams { rank, tolerance: 1e-3, pair_gap: 0.0, ..KrylovParams::default() };
    let pairs = top_singular_triplets(matrix, &params)?;
    let terms = pairs.values.len();
    let mut w = Mat::zeros(matrix.nrows(), terms);
    let mut h = Mat::zeros(matrix.ncols(), terms);
    for term in 0..terms {
        let part = |sign: f64| {
            let of = |vectors: &Mat<f64>| -> Vec<f64> {
                vectors.col(term).iter().map(|v| (sign * v).max(0.0)).collect()
            };
            let (u, v) = (of(&pairs.left), of(&pairs.right));
            let size = norm(&u) * norm(&v);
            (u, v, size)
        };
        let (positive, negative) = (part(1.0), part(-1.0));
        let (u, v, size) = if positive.2 >= negative.2 { positive } else { negative };
        let scale = (pairs.values[term] * size).sqrt();
        let fill = |side: &mut Mat<f64>, values: &[f64]| {
            let length = norm(values).max(f64::MIN_POSITIVE);
            let lift = LIFT * values.iter().sum::<f64>() / values.len() as f64;
            for (row, value) in values.iter().enumerate() {
                side[(row, term)] = scale / length * value.max(lift);
            }
        };
        fill(&mut w, &u);
        fill(&mut h, &v);
    }
    Ok((w, h))
}

fn norm(values: &[f64]) -> f64 {
    values.iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// Gives both sides of a term the same norm, and orders terms by it.
fn balance(w: &mut Mat<f64>, h: &mut Mat<f64>) {
    let norms = |side: &Mat<f64>| -> Vec<f64> {
        (0..side.ncols()).map(|c| side.col(c).norm_l2()).collect()
    };
    let (of_w, of_h) = (norms(w), norms(h));
    let mut order: Vec<usize> = (0..of_w.len()).collect();
    order.sort_by(|&a, &b| (of_w[b] * of_h[b]).total_cmp(&(of_w[a] * of_h[a])));
    let scaled = |side: &Mat<f64>, own: &[f64], other: &[f64]| {
        Mat::from_fn(side.nrows(), order.len(), |row, k| {
            let term = order[k];
            let scale = if own[term] > 0.0 { (other[term] / own[term]).sqrt() } else { 0.0 };
            scale * side[(row, term)]
        })
    };
    (*w, *h) = (scaled(w, &of_w, &of_h), scaled(h, &of_h, &of_w));
}
