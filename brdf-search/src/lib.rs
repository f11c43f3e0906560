//! Search for the projections of a homomorphic factorization.
#![allow(missing_docs)]

mod control;
mod error;
mod joint;
mod random;
mod starts;
mod tangent;
mod varpro;

pub use control::{Control, Progress};
pub use error::SearchError;
pub use joint::{JointParams, search_joint};
pub use starts::canonical_projections;
