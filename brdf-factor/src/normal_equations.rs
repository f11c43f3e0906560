//! The normal equations AᵀWA x = AᵀW y, kept block by block, so that only the blocks of a factor whose
//! coordinates move are computed anew.

use std::sync::Arc;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{Accum, MatMut, MatRef, Par};
use rayon::prelude::*;

use crate::columns::Tap;
use crate::{Columns, FactorError};

/// A block of AᵀWA, column by column.
#[derive(Debug)]
struct Block {
    rows: usize,
    values: Vec<f64>,
}

/// The matrix AᵀWA of a list of factors, with smoothing and ridge.
#[derive(Clone, Debug)]
pub struct NormalEquations {
    columns: Vec<Arc<Columns>>,
    /// Row i holds the blocks of factor i with every factor up to itself.
    blocks: Vec<Vec<Arc<Block>>>,
}

impl NormalEquations {
    /// Returns the equations of no factor.
    pub fn empty() -> Self {
        Self { columns: Vec::new(), blocks: Vec::new() }
    }

    /// Returns the equations of these factors, with one weight for each sample.
    pub fn new(columns: Vec<Arc<Columns>>, weights: &[f64]) -> Self {
        Self::empty().with(columns, weights)
    }

    /// Returns the columns of each factor.
    pub fn columns(&self) -> &[Arc<Columns>] {
        &self.columns
    }

    /// Returns the number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.columns.iter().map(|columns| columns.unknowns()).sum()
    }

    /// Returns the index of the first unknown of each factor, and the number of all unknowns at the end.
    pub fn starts(&self) -> Vec<usize> {
        let ends = self.columns.iter().scan(0, |end, columns| {
            *end += columns.unknowns();
            Some(*end)
        });
        std::iter::once(0).chain(ends).collect()
    }

    /// Returns the equations with more factors; blocks that exist are kept.
    #[must_use]
    pub fn with(mut self, more: Vec<Arc<Columns>>, weights: &[f64]) -> Self {
        let old = self.columns.len();
        self.columns.extend(more);
        let all = &self.columns;
        let rows: Vec<Vec<Arc<Block>>> = (old..all.len())
            .into_par_iter()
            .map(|i| {
                let block = |j: usize| match j {
                    _ if i == j => Block::own(&all[i], weights),
                    _ => Block::cross(&all[i], &all[j], weights),
                };
                (0..=i).into_par_iter().map(|j| Arc::new(block(j))).collect()
            })
            .collect();
        self.blocks.extend(rows);
        self
    }

    /// Returns the equations of the first `count` factors alone.
    #[must_use]
    pub fn leading(&self, count: usize) -> Self {
        Self { columns: self.columns[..count].to_vec(), blocks: self.blocks[..count].to_vec() }
    }

    /// The lower triangle of the whole matrix, column by column.
    pub(crate) fn lower(&self) -> Vec<f64> {
        self.assemble(0, Vec::new())
    }

    /// Returns the Cholesky factor of the whole matrix.
    ///
    /// The memory of `buffer` is used for it; what it holds does not matter.
    ///
    /// # Errors
    ///
    /// [`FactorError::Singular`] unless the matrix is positive definite.
    pub fn factorize(&self, buffer: Vec<f64>) -> Result<CholeskyFactor, FactorError> {
        CholeskyFactor::of_trailing(self.assemble(0, buffer), self.unknowns(), 0)
    }

    /// Returns the Cholesky factor of the whole matrix, given that of equations whose first `count` factors
    /// are the same.
    ///
    /// With A = (A₁₁ ·; A₂₁ A₂₂) and A₁₁ = L₁₁L₁₁ᵀ, L₂₁ = A₂₁L₁₁⁻ᵀ and L₂₂ is the factor of A₂₂ − L₂₁L₂₁ᵀ.
    /// The memory of `buffer` is used; what it holds does not matter.
    ///
    /// # Errors
    ///
    /// [`FactorError::Singular`] unless the matrix is positive definite.
    pub fn factorize_after(
        &self,
        known: &CholeskyFactor,
        count: usize,
        buffer: Vec<f64>,
    ) -> Result<CholeskyFactor, FactorError> {
        let (size, done) = (self.unknowns(), self.starts()[count]);
        let mut lower = self.assemble(count, buffer);
        if done > 0 {
            let whole = MatMut::from_column_major_slice_mut(&mut lower, size, size);
            let (mut first, _, mut below, corner) = whole.split_at_mut(done, done);
            let leading = known.lower().submatrix(0, 0, done, done);
            first.copy_from_triangular_lower(leading);
            solve_lower_triangular_in_place(leading, below.as_mut().transpose_mut(), Par::Seq);
            triangular::matmul(
                corner,
                BlockStructure::TriangularLower,
                Accum::Add,
                below.as_ref(),
                BlockStructure::Rectangular,
                below.as_ref().transpose(),
                BlockStructure::Rectangular,
                -1.0,
                Par::Seq,
            );
        }
        CholeskyFactor::of_trailing(lower, size, done)
    }

    /// The lower triangle of the whole matrix, column by column, less the rows and columns of the
    /// first `skipped` factors among themselves; everything else is left as it was.
    fn assemble(&self, skipped: usize, mut buffer: Vec<f64>) -> Vec<f64> {
        let (starts, size) = (self.starts(), self.unknowns());
        buffer.resize(size * size, 0.0);
        for (i, row) in self.blocks.iter().enumerate().skip(skipped) {
            for (j, block) in row.iter().enumerate() {
                for (column, values) in block.values.chunks_exact(block.rows).enumerate() {
                    let first = if i == j { column } else { 0 };
                    let start = (starts[j] + column) * size + starts[i];
                    buffer[start + first..start + block.rows].copy_from_slice(&values[first..]);
                }
            }
        }
        buffer
    }
}

/// The lower Cholesky factor of a positive definite matrix, stored column by column; the numbers above
/// the diagonal have no meaning.
///
/// ```
/// use brdf_factor::CholeskyFactor;
///
/// // The matrix (4 2; 2 5) is the product of (2 0; 1 2) and its transpose.
/// let factor = CholeskyFactor::new(vec![4.0, 2.0, 0.0, 5.0], 2)?;
/// let values = factor.values();
/// assert!((values[0] - 2.0).abs() < 1e-12 && (values[1] - 1.0).abs() < 1e-12);
/// assert!((values[3] - 2.0).abs() < 1e-12);
/// # Ok::<(), brdf_factor::FactorError>(())
/// ```
#[derive(Clone, Debug)]
pub struct CholeskyFactor {
    size: usize,
    values: Vec<f64>,
}

impl CholeskyFactor {
    /// Returns the factor of the matrix of `size` columns with this lower triangle, given column by column.
    ///
    /// # Errors
    ///
    /// [`FactorError::Singular`] unless it is positive definite.
    pub fn new(lower: Vec<f64>, size: usize) -> Result<Self, FactorError> {
        Self::of_trailing(lower, size, 0)
    }

    /// Returns the memory of the factor, to be used again.
    pub fn into_buffer(self) -> Vec<f64> {
        self.values
    }

    /// Factors what lies beyond the first `done` rows and columns, which are final already.
    fn of_trailing(mut values: Vec<f64>, size: usize, done: usize) -> Result<Self, FactorError> {
        // One thread, so that the result does not depend on how many there are.
        let (rest, par) = (size - done, Par::Seq);
        let scratch = llt::factor::cholesky_in_place_scratch::<f64>(rest, par, Default::default());
        llt::factor::cholesky_in_place(
            MatMut::from_column_major_slice_mut(&mut values, size, size)
                .submatrix_mut(done, done, rest, rest),
            Default::default(),
            par,
            MemStack::new(&mut MemBuffer::new(scratch)),
            Default::default(),
        )
        .map_err(|llt::factor::LltError::NonPositivePivot { index }| {
            FactorError::Singular { unknowns: size, pivot: done + index }
        })?;
        Ok(Self { size, values })
    }

    fn lower(&self) -> MatRef<'_, f64> {
        MatRef::from_column_major_slice(&self.values, self.size, self.size)
    }

    /// Replaces right-hand sides, one in each column, by their solutions.
    pub fn solve_in_place(&self, sides: MatMut<'_, f64>) {
        let mut scratch = self.scratch(sides.ncols());
        self.solve_with(sides, &mut scratch);
    }

    /// Replaces one right-hand side by its solution.
    ///
    /// # Panics
    ///
    /// If the side is not as long as the matrix is wide.
    pub fn solve(&self, side: &mut [f64]) {
        self.solve_in_place(MatMut::from_column_major_slice_mut(side, self.size, 1));
    }

    /// Memory for [`CholeskyFactor::solve_with`] and this many right-hand sides.
    pub(crate) fn scratch(&self, sides: usize) -> MemBuffer {
        MemBuffer::new(llt::solve::solve_in_place_scratch::<f64>(self.size, sides, Par::Seq))
    }

    /// [`CholeskyFactor::solve_in_place`] without allocating.
    pub(crate) fn solve_with(&self, sides: MatMut<'_, f64>, scratch: &mut MemBuffer) {
        llt::solve::solve_in_place(self.lower(), sides, Par::Seq, MemStack::new(scratch));
    }

    /// Returns the factor, column by column; the numbers above the diagonal have no meaning.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Returns the factor of these columns, which [`CholeskyFactor::values`] returned before, or `None` unless
    /// all are finite and the diagonal is above 0.
    pub fn from_values(values: Vec<f64>) -> Option<Self> {
        let size = values.len().isqrt();
        let diagonal = (0..size).map(|at| values[at * size + at]);
        (size * size == values.len()
            && diagonal.into_iter().all(|v| v > 0.0)
            && values.iter().all(|v| v.is_finite()))
        .then_some(Self { size, values })
    }
}

impl Block {
    fn zeros(rows: usize, columns: usize) -> Self {
        Self { rows, values: vec![0.0; rows * columns] }
    }

    /// The products of one factor's columns (rows of the block) with another's.
    fn cross(below: &Columns, left: &Columns, weights: &[f64]) -> Self {
        let mut block = Self::zeros(below.unknowns(), left.unknowns());
        for rows in below.taps() {
            for columns in left.taps() {
                block.add_products(rows, columns, weights, 1.0);
            }
        }
        block
    }

    /// The products of a factor's columns with each other, and what smooths them.
    fn own(columns: &Columns, weights: &[f64]) -> Self {
        let size = columns.unknowns();
        let mut block = Self::zeros(size, size);
        for (index, rows) in columns.taps().iter().enumerate() {
            // Half of what is symmetric, and one of each pair that is not: the transpose gives the
            // rest.
            block.add_products(rows, rows, weights, 0.5);
            for other in &columns.taps()[index + 1..] {
                block.add_products(rows, other, weights, 1.0);
            }
        }
        block.add_own_transpose();
        columns.for_each_regularizer(|row, column, value| {
            block.values[column * size + row] += value;
        });
        block
    }

    /// Adds factor · weight · (row weight) · (column weight) over all samples and their texels.
    fn add_products(&mut self, rows: &[Tap], columns: &[Tap], weights: &[f64], factor: f64) {
        // The widest vectors of the machine that runs this, chosen at run time.
        pulp::Arch::new().dispatch(AddProducts { block: self, rows, columns, weights, factor });
    }

    fn add_own_transpose(&mut self) {
        let size = self.rows;
        for column in 0..size {
            for row in column..size {
                let (lower, upper) = (column * size + row, row * size + column);
                let value = self.values[lower] + self.values[upper];
                self.values[lower] = value;
                self.values[upper] = value;
            }
        }
    }
}

/// [`Block::add_products`], compiled once for each instruction set.
struct AddProducts<'a> {
    block: &'a mut Block,
    rows: &'a [Tap],
    columns: &'a [Tap],
    weights: &'a [f64],
    factor: f64,
}

impl pulp::NullaryFnOnce for AddProducts<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { block, rows, columns, weights, factor } = self;
        let stride = block.rows;
        for ((row, column), &weight) in rows.iter().zip(columns).zip(weights) {
            let scale = factor * weight;
            let [low, high] = row.pairs();
            let [low_weights, high_weights] = row.weights().map(|pair| pair.map(|w| scale * w));
            for (first, pair) in column.pairs().into_iter().zip(column.weights()) {
                let two = &mut block.values[first * stride..(first + 2) * stride];
                let (near, far) = two.split_at_mut(stride);
                for (target, weight) in [(near, pair[0]), (far, pair[1])] {
                    add_pair(target, low, low_weights, weight);
                    add_pair(target, high, high_weights, weight);
                }
            }
        }
    }
}

#[inline(always)]
fn add_pair(target: &mut [f64], first: usize, values: [f64; 2], weight: f64) {
    if let Some([a, b]) = target.get_mut(first..first + 2) {
        *a += weight * values[0];
        *b += weight * values[1];
    }
}

#[cfg(test)]
mod tests {
    use brdf_model::{Channels, PairSampling, Preset, SampleSet};
    use brdf_param::{Projection, Space};

    use super::*;
    use crate::{FactorParams, FactorSpec, LinearSystem, Problem};

    #[test]
    fn continuing_a_factor_gives_the_whole_one() {
        let plane = |x: f64| Projection::from_rows([x, 0.2, 0.1, 1.0], [0.0, 1.0, x, 0.3]).unwrap();
        let planes = [plane(0.3), plane(0.7), plane(-0.5)];
        let problem = problem(300);
        let columns: Vec<Arc<Columns>> = FactorSpec::projections(Space::Standard, &planes, true)
            .iter()
            .map(|spec| Arc::new(problem.columns(&problem.empty_factor(spec, 6).unwrap())))
            .collect();
        let all = NormalEquations::new(columns, problem.weights());
        let whole = all.factorize(Vec::new()).unwrap();
        let whole = whole.lower();
        for count in 0..=2 {
            let known = all.leading(count.max(1)).factorize(vec![7.0; 10]).unwrap();
            let continued = all.factorize_after(&known, count, vec![f64::NAN; 9]).unwrap();
            let continued = continued.lower();
            for column in 0..whole.ncols() {
                for row in column..whole.nrows() {
                    let (a, b) = (whole[(row, column)], continued[(row, column)]);
                    assert!((a - b).abs() < 1e-9, "{count}: ({row}, {column}): {a}, {b}");
                }
            }
        }
    }

    fn problem(count: u32) -> Problem {
        let sampling = PairSampling { count, seed: 1, theta_max: 1.3 };
        let samples = SampleSet::draw(&Preset::ALL[0].brdf(), &sampling, Channels::Luminance);
        let params = FactorParams { weight: crate::Weight::F, ..FactorParams::default() };
        Problem::new(&samples, &params).unwrap()
    }

    /// The oracle multiplies A with every unit vector.
    #[test]
    fn blocks_are_the_products_of_the_matrix_with_itself() {
        let problem = problem(300);
        let plane = Projection::from_rows([0.3, -0.8, 0.1, 0.4], [0.9, 0.2, -0.5, 0.1]).unwrap();
        let mut specs = FactorSpec::radial(true);
        specs.extend(FactorSpec::mccool(true));
        specs.extend(FactorSpec::projections(Space::HalfDifference, &[plane], true));
        let columns: Vec<Arc<Columns>> = specs
            .iter()
            .map(|spec| Arc::new(problem.columns(&problem.empty_factor(spec, 5).unwrap())))
            .collect();
        let system = LinearSystem::new(columns.clone(), problem.weights());
        let lower = NormalEquations::new(columns, problem.weights()).assemble(0, Vec::new());
        let lower = MatRef::from_column_major_slice(&lower, system.unknowns(), system.unknowns());
        for unknown in 0..system.unknowns() {
            let mut unit = vec![0.0; system.unknowns()];
            unit[unknown] = 1.0;
            let image = system.apply_transposed(&system.apply(&unit));
            for row in unknown..system.unknowns() {
                let (block, direct) = (lower[(row, unknown)], image[row]);
                assert!((block - direct).abs() < 1e-9, "({row}, {unknown}): {block}, {direct}");
            }
            let norm = system.column_norms_sq()[unknown];
            assert!((norm - image[unknown]).abs() < 1e-9, "{unknown}: {norm}");
        }
    }
}
