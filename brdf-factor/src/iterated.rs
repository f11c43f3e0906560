//! What an iterative solver returns.

/// The outcome of an iterative solver for one right-hand side.
pub(crate) struct Iterated {
    pub(crate) values: Vec<f64>,
    pub(crate) iterations: usize,
    pub(crate) converged: bool,
}
