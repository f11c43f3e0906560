//! faer's LSMR applied matrix-free, with columns scaled to unit length.

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::matrix_free::lsmr::{LsmrParams, lsmr, lsmr_scratch};
use faer::matrix_free::{BiLinOp, IdentityPrecond, InitialGuessStatus, LinOp};
use faer::{Mat, MatMut, MatRef, Par};

use crate::LinearSystem;
use crate::iterated::Iterated;

/// Stop where the least-squares gradient has fallen to this share of its start.
const TOLERANCE: f64 = 1e-14;

pub(crate) fn solve(matrix: &LinearSystem, side: &[f64]) -> Iterated {
    let scale = matrix.column_norms_sq().iter().map(|n| 1.0 / n.sqrt()).collect();
    let operator = Scaled { matrix, scale };
    let (rows, columns) = (matrix.row_count(), matrix.unknowns());
    let identity = IdentityPrecond { dim: columns };
    let rhs = Mat::from_fn(rows, 1, |row, _| side[row]);
    let mut out = Mat::zeros(columns, 1);
    // In exact arithmetic `columns` steps suffice; rounding asks for a multiple.
    let limit = 60 * columns + 1000;
    let params = LsmrParams {
        initial_guess: InitialGuessStatus::Zero,
        abs_tolerance: 0.0,
        rel_tolerance: TOLERANCE,
        max_iters: limit,
        ..LsmrParams::default()
    };
    // faer 0.24.4 asks for less than it uses and panics; two more columns a side cover it.
    let scratch = StackReq::all_of(&[
        lsmr_scratch(identity, &operator, 1, Par::Seq),
        StackReq::new::<f64>(4 * (rows + columns) + 1024),
    ]);
    let outcome = lsmr(
        out.as_mut(),
        identity,
        &operator,
        rhs.as_ref(),
        params,
        |_| {},
        Par::Seq,
        MemStack::new(&mut MemBuffer::new(scratch)),
    );
    let values = out.col(0).iter().zip(&operator.scale).map(|(x, s)| x * s).collect();
    let (iterations, converged) = match outcome {
        Ok(info) => (info.iter_count, true),
        Err(_) => (limit, false),
    };
    Iterated { values, iterations, converged }
}

/// A · diag(scale).
#[derive(Debug)]
struct Scaled<'a> {
    matrix: &'a LinearSystem,
    scale: Vec<f64>,
}

impl LinOp<f64> for Scaled<'_> {
    fn apply_scratch(&self, _columns: usize, _par: Par) -> StackReq {
        StackReq::EMPTY
    }

    fn nrows(&self) -> usize {
        self.matrix.row_count()
    }

    fn ncols(&self) -> usize {
        self.matrix.unknowns()
    }

    fn apply(
        &self,
        mut out: MatMut<'_, f64>,
        rhs: MatRef<'_, f64>,
        _par: Par,
        _stack: &mut MemStack,
    ) {
        for column in 0..rhs.ncols() {
            let x: Vec<f64> = rhs.col(column).iter().zip(&self.scale).map(|(x, s)| x * s).collect();
            for (out, value) in out.as_mut().col_mut(column).iter_mut().zip(self.matrix.apply(&x)) {
                *out = value;
            }
        }
    }

    fn conj_apply(
        &self,
        out: MatMut<'_, f64>,
        rhs: MatRef<'_, f64>,
        par: Par,
        stack: &mut MemStack,
    ) {
        self.apply(out, rhs, par, stack);
    }
}

impl BiLinOp<f64> for Scaled<'_> {
    fn transpose_apply_scratch(&self, _columns: usize, _par: Par) -> StackReq {
        StackReq::EMPTY
    }

    fn transpose_apply(
        &self,
        mut out: MatMut<'_, f64>,
        rhs: MatRef<'_, f64>,
        _par: Par,
        _stack: &mut MemStack,
    ) {
        for column in 0..rhs.ncols() {
            let y: Vec<f64> = rhs.col(column).iter().copied().collect();
            let x = self.matrix.apply_transposed(&y);
            let scaled = x.iter().zip(&self.scale).map(|(x, s)| x * s);
            for (out, value) in out.as_mut().col_mut(column).iter_mut().zip(scaled) {
                *out = value;
            }
        }
    }

    fn adjoint_apply(
        &self,
        out: MatMut<'_, f64>,
        rhs: MatRef<'_, f64>,
        par: Par,
        stack: &mut MemStack,
    ) {
        self.transpose_apply(out, rhs, par, stack);
    }
}
