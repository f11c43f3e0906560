//! What can be wrong with a projection or a parametrization.

/// Errors of this crate.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ParamError {
    /// The two rows of a projection span less than a plane.
    #[error(
        "the two rows of the projection are linearly dependent: {first:?} and {second:?}; \
         expected two independent rows of four numbers"
    )]
    DependentRows {
        /// The first row as given.
        first: [f64; 4],
        /// The second row as given.
        second: [f64; 4],
    },
    /// A projection row holds NaN or an infinity.
    #[error("row {row} of the projection holds {value}; expected finite numbers")]
    NotFinite {
        /// 0 or 1.
        row: usize,
        /// The offending number.
        value: f64,
    },
    /// A name that no parametrization carries.
    #[error("unknown parametrization {name:?}; expected one of {expected}")]
    UnknownName {
        /// The name as given.
        name: String,
        /// The names that exist, comma-separated.
        expected: String,
    },
}
