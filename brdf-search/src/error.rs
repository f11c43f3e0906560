//! The errors of a search.

use brdf_factor::FactorError;

/// An error of this crate: options that make no search, or a factorization that fails.
///
/// A search that is stopped or does not converge is no error; see [`crate::SearchOutcome`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SearchError {
    /// A factorization failed.
    #[error(transparent)]
    Factor(#[from] FactorError),
    /// An option is outside its range.
    #[error("{option} is {value}; expected {expected}")]
    Option {
        /// Name of the option.
        option: &'static str,
        /// The value given.
        value: String,
        /// What is allowed there.
        expected: &'static str,
    },
    /// A fixed factor cannot be part of a reciprocal model.
    #[error(
        "factor {factor} tells light from viewer, so it cannot stand in a reciprocal model; share \
         its texture with the reciprocal coordinate or search without reciprocity"
    )]
    NotReciprocal {
        /// Index of the fixed factor, counted from 0.
        factor: usize,
    },
    /// There are fewer samples than texels, and no smoothing.
    #[error(
        "{unknowns} texels for {samples} samples, and smoothing is 0; expected more samples, fewer \
         or smaller textures, or a smoothing of 1e-4"
    )]
    Underdetermined {
        /// Number of texels of the largest model.
        unknowns: usize,
        /// Number of samples to fit them to.
        samples: usize,
    },
}
