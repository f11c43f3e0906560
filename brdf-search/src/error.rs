//! What can go wrong in a search.

use brdf_factor::FactorError;

/// Errors of this crate. Not converging is none of them: see [`crate::SearchOutcome`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SearchError {
    /// A factorization failed.
    #[error(transparent)]
    Factor(#[from] FactorError),
    /// An option outside its range.
    #[error("{option} is {value}; expected {expected}")]
    Option {
        /// Which option.
        option: &'static str,
        /// The value asked for.
        value: String,
        /// What would do.
        expected: &'static str,
    },
    /// A coordinate that cannot stand in a reciprocal model.
    #[error(
        "factor {factor} tells light from viewer, so it cannot stand in a reciprocal model; share \
         its texture with the reciprocal coordinate or search without reciprocity"
    )]
    NotReciprocal {
        /// The fixed factor, counted from 0.
        factor: usize,
    },
    /// Fewer samples than texels, and nothing that smooths.
    #[error(
        "{unknowns} texels for {samples} samples, and smoothing is 0; expected more samples, fewer \
         or smaller textures, or a smoothing of 1e-4"
    )]
    Underdetermined {
        /// Texels of the largest model.
        unknowns: usize,
        /// Samples to fit them to.
        samples: usize,
    },
}
