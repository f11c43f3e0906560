//! How models were made and how good they are, as files and reports keep it.

use brdf_factor::{FactorParams, Plan, TexelFormat};
use brdf_model::{Dropped, FitErrors};
use brdf_param::{Projection, Space};
use brdf_search::Objective;
use brdf_separable::{CellCounts, ChannelSpectrum, Decomposition, Fill, RankError};
use serde::{Deserialize, Serialize};

use crate::method::{Method, StrategyKind};
use crate::tried::FamilyRecord;

/// How a factored model was made and how good it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FactoredRecord {
    /// `search`, `mccool`, `radial`, `projections`, `isotropic`, `coordinates` or `preinverted`.
    pub method: Method,
    /// What was fitted: a preset, or the name of a file without its folder.
    pub input: String,
    /// Space of the projections of the largest model; those of smaller ones may have another.
    pub space: Space,
    /// Options.
    pub settings: FitSettingsRecord,
    /// Errors for each number of terms.
    pub terms: Vec<TermRecord>,
    /// Samples fitted, after replication.
    pub samples_used: usize,
    /// Samples left out.
    pub dropped: Dropped,
}

/// Options that decide a fit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FitSettingsRecord {
    /// Of the fit itself.
    pub params: FactorParams,
    /// Whether light and viewer share textures; after a search that tried both, those of the largest
    /// model.
    pub reciprocal: bool,
    /// Pairs asked for; scattered rows come as they are.
    pub samples: u32,
    /// Share of the pairs around the mirror direction.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub highlight: f64,
    /// Which scramble.
    pub seed: u64,
    /// Copies of each sample by rotation.
    pub replicate: u32,
    /// How texels are stored.
    #[serde(default, skip_serializing_if = "TexelFormat::is_f32")]
    pub texels: TexelFormat,
    /// How projections were searched, if they were.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub search: Option<SearchSettingsRecord>,
}

fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

/// Options that decide a search.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SearchSettingsRecord {
    /// How projections were searched.
    pub strategy: StrategyKind,
    /// What a Powell search minimized.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub objective: Option<Objective>,
    /// Largest number of projections asked for.
    pub terms: usize,
    /// Random starts.
    pub restarts: usize,
    /// Planes to start from.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub start: Vec<Projection>,
}

/// Errors of the model with a number of terms.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TermRecord {
    /// Textures of the model.
    pub textures: usize,
    /// What its projections are of; none where it has none.
    #[serde(flatten, default, skip_serializing_if = "Option::is_none")]
    pub family: Option<FamilyRecord>,
    /// Its projections, for each factor that has one; conjugates are left out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub projections: Vec<Projection>,
    /// Over the training samples.
    #[serde(flatten)]
    pub training: FitErrors,
    /// Over samples that were not fitted; none where there were too few.
    pub held_out: Option<FitErrors>,
    /// The same of the model with its texels as stored; none where those are f32, as they are fitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stored: Option<Box<StoredErrors>>,
}

impl TermRecord {
    /// Returns the errors of the model as it is stored: over the training samples, and over those that were not fitted.
    pub fn of_model(&self) -> (&FitErrors, Option<&FitErrors>) {
        match &self.stored {
            Some(stored) => (&stored.training, stored.held_out.as_ref()),
            None => (&self.training, self.held_out.as_ref()),
        }
    }
}

/// Errors of a model whose texels were rounded to be stored.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StoredErrors {
    /// Over the training samples.
    #[serde(flatten)]
    pub training: FitErrors,
    /// Over samples that were not fitted; none where there were too few.
    pub held_out: Option<FitErrors>,
}

/// How a sum of products was made and how good it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SeparableRecord {
    /// `svd`, `log-svd`, `eigen`, `nmf` or `normalized`.
    pub method: Method,
    /// What was factored: a preset, or the name of a file without its folder.
    pub input: String,
    /// Options.
    pub settings: SeparableSettingsRecord,
    /// What became of the cells of the matrix.
    pub cells: CellCounts,
    /// ‖M − Mᵀ‖ / ‖M‖ before the matrix was made symmetric, if it was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub asymmetry: Option<f64>,
    /// Singular values, eigenvalues or norms, for each channel or for all together.
    pub spectra: Vec<ChannelSpectrum>,
    /// Errors for each number of terms.
    pub terms: Vec<RankRecord>,
}

/// Options that decide a sum of products.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SeparableSettingsRecord {
    /// Which decomposition.
    pub decomposition: Decomposition,
    /// Number of terms asked for.
    pub rank: usize,
    /// All channels together, scalar textures on the first side.
    pub joint_rgb: bool,
    /// Grazing limit of the matrix, radians.
    pub theta_max: f64,
    /// What stands in cells without data.
    pub fill: Fill,
    /// Power of the cosine in the weights.
    pub weight_power: f64,
    /// Grazing limit of the held-out pairs, radians.
    pub held_out_theta_max: f64,
    /// Which scramble they come from.
    pub seed: u64,
}

/// Errors of a sum of products with a number of terms.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RankRecord {
    /// Over the cells of the matrix.
    #[serde(flatten)]
    pub matrix: RankError,
    /// Over pairs between its nodes; none for scattered rows, of which all were used.
    pub held_out: Option<FitErrors>,
}

/// What a preinverted matrix was made for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BasisRecord {
    /// `mccool`, `radial` or `projections`.
    pub method: Method,
    /// The factors.
    pub plan: Plan,
    /// How samples were drawn and fitted.
    pub settings: FitSettingsRecord,
    /// Hash of the samples' places and all else that the matrix depends on.
    pub key: String,
    /// Texels solved for.
    pub unknowns: usize,
    /// Vectors of a basis; none for a Cholesky factor.
    pub components: Option<usize>,
}

/// How much light leaves at most, of what arrives.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Albedo {
    /// Of the material; none where it has holes that only interpolation fills.
    pub reference: Option<f64>,
    /// Of the model with the most terms.
    pub model: f64,
}

/// A model that was made to be chosen or not.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TriedModel {
    /// How it was made.
    pub method: Method,
    /// Of textures, stream or parameters.
    pub bytes: usize,
    /// What models were chosen by.
    pub error: f64,
}
