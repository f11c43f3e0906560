//! Three ways to solve min ‖A x − y‖ for several right-hand sides.

use faer::Mat;
use serde::{Deserialize, Serialize};

use crate::{FactorError, LinearSystem, NormalEquations, lsmr, qmr};

/// A way to solve the least-squares problem.
///
/// The solutions of all three agree to 1e-8 in the values that they give for the samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Solver {
    /// Dense Cholesky factorization of the normal equations: exact and fast up to
    /// [`Solver::MAX_DENSE`] unknowns.
    Cholesky,
    /// LSMR on A itself, matrix-free (Fong and Saunders 2011), for large textures.
    Lsmr,
    /// Quasi-minimal residuals on the normal equations (Freund and Nachtigal 1991), the choice of
    /// McCool, Ang and Ahmad 2001 and of Cole 2002; kept for comparison and for tests.
    Qmr,
}

/// The solutions of a system, one for each right-hand side, and the iterations that they took.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// One vector of unknowns for each right-hand side.
    pub values: Vec<Vec<f64>>,
    /// Number of iterations over all right-hand sides; 0 for a direct solver.
    pub iterations: usize,
    /// Whether an iterative solver reached its tolerance; true for a direct one.
    pub converged: bool,
}

impl Solver {
    /// The largest number of unknowns that is factored densely; beyond it the matrix would pass 512 MiB.
    pub const MAX_DENSE: usize = 8192;

    /// Returns the default solver for a number of unknowns: Cholesky up to [`Solver::MAX_DENSE`], LSMR
    /// beyond.
    pub fn for_unknowns(unknowns: usize) -> Self {
        if unknowns <= Self::MAX_DENSE { Self::Cholesky } else { Self::Lsmr }
    }

    /// Returns the solutions of a system, one for each right-hand side.
    ///
    /// # Errors
    ///
    /// [`FactorError::Singular`] where the normal equations cannot be factored;
    /// [`FactorError::TooManyUnknowns`] for [`Solver::Cholesky`].
    pub fn solve(self, system: &LinearSystem, sides: &[Vec<f64>]) -> Result<Solution, FactorError> {
        match self {
            Self::Cholesky => cholesky(system, sides),
            Self::Lsmr => Ok(iterate(sides, |side| lsmr::solve(system, side))),
            Self::Qmr => Ok(iterate(sides, |side| qmr::solve(system, side))),
        }
    }
}

/// The outcome of an iterative solver for one right-hand side.
pub(crate) struct Iterated {
    pub(crate) values: Vec<f64>,
    pub(crate) iterations: usize,
    pub(crate) converged: bool,
}

fn iterate(sides: &[Vec<f64>], mut solve: impl FnMut(&[f64]) -> Iterated) -> Solution {
    let mut solution = Solution { values: Vec::new(), iterations: 0, converged: true };
    for side in sides {
        let one = solve(side);
        solution.values.push(one.values);
        solution.iterations += one.iterations;
        solution.converged &= one.converged;
    }
    solution
}

fn cholesky(system: &LinearSystem, sides: &[Vec<f64>]) -> Result<Solution, FactorError> {
    let unknowns = system.unknowns();
    if unknowns > Solver::MAX_DENSE {
        return Err(FactorError::TooManyUnknowns { unknowns, max: Solver::MAX_DENSE });
    }
    let equations = NormalEquations::new(system.columns().to_vec(), system.weights());
    let factor = equations.factorize(Vec::new())?;
    let projected: Vec<Vec<f64>> = sides.iter().map(|side| system.apply_transposed(side)).collect();
    let mut x = Mat::from_fn(unknowns, sides.len(), |row, column| projected[column][row]);
    factor.solve_in_place(x.as_mut());
    let values = (0..sides.len()).map(|c| x.col(c).iter().copied().collect()).collect();
    Ok(Solution { values, iterations: 0, converged: true })
}
