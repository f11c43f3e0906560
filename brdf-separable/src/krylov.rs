//! The eigenpairs of largest magnitude of a symmetric matrix, and the largest singular triplets of any
//! matrix, by a block Krylov method with Rayleigh–Ritz projection that stops by residuals.
//!
//! The power iteration that Wang, Tran and Luebke 2004 print stops when the Rayleigh quotient settles.
//! With two eigenvalues of equal size and opposite sign the vector never settles, yet the quotient may. A
//! residual does not have that flaw. A block also finds both vectors of a pair of equal eigenvalues;
//! isotropic materials have many such pairs.

use faer::{Mat, MatRef, Side};
use rand_core::{Rng, SeedableRng};
use rand_xoshiro::SplitMix64;

use crate::SeparableError;
use crate::product::{product, times, transposed_product};

/// The options of the block Krylov method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KrylovParams {
    /// Number of pairs wanted, ≥ 1.
    pub rank: usize,
    /// Largest residual ‖Mv − λv‖ / |λ|.
    pub tolerance: f64,
    /// Relative difference of magnitudes below which pairs are taken together, so that rounding does not
    /// choose among equal vectors. With 0 the result is always cut at the rank.
    pub pair_gap: f64,
    /// Largest number of products with the matrix; after that the best pairs so far are returned.
    pub max_products: usize,
}

impl Default for KrylovParams {
    fn default() -> Self {
        Self { rank: 4, tolerance: 1e-5, pair_gap: 1e-3, max_products: 400 }
    }
}

/// Eigenpairs or singular triplets, by falling magnitude.
#[derive(Clone, Debug)]
pub struct TopPairs {
    /// Eigenvalues with sign, or singular values.
    pub values: Vec<f64>,
    /// Unit vectors of the side of the rows, one in each column. Their entry of largest magnitude is positive.
    pub left: Mat<f64>,
    /// Unit vectors of the side of the columns, one in each column; for a symmetric matrix the same as `left`.
    pub right: Mat<f64>,
    /// Residual ‖Mv − λv‖ / |λ| of each pair.
    pub residuals: Vec<f64>,
    /// Number of pairs beyond the rank that complete a group of equal magnitude.
    pub added: usize,
    /// Whether the group of the last pair goes on beyond the pairs that were looked for.
    pub cuts_a_group: bool,
    /// Whether all residuals are below the tolerance.
    pub converged: bool,
    /// Number of products of the matrix with a column.
    pub products: usize,
}

/// Columns of a block beyond the pairs wanted.
const SPARE: usize = 2;
/// Widest search space, in blocks; the method then restarts from its best vectors.
const MOST_BLOCKS: usize = 24;
/// Most pairs that are added to finish a group.
const MOST_ADDED: usize = 6;
/// Values below this share of the largest are rounding.
const NEGLIGIBLE: f64 = 1e-13;
/// Matrices with a side of at most this are decomposed densely.
const DENSE: usize = 160;
/// Seed of the first block.
const SEED: u64 = 0x6272_6466;

/// Returns the eigenpairs of largest |λ| of a symmetric matrix.
///
/// There are fewer than asked for where the rest of the matrix is zero to rounding.
///
/// ```
/// use brdf_separable::{KrylovParams, top_eigenpairs};
/// use faer::Mat;
///
/// // Eigenvalues 1, −2, 3, … on the diagonal.
/// let value = |i: usize| if i % 2 == 0 { i as f64 + 1.0 } else { -(i as f64) - 1.0 };
/// let matrix = Mat::from_fn(50, 50, |i, j| if i == j { value(i) } else { 0.0 });
/// let pairs = top_eigenpairs(matrix.as_ref(), &KrylovParams { rank: 2, ..Default::default() })?;
/// assert!((pairs.values[0] + 50.0).abs() < 1e-6 && (pairs.values[1] - 49.0).abs() < 1e-6);
/// # Ok::<(), brdf_separable::SeparableError>(())
/// ```
///
/// # Errors
///
/// [`SeparableError::Rank`] unless the rank is 1 to the size; [`SeparableError::Dense`] where a dense
/// decomposition fails.
pub fn top_eigenpairs(
    matrix: MatRef<'_, f64>,
    params: &KrylovParams,
) -> Result<TopPairs, SeparableError> {
    check_rank(matrix, params.rank)?;
    let size = matrix.nrows();
    if size <= DENSE {
        let decomposition = matrix
            .self_adjoint_eigen(Side::Lower)
            .map_err(|_| SeparableError::Dense { what: "eigendecomposition", size })?;
        let values: Vec<f64> = decomposition.S().column_vector().iter().copied().collect();
        let vectors = decomposition.U().to_owned();
        let residual = |value: f64, column: usize| {
            let v = vectors.col(column);
            (matrix * v - v * faer::Scale(value)).norm_l2() / value.abs()
        };
        return Ok(from_dense(&values, &vectors, params, residual));
    }
    // The matrix is symmetric, and its columns are contiguous.
    let mut pairs = krylov(size, params, |x| transposed_product(matrix, x))?;
    pairs.right = pairs.left.clone();
    Ok(pairs)
}

/// Returns the largest singular triplets of a matrix.
///
/// Residuals are ‖Mᵀu − σv‖ / σ; Mv − σu is zero.
///
/// # Errors
///
/// As [`top_eigenpairs`].
pub fn top_singular_triplets(
    matrix: MatRef<'_, f64>,
    params: &KrylovParams,
) -> Result<TopPairs, SeparableError> {
    check_rank(matrix, params.rank)?;
    if matrix.nrows().min(matrix.ncols()) <= DENSE {
        return dense_singular(matrix, params);
    }
    // Squares of singular values that differ by a share differ by twice that.
    let squared = KrylovParams { pair_gap: 2.0 * params.pair_gap, ..*params };
    let operator = |x: MatRef<'_, f64>| transposed_product(matrix, product(matrix, x).as_ref());
    let mut pairs = krylov(matrix.ncols(), &squared, operator)?;
    pairs.products *= 2;
    pairs.right = pairs.left;
    pairs.left = product(matrix, pairs.right.as_ref());
    for (column, value) in pairs.values.iter_mut().enumerate() {
        *value = value.max(0.0).sqrt();
        let scale = if *value > 0.0 { 1.0 / *value } else { 0.0 };
        pairs.left.col_mut(column).iter_mut().for_each(|v| *v *= scale);
    }
    Ok(pairs)
}

fn check_rank(matrix: MatRef<'_, f64>, rank: usize) -> Result<(), SeparableError> {
    let (rows, columns) = (matrix.nrows(), matrix.ncols());
    let max = rows.min(columns);
    if rank == 0 || rank > max {
        return Err(SeparableError::Rank { rank, max, rows, columns });
    }
    Ok(())
}

/// By the eigenvectors of the smaller Gram matrix, after which a second pass over the matrix
/// restores the digits that squaring cost.
fn dense_singular(
    matrix: MatRef<'_, f64>,
    params: &KrylovParams,
) -> Result<TopPairs, SeparableError> {
    if matrix.nrows() > matrix.ncols() {
        let mut pairs = dense_singular(matrix.transpose(), params)?;
        std::mem::swap(&mut pairs.left, &mut pairs.right);
        return Ok(pairs);
    }
    let size = matrix.nrows();
    let failed = |_| SeparableError::Dense { what: "singular value decomposition", size };
    // Wide: M = (QR)ᵀ of the transpose, and the SVD of the small R.
    let qr = matrix.transpose().qr();
    let small = qr.thin_R().thin_svd().map_err(failed)?;
    let values: Vec<f64> = small.S().column_vector().iter().copied().collect();
    let left = small.V().to_owned();
    let mut pairs = from_dense(&values, &left, params, |_, _| 0.0);
    pairs.right = transposed_product(matrix, pairs.left.as_ref());
    for (column, value) in pairs.values.iter().enumerate() {
        pairs.right.col_mut(column).iter_mut().for_each(|v| *v /= value);
        let image = matrix * pairs.right.col(column);
        let off = image - pairs.left.col(column) * faer::Scale(*value);
        pairs.residuals[column] = off.norm_l2() / value;
    }
    Ok(pairs)
}

/// The leading pairs of a whole decomposition.
fn from_dense(
    values: &[f64],
    vectors: &Mat<f64>,
    params: &KrylovParams,
    residual: impl Fn(f64, usize) -> f64,
) -> TopPairs {
    let order = by_magnitude(values);
    let sorted: Vec<f64> = order.iter().map(|&i| values[i]).collect();
    let (count, cuts_a_group) = finished(&sorted, params, sorted.len());
    let mut left = Mat::from_fn(vectors.nrows(), count, |row, k| vectors[(row, order[k])]);
    fix_signs(&mut left);
    TopPairs {
        residuals: (0..count).map(|k| residual(sorted[k], order[k])).collect(),
        values: sorted[..count].to_vec(),
        right: left.clone(),
        left,
        added: count.saturating_sub(params.rank),
        cuts_a_group,
        converged: true,
        products: 0,
    }
}

/// How many of the sorted values to take: the rank, less those that are rounding, more those that
/// finish a group; and whether the group goes on past `known` or past what may be added.
fn finished(sorted: &[f64], params: &KrylovParams, known: usize) -> (usize, bool) {
    let largest = sorted.first().map_or(0.0, |v| v.abs());
    let real = sorted.iter().take_while(|v| v.abs() > NEGLIGIBLE * largest).count();
    let mut count = params.rank.min(real);
    let joins = |count: usize| {
        count > 0 && count < real && {
            let (last, next) = (sorted[count - 1].abs(), sorted[count].abs());
            last - next < params.pair_gap * last
        }
    };
    while joins(count) && count < params.rank + MOST_ADDED && count < known {
        count += 1;
    }
    (count, joins(count))
}

fn by_magnitude(values: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[b].abs().total_cmp(&values[a].abs()));
    order
}

/// A search space V, its image W = M V, and their projection T = Vᵀ W.
struct Space {
    vectors: Mat<f64>,
    images: Mat<f64>,
    projection: Mat<f64>,
}

fn krylov(
    size: usize,
    params: &KrylovParams,
    operator: impl Fn(MatRef<'_, f64>) -> Mat<f64>,
) -> Result<TopPairs, SeparableError> {
    let width = (params.rank + SPARE).min(size);
    let most = (MOST_BLOCKS * width).min(size);
    let mut space = Space {
        vectors: Mat::zeros(size, 0),
        images: Mat::zeros(size, 0),
        projection: Mat::zeros(0, 0),
    };
    let mut block = orthonormal(
        &space.vectors,
        random_block(size, width, &mut SplitMix64::seed_from_u64(SEED)),
    );
    let mut products = 0;
    loop {
        products += block.ncols();
        let image = operator(block.as_ref());
        space.grow(&block, &image);
        let dimension = space.vectors.ncols();
        let ritz = space
            .projection
            .self_adjoint_eigen(Side::Lower)
            .map_err(|_| SeparableError::Dense { what: "eigendecomposition", size: dimension })?;
        let values: Vec<f64> = ritz.S().column_vector().iter().copied().collect();
        let order = by_magnitude(&values);
        let sorted: Vec<f64> = order.iter().map(|&i| values[i]).collect();
        let next = orthonormal(&space.vectors, image);
        let is_invariant = next.ncols() == 0;
        let (count, cuts_a_group) = finished(&sorted, params, dimension);
        let rotation =
            |columns: usize| Mat::from_fn(dimension, columns, |row, k| ritz.U()[(row, order[k])]);
        let chosen = rotation(count);
        let residuals = space.residuals(&chosen, &sorted);
        let converged = is_invariant || residuals.iter().all(|r| *r <= params.tolerance);
        if converged || products >= params.max_products * width {
            let mut left = times(space.vectors.as_ref(), chosen.as_ref());
            fix_signs(&mut left);
            return Ok(TopPairs {
                values: sorted[..count].to_vec(),
                right: Mat::zeros(0, 0),
                left,
                residuals,
                added: count.saturating_sub(params.rank),
                cuts_a_group,
                converged,
                products,
            });
        }
        if dimension + next.ncols() > most {
            space.restart(&rotation(width.max(count)), &sorted);
        }
        block = next;
    }
}

impl Space {
    fn grow(&mut self, block: &Mat<f64>, image: &Mat<f64>) {
        let (old, new) = (self.vectors.ncols(), block.ncols());
        append(&mut self.vectors, block);
        append(&mut self.images, image);
        let border = transposed_product(self.vectors.as_ref(), image.as_ref());
        self.projection.resize_with(old + new, old + new, |_, _| 0.0);
        for column in 0..new {
            for row in 0..old + new {
                self.projection[(row, old + column)] = border[(row, column)];
                self.projection[(old + column, row)] = border[(row, column)];
            }
        }
    }

    /// ‖Mv − λv‖ / |λ| of the vectors V c.
    fn residuals(&self, chosen: &Mat<f64>, values: &[f64]) -> Vec<f64> {
        let vectors = times(self.vectors.as_ref(), chosen.as_ref());
        let images = times(self.images.as_ref(), chosen.as_ref());
        (0..chosen.ncols())
            .map(|k| {
                let off = images.col(k) - vectors.col(k) * faer::Scale(values[k]);
                off.norm_l2() / values[k].abs()
            })
            .collect()
    }

    /// Keeps the best vectors alone.
    fn restart(&mut self, best: &Mat<f64>, values: &[f64]) {
        self.vectors = times(self.vectors.as_ref(), best.as_ref());
        self.images = times(self.images.as_ref(), best.as_ref());
        let keep = best.ncols();
        self.projection =
            Mat::from_fn(keep, keep, |row, column| if row == column { values[row] } else { 0.0 });
    }
}

fn append(matrix: &mut Mat<f64>, columns: &Mat<f64>) {
    let old = matrix.ncols();
    matrix.resize_with(matrix.nrows(), old + columns.ncols(), |row, column| {
        columns[(row, column - old)]
    });
}

/// The block with its components along `basis` taken out, then orthonormal; columns of which nothing
/// but rounding is left are dropped.
fn orthonormal(basis: &Mat<f64>, mut block: Mat<f64>) -> Mat<f64> {
    // Twice is enough (Kahan, Parlett).
    for _ in 0..2 {
        let before: Vec<f64> = (0..block.ncols()).map(|c| block.col(c).norm_l2()).collect();
        if basis.ncols() > 0 {
            let along = transposed_product(basis.as_ref(), block.as_ref());
            block -= product(basis.as_ref(), along.as_ref());
        }
        let mut kept: Vec<usize> = Vec::new();
        for column in 0..block.ncols() {
            for &earlier in &kept {
                let along: f64 = block
                    .col(earlier)
                    .iter()
                    .zip(block.col(column).iter())
                    .map(|(a, b)| a * b)
                    .sum();
                for row in 0..block.nrows() {
                    block[(row, column)] -= along * block[(row, earlier)];
                }
            }
            let norm = block.col(column).norm_l2();
            if norm > 1e-11 * before[column] {
                block.col_mut(column).iter_mut().for_each(|v| *v /= norm);
                kept.push(column);
            }
        }
        if kept.len() < block.ncols() {
            block = Mat::from_fn(block.nrows(), kept.len(), |row, c| block[(row, kept[c])]);
        }
    }
    block
}

/// Numbers from −½ to ½, column by column.
pub(crate) fn random_block(size: usize, width: usize, rng: &mut SplitMix64) -> Mat<f64> {
    let mut block = Mat::zeros(size, width);
    for column in 0..width {
        for value in block.col_mut(column).iter_mut() {
            let unit = (rng.next_u64() >> 11) as f64 / 9_007_199_254_740_992.0;
            *value = unit - 0.5;
        }
    }
    block
}

/// Turns every column so that its entry of largest magnitude, the first of equal ones, is positive.
pub(crate) fn fix_signs(vectors: &mut Mat<f64>) {
    for column in 0..vectors.ncols() {
        let mut largest = 0.0_f64;
        for &value in vectors.col(column).iter() {
            // Symmetric vectors have several entries that differ by rounding alone.
            if value.abs() > largest.abs() * (1.0 + 1e-6) {
                largest = value;
            }
        }
        if largest < 0.0 {
            vectors.col_mut(column).iter_mut().for_each(|v| *v = -*v);
        }
    }
}
