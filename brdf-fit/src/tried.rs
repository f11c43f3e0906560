//! The record of a search.

use std::fmt;

use brdf_param::Space;
use brdf_search::Family;
use serde::{Deserialize, Serialize};

/// How projections were searched.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SearchReport {
    /// Projections asked for.
    pub terms: usize,
    /// Why the search ended early, if it did: `interrupted` or `time limit`.
    pub stopped: Option<String>,
    /// Every search, in order. Where families were compared on a part of measured rows, those that
    /// were best for some number of terms follow, searched again with all rows.
    pub tried: Vec<Tried>,
}

/// What projections are of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FamilyRecord {
    /// What is projected.
    pub space: Space,
    /// Whether light and viewer share textures.
    pub reciprocal: bool,
}

impl From<&Family> for FamilyRecord {
    fn from(family: &Family) -> Self {
        Self { space: family.space, reciprocal: family.reciprocal }
    }
}

impl fmt::Display for FamilyRecord {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = if self.reciprocal { "reciprocal" } else { "not reciprocal" };
        write!(f, "{}, {kind}", self.space.name())
    }
}

/// A family of projections that was tried.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Tried {
    /// What was searched.
    #[serde(flatten)]
    pub family: FamilyRecord,
    /// Mean square log error on the validation pairs for each number of terms; empty where there was
    /// nothing to choose.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub validation: Vec<f64>,
    /// Linear least-squares problems that were solved.
    pub evaluations: usize,
    /// Time it took.
    pub seconds: f64,
}
