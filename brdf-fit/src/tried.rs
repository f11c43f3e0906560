//! The record of a search.

use brdf_param::Space;
use serde::{Deserialize, Serialize};

/// How projections were searched.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SearchReport {
    /// Projections asked for.
    pub terms: usize,
    /// Why the search ended early, if it did: `interrupted` or `time limit`.
    pub stopped: Option<String>,
    /// Every family that was searched, in order; the last of several may be the winner, searched
    /// again with all rows.
    pub tried: Vec<Tried>,
}

/// A family of projections that was tried.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Tried {
    /// What is projected.
    pub space: Space,
    /// Whether light and viewer share textures.
    pub reciprocal: bool,
    /// Mean square log error on the validation pairs; none where there was nothing to choose.
    pub validation: Option<f64>,
    /// Linear least-squares problems that were solved.
    pub evaluations: usize,
    /// Time it took.
    pub seconds: f64,
}
