//! What can go wrong.

use brdf_separable::SeparableError;

/// A problem of this crate: a BRDF or transport that cannot be used, or work that was stopped.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RelightError {
    /// A BRDF that cannot be relit with.
    #[error("BRDF: {found}; expected {expected}")]
    Brdf {
        /// Property of the BRDF that was found.
        found: String,
        /// Expected content.
        expected: &'static str,
    },
    /// Transport of which no components are found.
    #[error("components of transport: {found}; expected finite transport")]
    Components {
        /// Content found.
        found: String,
    },
    /// Stored transport that is not whole.
    #[error("transport: {found}; expected {expected}")]
    Transport {
        /// Content found.
        found: String,
        /// Expected content.
        expected: &'static str,
    },
    /// A number of terms that an object does not have.
    #[error("{asked} terms; expected 1 to {most}")]
    Terms {
        /// Number asked for.
        asked: usize,
        /// Number of terms of the object.
        most: usize,
    },
    /// Coefficients asked of an object that shares components.
    #[error("components of clusters; expected wavelets of each vertex")]
    NotWavelets,
    /// The factorization.
    #[error(transparent)]
    Separable(#[from] SeparableError),
    /// The work was stopped.
    #[error(transparent)]
    Stopped(#[from] brdf_job::Stopped),
}
