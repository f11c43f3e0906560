//! What is known of a material without fitting it.

use brdf_fit::{CompactRecord, FactoredRecord, SeparableRecord};
use brdf_io::Measured;
use brdf_model::{Channels, Dropped, PhysicalChecks, SampleSet, SampleSummary, check, summarize};
use serde::Serialize;

use crate::open::{Content, MaterialFile};

/// Grazing limit of the checks, degrees.
const CHECKED_THETA_DEG: f64 = 80.0;

/// What a material's file holds, and whether it is physically plausible: an entry of what `brdf info` prints.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MaterialInfo {
    /// The material, as it was asked for.
    pub file: String,
    /// What people call the kind of file.
    pub format: &'static str,
    /// Of the textures of a model, or of the whole file.
    pub bytes: usize,
    /// Channels of its own.
    pub channels: Channels,
    /// Cells of a MERL table without data.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub invalid_cells: Option<usize>,
    /// Ranges of scattered samples.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub samples: Option<SampleSummary>,
    /// Rows of a scattered measurement left out, by reason.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dropped: Option<Dropped>,
    /// Reciprocity, albedo and coverage within 80° of the normal, of what can be evaluated everywhere.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub checks: Option<PhysicalChecks>,
    /// How a product of textures was made.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub model: Option<FactoredRecord>,
    /// How a sum of products was made.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub separable: Option<SeparableRecord>,
    /// How a compact model was made.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub compact: Option<CompactRecord>,
    /// What the reader assumed or changed, in sentences.
    pub notes: Vec<String>,
}

impl MaterialFile {
    /// Returns what is known of the material, with these notes in words.
    pub fn info(&self, notes: Vec<String>) -> MaterialInfo {
        let scattered = self.samples();
        MaterialInfo {
            file: self.source.clone(),
            format: self.kind(),
            bytes: self.bytes(),
            channels: self.channels(),
            invalid_cells: match &self.content {
                Content::Measured(Measured::Merl(table)) => Some(table.invalid_cells()),
                _ => None,
            },
            samples: scattered.map(summarize),
            dropped: scattered.map(SampleSet::dropped),
            checks: scattered.is_none().then(|| check(self.brdf(), CHECKED_THETA_DEG.to_radians())),
            model: match &self.content {
                Content::Factored(model) => Some(model.record.clone()),
                _ => None,
            },
            separable: match &self.content {
                Content::Separable(model) => Some(model.record.clone()),
                _ => None,
            },
            compact: match &self.content {
                Content::Compact(model) => Some(model.record.clone()),
                _ => None,
            },
            notes,
        }
    }
}
