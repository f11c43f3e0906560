//! Three ways to solve min ‖A x − y‖ for several right-hand sides.

use faer::Mat;

use crate::iterated::Iterated;
use crate::{CholeskyFactor, FactorError, LinearSystem, NormalEquations, Solver, lsmr, qmr};

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

/// A system made ready for as many right-hand sides as there are.
#[derive(Debug)]
pub struct PreparedSystem<'a> {
    system: &'a LinearSystem,
    way: Way,
}

#[derive(Debug)]
enum Way {
    Cholesky(CholeskyFactor),
    Lsmr,
    Qmr,
}

impl Solver {
    /// Returns the system ready to be solved this way.
    ///
    /// # Errors
    ///
    /// [`FactorError::Singular`] where the normal equations cannot be factored;
    /// [`FactorError::TooManyUnknowns`] for [`Solver::Cholesky`].
    pub fn prepare(self, system: &LinearSystem) -> Result<PreparedSystem<'_>, FactorError> {
        let way = match self {
            Self::Cholesky => {
                let unknowns = system.unknowns();
                if unknowns > Self::MAX_DENSE {
                    return Err(FactorError::TooManyUnknowns { unknowns, max: Self::MAX_DENSE });
                }
                let equations = NormalEquations::new(system.columns().to_vec(), system.weights());
                Way::Cholesky(equations.factorize(Vec::new())?)
            }
            Self::Lsmr => Way::Lsmr,
            Self::Qmr => Way::Qmr,
        };
        Ok(PreparedSystem { system, way })
    }

    /// Returns the solutions of a system, one for each right-hand side.
    ///
    /// # Errors
    ///
    /// As [`Solver::prepare`].
    pub fn solve(self, system: &LinearSystem, sides: &[Vec<f64>]) -> Result<Solution, FactorError> {
        Ok(self.prepare(system)?.solve(sides))
    }
}

impl PreparedSystem<'_> {
    /// Returns the solutions, one for each right-hand side.
    pub fn solve(&self, sides: &[Vec<f64>]) -> Solution {
        match &self.way {
            Way::Cholesky(factor) => cholesky(self.system, factor, sides),
            Way::Lsmr => iterate(sides, |side| lsmr::solve(self.system, side)),
            Way::Qmr => iterate(sides, |side| qmr::solve(self.system, side)),
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

fn cholesky(system: &LinearSystem, factor: &CholeskyFactor, sides: &[Vec<f64>]) -> Solution {
    let projected: Vec<Vec<f64>> = sides.iter().map(|side| system.apply_transposed(side)).collect();
    let mut x = Mat::from_fn(system.unknowns(), sides.len(), |row, column| projected[column][row]);
    factor.solve_in_place(x.as_mut());
    let values = (0..sides.len()).map(|c| x.col(c).iter().copied().collect()).collect();
    Solution { values, iterations: 0, converged: true }
}
