//! The errors of projections and parametrizations.

use std::fmt;

/// An error of this crate: rows that make no projection, or an unknown name.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ParamError {
    /// The two rows of a projection span less than a plane.
    DependentRows {
        /// The first row as given.
        first: [f64; 4],
        /// The second row as given.
        second: [f64; 4],
    },
    /// A projection row holds NaN or an infinity.
    NotFinite {
        /// Index of the row, 0 or 1.
        row: usize,
        /// The number that is not finite.
        value: f64,
    },
    /// A name that no parametrization carries.
    UnknownName {
        /// The name as given.
        name: String,
        /// The names that exist, comma-separated.
        expected: String,
    },
}

// By hand: a derive would cost this crate, which everything stands on, six more.
impl fmt::Display for ParamError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::DependentRows { first, second } => write!(
                f,
                "the two rows of the projection are linearly dependent: {first:?} and {second:?}; \
                 expected two independent rows of four numbers"
            ),
            Self::NotFinite { row, value } => {
                write!(f, "row {row} of the projection holds {value}; expected finite numbers")
            }
            Self::UnknownName { name, expected } => {
                write!(f, "unknown parametrization {name:?}; expected one of {expected}")
            }
        }
    }
}

impl std::error::Error for ParamError {}
