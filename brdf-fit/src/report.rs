//! What a fit reports: numbers for programs, notes for people.

use std::f64::consts::FRAC_PI_2;

use brdf_factor::{EvalCounts, Solver};
use brdf_model::{Brdf as _, Channels, Dropped, Fidelity, FitErrors, PairSampling};
use brdf_param::{Parametrization, Space};
use brdf_separable::{CellCounts, ChannelSpectrum, SeparableBrdf};
use serde::{Deserialize, Serialize};

use crate::compact::{CompactFit, CompactModel, CompactSettingsRecord, Makeup};
use crate::factored::{FactoredFit, FactoredModel};
use crate::method::{Method, SeparableMap};
use crate::record::{
    Albedo, FactoredRecord, FitSettingsRecord, RankRecord, SeparableSettingsRecord, TermRecord,
};
use crate::separable::SeparableFit;
use crate::tried::SearchReport;

/// Name of a model's file in the folder of its report.
const MODEL: &str = "model.safetensors";
/// Pairs over whole hemispheres whose treatment is counted.
const COUNTED_PAIRS: u32 = 20_000;

/// `report.json` of a product of textures. The first key marks the folder as ours.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FactoredReport {
    /// Version of the program.
    pub brdf: String,
    /// The material, as it was given.
    pub input: String,
    /// File name of the model, within the folder.
    pub model: String,
    /// How it was made.
    pub method: Method,
    /// Space of the projections of the largest model; those of smaller ones may have another.
    pub space: Space,
    /// What was fitted and what was not.
    pub samples: SamplesReport,
    /// Errors of the best model of each number of textures.
    pub terms: Vec<TermRecord>,
    /// What others reach on the same samples.
    pub baseline: BaselineReport,
    /// Linear least-squares problems that were solved.
    pub evaluations: usize,
    /// Of the fit and the search.
    pub seconds: f64,
    /// How projections were searched, if they were.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub search: Option<SearchReport>,
    /// Of the textures.
    pub bytes: usize,
    /// Largest directional albedos within the model's grazing limit.
    pub albedo: Albedo,
    /// Channels that were fitted.
    pub channels: Channels,
    /// How the linear system was solved.
    pub solve: SolveReport,
    /// Of the model with the most terms, away from the highlight and in it; none for scattered rows.
    pub fidelity: Option<Fidelity>,
    /// The same as it was fitted, before its texels were rounded; none where they are stored as f32.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fitted_fidelity: Option<Fidelity>,
    /// What evaluating the model on the pairs of a whole hemisphere does.
    pub evaluation: FactoredEvaluation,
    /// The settings that were used.
    pub settings: FitSettingsRecord,
    /// What a reader should know, in sentences.
    pub notes: Vec<String>,
}

/// Samples of a fit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SamplesReport {
    /// Rows or drawn pairs that were fitted.
    pub used: usize,
    /// The same with their turned copies.
    pub fitted: usize,
    /// Those left out, by reason.
    pub dropped: Dropped,
    /// Samples with a negative channel that was set to 0.
    pub clamped: usize,
}

/// What others reach on the same samples.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BaselineReport {
    /// McCool's two textures over fixed coordinates.
    pub mccool: TermRecord,
}

/// How a linear system was solved.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SolveReport {
    /// By what.
    pub solver: Solver,
    /// Texels solved for.
    pub unknowns: usize,
    /// Texels that no sample touches.
    pub smoothed_texels: usize,
    /// Of an iterative solver.
    pub iterations: usize,
    /// Whether it met its tolerance.
    pub converged: bool,
}

/// What evaluating a product of textures on pairs of whole hemispheres does.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FactoredEvaluation {
    /// Pairs that were looked at.
    pub pairs: u32,
    /// The model's grazing limit, degrees.
    pub max_theta_deg: f64,
    /// What was done to them.
    #[serde(flatten)]
    pub counts: EvalCounts,
}

impl FactoredFit {
    /// Returns the report of the fit of what a user calls `input`, by a program of this version, with these notes in
    /// words.
    pub fn report(&self, input: &str, version: &str, notes: Vec<String>) -> FactoredReport {
        let fit = self.last();
        let sampling = PairSampling { count: COUNTED_PAIRS, seed: 1, theta_max: FRAC_PI_2 };
        FactoredReport {
            brdf: version.to_owned(),
            input: input.to_owned(),
            model: MODEL.to_owned(),
            method: self.method,
            space: self.space(),
            samples: SamplesReport {
                used: self.rows,
                fitted: fit.samples_used,
                dropped: fit.dropped,
                clamped: fit.clamped,
            },
            terms: self.terms.clone(),
            baseline: BaselineReport { mccool: self.baseline.clone() },
            evaluations: self.evaluations,
            seconds: self.seconds,
            search: self.search.clone(),
            bytes: fit.model.payload_bytes(),
            albedo: self.albedo,
            channels: self.channels,
            fidelity: self.fidelity,
            fitted_fidelity: self.fitted_fidelity.as_deref().copied(),
            solve: SolveReport {
                solver: fit.solver,
                unknowns: fit.unknowns,
                smoothed_texels: fit.smoothed_texels,
                iterations: fit.iterations,
                converged: fit.converged,
            },
            evaluation: FactoredEvaluation {
                pairs: COUNTED_PAIRS,
                max_theta_deg: fit.model.theta_max().to_degrees(),
                counts: fit.model.count(sampling.pairs()),
            },
            settings: self.settings.clone(),
            notes,
        }
    }
}

/// `report.json` of a model that was taken out of a larger one. The first key marks the folder as ours.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct KeptReport {
    /// Version of the program.
    pub brdf: String,
    /// File name of the model, within the folder.
    pub model: String,
    /// Of the textures.
    pub bytes: usize,
    /// How it was made.
    pub fit: FactoredRecord,
}

impl KeptReport {
    /// Returns the report of a kept model, by a program of this version.
    pub fn new(kept: &FactoredModel, version: &str) -> Self {
        Self {
            brdf: version.to_owned(),
            model: MODEL.to_owned(),
            bytes: kept.model.payload_bytes(),
            fit: kept.record.clone(),
        }
    }
}

/// `report.json` of a sum of products. The first key marks the folder as ours.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SeparableReport {
    /// Version of the program.
    pub brdf: String,
    /// The material, as it was given.
    pub input: String,
    /// File name of the model, within the folder.
    pub model: String,
    /// How it was made.
    pub method: Method,
    /// What its two sides are functions of.
    pub space: Parametrization,
    /// How the hemisphere is laid out in textures.
    pub map: SeparableMap,
    /// The matrix that was decomposed.
    pub matrix: MatrixReport,
    /// Errors for each number of terms.
    pub terms: Vec<RankRecord>,
    /// Magnitudes of terms, for each channel or for all together.
    pub spectra: Vec<ChannelSpectrum>,
    /// Of filling the matrix alone.
    pub fill_seconds: f64,
    /// Of filling and decomposing it.
    pub seconds: f64,
    /// Of the textures.
    pub bytes: usize,
    /// Largest directional albedos.
    pub albedo: Albedo,
    /// Channels that were fitted.
    pub channels: Channels,
    /// What evaluating the model on pairs of whole hemispheres does.
    pub evaluation: SeparableEvaluation,
    /// The settings that were used.
    pub settings: SeparableSettingsRecord,
    /// What a reader should know, in sentences.
    pub notes: Vec<String>,
}

/// The matrix of a sum of products.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MatrixReport {
    /// Nodes of the first side.
    pub rows: usize,
    /// Nodes of the second side.
    pub columns: usize,
    /// What became of its cells.
    pub cells: CellCounts,
    /// ‖M − Mᵀ‖ / ‖M‖ before it was made symmetric, if it was.
    pub asymmetry: Option<f64>,
}

/// What evaluating a sum of products on pairs of whole hemispheres does.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SeparableEvaluation {
    /// Pairs that were looked at.
    pub pairs: usize,
    /// Those with a channel that came out negative and was set to 0.
    pub clamped_below_zero: usize,
}

impl SeparableFit {
    /// Returns the report of the fit of what a user calls `input`, by a program of this version, with these notes in
    /// words.
    pub fn report(&self, input: &str, version: &str, notes: Vec<String>) -> SeparableReport {
        let (model, fit) = (&self.model.model, &self.model.record);
        let [rows, columns] = self.matrix;
        SeparableReport {
            brdf: version.to_owned(),
            input: input.to_owned(),
            model: MODEL.to_owned(),
            method: fit.method,
            space: model.layout().parametrization,
            map: self.map,
            matrix: MatrixReport { rows, columns, cells: fit.cells, asymmetry: fit.asymmetry },
            terms: fit.terms.clone(),
            spectra: fit.spectra.clone(),
            fill_seconds: self.fill_seconds,
            seconds: self.seconds,
            bytes: model.payload_bytes(),
            albedo: self.albedo,
            channels: model.channels(),
            evaluation: SeparableEvaluation {
                pairs: COUNTED_PAIRS as usize,
                clamped_below_zero: negative_pairs(model),
            },
            settings: fit.settings.clone(),
            notes,
        }
    }
}

/// Pairs over whole hemispheres for which a channel comes out negative.
fn negative_pairs(model: &SeparableBrdf) -> usize {
    let sampling = PairSampling { count: COUNTED_PAIRS, seed: 1, theta_max: FRAC_PI_2 };
    let is_negative = |pair| {
        model.eval_unclamped(&pair).channels()[..model.maps().len()].iter().any(|v| *v < 0.0)
    };
    sampling.pairs().filter(|pair| is_negative(*pair)).count()
}

/// What `--json` prints for a compact model. `brdf` and `input` are a version and a name; `model` is in the folder as
/// ours.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CompactReport {
    /// Version of the program.
    pub brdf: String,
    /// The material, as it was given.
    pub input: String,
    /// File name of the model, within the folder.
    pub model: String,
    /// How it was made.
    pub method: Method,
    /// Of fitting, without measuring errors.
    pub seconds: f64,
    /// Of the stream, or of the parameters as f32.
    pub bytes: usize,
    /// Channels that were fitted.
    pub channels: Channels,
    /// What the model is made of.
    pub makeup: Makeup,
    /// Samples that were fitted.
    pub samples_used: usize,
    /// Samples left out.
    pub dropped: Dropped,
    /// Values of channels that are 0 in what was fitted.
    pub zeros: usize,
    /// Over scattered samples that were fitted.
    pub training: Option<FitErrors>,
    /// Over pairs, or folds of rows, that were not fitted.
    pub held_out: Option<FitErrors>,
    /// Over held-out pairs, away from the highlight and in it.
    pub fidelity: Option<Fidelity>,
    /// The geometric mean of the errors of `fidelity`.
    pub score: Option<f64>,
    /// Largest directional albedos.
    pub albedo: Albedo,
    /// The settings that were used.
    pub settings: CompactSettingsRecord,
    /// What a reader should know, in sentences.
    pub notes: Vec<String>,
}

impl CompactFit {
    /// Returns the report of the fit of what a user calls `input`, by a program of this version, with these notes in
    /// words.
    pub fn report(&self, input: &str, version: &str, notes: Vec<String>) -> CompactReport {
        let CompactModel { model, record } = &self.model;
        CompactReport {
            brdf: version.to_owned(),
            input: input.to_owned(),
            model: MODEL.to_owned(),
            method: record.method,
            seconds: self.seconds,
            bytes: model.payload_bytes(),
            channels: model.channels(),
            makeup: record.makeup.clone(),
            samples_used: record.samples_used,
            dropped: record.dropped,
            zeros: self.zeros,
            training: self.training,
            held_out: record.held_out,
            fidelity: record.fidelity,
            score: record.fidelity.map(|fidelity| fidelity.score()),
            albedo: self.albedo,
            settings: record.settings,
            notes,
        }
    }
}
