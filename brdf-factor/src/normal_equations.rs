//! The normal equations AᵀWA x = AᵀW y, kept block by block, so that a factor whose coordinates
//! move costs its own blocks only.

use std::sync::Arc;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{Accum, Mat, MatMut, Par};
use rayon::prelude::*;

use crate::columns::Tap;
use crate::{Columns, FactorError};

/// A block of AᵀWA, column by column.
#[derive(Debug)]
struct Block {
    rows: usize,
    values: Vec<f64>,
}

/// AᵀWA of a list of factors, smoothing and ridge included.
#[derive(Clone, Debug)]
pub struct NormalEquations {
    columns: Vec<Arc<Columns>>,
    /// Row i holds the blocks of factor i with every factor up to itself.
    blocks: Vec<Vec<Arc<Block>>>,
}

impl NormalEquations {
    /// Those of no factor.
    pub fn empty() -> Self {
        Self { columns: Vec::new(), blocks: Vec::new() }
    }

    /// Those of these factors, with one weight per sample.
    pub fn new(columns: Vec<Arc<Columns>>, weights: &[f64]) -> Self {
        Self::empty().with(columns, weights)
    }

    /// The factors.
    pub fn columns(&self) -> &[Arc<Columns>] {
        &self.columns
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.columns.iter().map(|columns| columns.unknowns()).sum()
    }

    /// Where the unknowns of each factor begin, and where the last end.
    pub fn starts(&self) -> Vec<usize> {
        let ends = self.columns.iter().scan(0, |end, columns| {
            *end += columns.unknowns();
            Some(*end)
        });
        std::iter::once(0).chain(ends).collect()
    }

    /// These with more factors; the blocks there are stay.
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

    /// The blocks of the first `count` factors alone.
    #[must_use]
    pub fn leading(&self, count: usize) -> Self {
        Self { columns: self.columns[..count].to_vec(), blocks: self.blocks[..count].to_vec() }
    }

    /// The lower triangle of the whole matrix; the rest is zero.
    pub fn assemble(&self) -> Mat<f64> {
        let (starts, unknowns) = (self.starts(), self.unknowns());
        let mut whole = Mat::<f64>::zeros(unknowns, unknowns);
        for (i, row) in self.blocks.iter().enumerate() {
            for (j, block) in row.iter().enumerate() {
                for (column, values) in block.values.chunks_exact(block.rows).enumerate() {
                    let first = if i == j { column } else { 0 };
                    let target = whole.as_mut().col_mut(starts[j] + column);
                    let target = target.subrows_mut(starts[i] + first, block.rows - first);
                    if let Some(target) = target.try_as_col_major_mut() {
                        target.as_slice_mut().copy_from_slice(&values[first..]);
                    }
                }
            }
        }
        whole
    }

    /// The Cholesky factor of the whole matrix.
    ///
    /// # Errors
    ///
    /// [`FactorError::Singular`].
    pub fn factorize(&self) -> Result<CholeskyFactor, FactorError> {
        CholeskyFactor::new(self.assemble())
    }

    /// The Cholesky factor of the whole matrix, given that of equations whose first `count` factors
    /// are the same.
    ///
    /// # Errors
    ///
    /// [`FactorError::Singular`].
    pub fn factorize_after(
        &self,
        known: &CholeskyFactor,
        count: usize,
    ) -> Result<CholeskyFactor, FactorError> {
        CholeskyFactor::continued(known, self.starts()[count], self.assemble())
    }
}

/// The lower Cholesky factor of a positive definite matrix.
#[derive(Clone, Debug)]
pub struct CholeskyFactor(Mat<f64>);

impl CholeskyFactor {
    /// Of the matrix with this lower triangle.
    ///
    /// # Errors
    ///
    /// [`FactorError::Singular`] unless it is positive definite.
    pub fn new(mut lower: Mat<f64>) -> Result<Self, FactorError> {
        // One thread, so that the result does not depend on how many there are.
        let (size, par) = (lower.nrows(), Par::Seq);
        let scratch = llt::factor::cholesky_in_place_scratch::<f64>(size, par, Default::default());
        llt::factor::cholesky_in_place(
            lower.as_mut(),
            Default::default(),
            par,
            MemStack::new(&mut MemBuffer::new(scratch)),
            Default::default(),
        )
        .map_err(|llt::factor::LltError::NonPositivePivot { index }| FactorError::Singular {
            unknowns: size,
            pivot: index,
        })?;
        Ok(Self(lower))
    }

    /// Of the matrix with this lower triangle, whose first `size` rows and columns are those of a
    /// matrix that is factored already: with A = (A₁₁ ·; A₂₁ A₂₂) and A₁₁ = L₁₁L₁₁ᵀ, L₂₁ = A₂₁L₁₁⁻ᵀ and
    /// L₂₂ is the factor of A₂₂ − L₂₁L₂₁ᵀ.
    fn continued(known: &Self, size: usize, mut lower: Mat<f64>) -> Result<Self, FactorError> {
        if size == 0 {
            return Self::new(lower);
        }
        let par = Par::Seq;
        let total = lower.nrows();
        let leading = known.0.as_ref().submatrix(0, 0, size, size);
        let (mut first, _, mut below, mut corner) = lower.as_mut().split_at_mut(size, size);
        first.copy_from(leading);
        solve_lower_triangular_in_place(leading, below.as_mut().transpose_mut(), par);
        triangular::matmul(
            corner.as_mut(),
            BlockStructure::TriangularLower,
            Accum::Add,
            below.as_ref(),
            BlockStructure::Rectangular,
            below.as_ref().transpose(),
            BlockStructure::Rectangular,
            -1.0,
            par,
        );
        let rest = Self::new(corner.to_owned()).map_err(|error| match error {
            FactorError::Singular { pivot, .. } => {
                FactorError::Singular { unknowns: total, pivot: size + pivot }
            }
            other => other,
        })?;
        corner.copy_from(rest.0);
        Ok(Self(lower))
    }

    /// Replaces right-hand sides, one per column, by their solutions.
    pub fn solve_in_place(&self, sides: MatMut<'_, f64>) {
        let par = Par::Seq;
        let scratch = llt::solve::solve_in_place_scratch::<f64>(self.0.nrows(), sides.ncols(), par);
        llt::solve::solve_in_place(
            self.0.as_ref(),
            sides,
            par,
            MemStack::new(&mut MemBuffer::new(scratch)),
        );
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
        let mut half = Self::zeros(size, size);
        for (index, rows) in columns.taps().iter().enumerate() {
            // Half of what is symmetric, and one of each pair that is not: the transpose gives the
            // rest.
            half.add_products(rows, rows, weights, 0.5);
            for other in &columns.taps()[index + 1..] {
                half.add_products(rows, other, weights, 1.0);
            }
        }
        let mut block = half.plus_transpose();
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

    fn plus_transpose(&self) -> Self {
        let size = self.rows;
        let mut sum = Self::zeros(size, size);
        for column in 0..size {
            for row in column..size {
                let value =
                    self.values[column * size + row] + self.values[row * size + column];
                sum.values[column * size + row] = value;
                sum.values[row * size + column] = value;
            }
        }
        sum
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
        let whole = all.factorize().unwrap().0;
        for count in 0..=2 {
            let known = all.leading(count.max(1)).factorize().unwrap();
            let continued = all.factorize_after(&known, count).unwrap().0;
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
        let lower = NormalEquations::new(columns, problem.weights()).assemble();
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
