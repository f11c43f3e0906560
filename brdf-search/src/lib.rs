//! Search for the projections of a homomorphic factorization.

mod control;
mod error;
mod family;
mod joint;
mod outcome;
mod random;
mod starts;
mod tangent;
mod varpro;

pub use control::{Control, Progress};
pub use error::SearchError;
pub use family::{Family, MAX_TERMS};
pub use joint::{JointParams, search_joint};
pub use outcome::{SearchOutcome, TermOutcome};
pub use starts::canonical_projections;
