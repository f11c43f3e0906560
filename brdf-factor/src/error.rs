//! The errors of a factorization.

/// An error of this crate: input that cannot be fitted, or a system that cannot be solved.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FactorError {
    /// No sample is left to fit.
    #[error("no samples are left to fit: {dropped}")]
    NoSamples {
        /// What was dropped and why.
        dropped: String,
    },
    /// A texture cannot have this size.
    #[error("texture size {size}; expected {min} to {max}")]
    TextureSize {
        /// The size given, texels along a side.
        size: usize,
        /// Smallest size allowed.
        min: usize,
        /// Largest size allowed.
        max: usize,
    },
    /// An option is outside its range.
    #[error("{option} is {value}; expected {expected}")]
    Option {
        /// Name of the option.
        option: &'static str,
        /// The value given.
        value: f64,
        /// What is allowed there.
        expected: &'static str,
    },
    /// A list of factors makes no model.
    #[error("{found}; expected {expected}")]
    Factors {
        /// What was found.
        found: String,
        /// What is allowed there.
        expected: &'static str,
    },
    /// Texels are determined neither by a sample nor by smoothing.
    #[error(
        "texel ({u}, {v}) of factor {factor} and {others} more are touched by no sample and \
         smoothing is 0; try a smoothing of 1e-4, more samples or smaller textures"
    )]
    FreeTexel {
        /// Index of the factor, counted from 0.
        factor: usize,
        /// Column of the first such texel.
        u: usize,
        /// Row of the first such texel.
        v: usize,
        /// Number of further such texels.
        others: usize,
    },
    /// The normal equations could not be factored.
    #[error(
        "the system of {unknowns} unknowns is singular at pivot {pivot}; try a larger smoothing"
    )]
    Singular {
        /// Number of unknowns of the system.
        unknowns: usize,
        /// Index of the pivot at which the factorization stopped.
        pivot: usize,
    },
    /// A matrix was inverted for other samples.
    #[error(
        "these {samples} samples do not lie where those of the basis lie, or the factors are others; make a basis for them"
    )]
    OtherSampling {
        /// Number of samples given now.
        samples: usize,
    },
    /// A solver was asked for more than it can hold.
    #[error(
        "{unknowns} unknowns are too many for a dense Cholesky factorization (at most {max}); \
         use the LSMR solver or smaller textures"
    )]
    TooManyUnknowns {
        /// Number of unknowns of the system.
        unknowns: usize,
        /// Largest number of unknowns that is factored densely.
        max: usize,
    },
}
