//! What a search found.

use brdf_job::StopCause;
use brdf_param::Projection;

/// The best model of a number of terms.
#[derive(Clone, Debug, PartialEq)]
pub struct TermOutcome {
    /// Its projections.
    pub projections: Vec<Projection>,
    /// What the search minimized, at its texture size: see the search.
    pub error: f64,
}

/// The models of a search, and what they cost.
#[derive(Clone, Debug, PartialEq)]
pub struct SearchOutcome {
    /// The best model of one searched projection, of two, and so on; at least one.
    pub terms: Vec<TermOutcome>,
    /// Linear least-squares problems solved.
    pub evaluations: usize,
    /// Why the search ended before its end, if it did; the models are the best found so far.
    pub stopped: Option<StopCause>,
}
