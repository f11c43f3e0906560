//! What can go wrong in a fit or a comparison.

use brdf_factor::FactorError;
use brdf_job::Stopped;
use brdf_model::ModelError;
use brdf_search::SearchError;
use brdf_separable::SeparableError;
use brdf_spline::SplineError;

/// Errors of this crate.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// A factorization failed.
    #[error(transparent)]
    Factor(#[from] FactorError),
    /// A search failed.
    #[error(transparent)]
    Search(#[from] SearchError),
    /// A sum of products failed.
    #[error(transparent)]
    Separable(#[from] SeparableError),
    /// A fit of splines failed.
    #[error(transparent)]
    Spline(#[from] SplineError),
    /// What was fitted makes no model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// Settings that contradict each other.
    #[error("{setting} is {value}; expected {expected}")]
    Setting {
        /// Which one.
        setting: &'static str,
        /// What it is.
        value: &'static str,
        /// What would do.
        expected: &'static str,
    },
    /// There is nothing to compare on.
    #[error("{name}: no usable samples: {dropped}")]
    NothingToCompare {
        /// The reference.
        name: String,
        /// What was dropped and why.
        dropped: String,
    },
    /// The work was stopped before it had a model.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}
