//! Search for the projections of a homomorphic factorization.

mod error;
mod family;
mod greedy;
mod joint;
mod line_search;
mod monitor;
mod outcome;
mod powell;
mod random;
mod rotation;
mod starts;
mod tangent;
mod varpro;

pub use error::SearchError;
pub use family::{Family, MAX_TERMS};
pub use greedy::{GreedyParams, Objective, search_greedy};
pub use joint::{JointParams, search_joint};
pub use line_search::{LineParams, LinePoint, minimize_on_line};
pub use outcome::{SearchOutcome, TermOutcome};
pub use powell::{Minimum, PowellParams, minimize_rotation};
pub use rotation::Rotation4;
pub use starts::canonical_projections;
