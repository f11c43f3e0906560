//! What can go wrong in a factorization.

/// Errors of this crate.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FactorError {
    /// Nothing to fit.
    #[error("no samples are left to fit: {dropped}")]
    NoSamples {
        /// What was dropped and why.
        dropped: String,
    },
    /// A texture cannot have this size.
    #[error("texture size {size}; expected {min} to {max}")]
    TextureSize {
        /// The size asked for.
        size: usize,
        /// Smallest size.
        min: usize,
        /// Largest size.
        max: usize,
    },
    /// An option outside its range.
    #[error("{option} is {value}; expected {expected}")]
    Option {
        /// Which option.
        option: &'static str,
        /// The value asked for.
        value: f64,
        /// What would do.
        expected: &'static str,
    },
    /// A factor list that makes no model.
    #[error("{found}; expected {expected}")]
    Factors {
        /// What is wrong.
        found: String,
        /// What would do.
        expected: &'static str,
    },
    /// Texels that neither a sample nor smoothing holds.
    #[error(
        "texel ({u}, {v}) of factor {factor} and {others} more are touched by no sample and \
         smoothing is 0; try a smoothing of 1e-4, more samples or smaller textures"
    )]
    FreeTexel {
        /// The factor, counted from 0.
        factor: usize,
        /// Column of the first such texel.
        u: usize,
        /// Row of the first such texel.
        v: usize,
        /// How many more there are.
        others: usize,
    },
    /// The normal equations could not be factored.
    #[error(
        "the system of {unknowns} unknowns is singular at pivot {pivot}; try a larger smoothing"
    )]
    Singular {
        /// Size of the system.
        unknowns: usize,
        /// Where the factorization stopped.
        pivot: usize,
    },
    /// A matrix was inverted for other samples.
    #[error(
        "these {samples} samples do not lie where those of the basis lie, or the factors are others;          make a basis for them"
    )]
    OtherSampling {
        /// How many there are now.
        samples: usize,
    },
    /// A solver was asked for more than it can hold.
    #[error(
        "{unknowns} unknowns are too many for a dense Cholesky factorization (at most {max}); \
         use the LSMR solver or smaller textures"
    )]
    TooManyUnknowns {
        /// Size of the system.
        unknowns: usize,
        /// Largest size that is factored densely.
        max: usize,
    },
}
