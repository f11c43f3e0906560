//! The outcome of a search.

use brdf_job::StopCause;
use brdf_param::Projection;

/// The best model of a given number of terms.
#[derive(Clone, Debug, PartialEq)]
pub struct TermOutcome {
    /// Projections of the model, one for each term.
    pub projections: Vec<Projection>,
    /// Error that the search minimized, at the texture size of the search; see
    /// [`search_joint`](crate::search_joint) and [`search_greedy`](crate::search_greedy).
    pub error: f64,
}

/// The models that a search found, and the work that it took.
#[derive(Clone, Debug, PartialEq)]
pub struct SearchOutcome {
    /// The best model of one searched projection, of two, and so on; at least one.
    pub terms: Vec<TermOutcome>,
    /// Number of linear least-squares problems that were solved.
    pub evaluations: usize,
    /// Cause for which the search was stopped, if it was; the models are then the best found so far.
    pub stopped: Option<StopCause>,
}
