//! Three ways to solve min ‖A x − y‖ for several right-hand sides.

use faer::Mat;

use crate::iterated::Iterated;
use crate::{FactorError, LinearSystem, NormalEquations, Solver, lsmr, qmr};

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
