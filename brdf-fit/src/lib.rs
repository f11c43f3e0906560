//! Fits of materials by every method of the project, judged on samples that were not fitted.
//!
//! [`fit`] takes a [`Material`] (anything that answers to [`Brdf`](brdf_model::Brdf), or scattered samples), settings
//! and a [`Job`](brdf_job::Job), and returns a model with its errors, the settings that were used, and typed notes on
//! what a reader of the numbers should know. Nothing here reads files, prints, or knows of options.
//!
//! What is held out, what families of projections are compared on, and how scattered rows are split, is the
//! [protocol](fit#protocol) of [`fit`]. [`compare`] judges models by one reference.
//!
//! ```
//! use brdf_fit::{Fit, FitSettings, FactoredMethod, FactoredSettings, Material, fit};
//! use brdf_job::Job;
//! use brdf_model::Preset;
//!
//! let paint = Preset::find("lafortune-blue-paint").expect("a preset").brdf();
//! let settings = FactoredSettings { samples: 5_000, ..FactoredSettings::of(FactoredMethod::McCool) };
//! let fit = fit(&Material::new("blue paint", &paint), &FitSettings::Factored(settings), &Job::new())?;
//! let errors = fit.held_out().expect("pairs that were not fitted");
//! assert!(errors.log.mean_square < 0.05);
//! assert!(fit.bytes() < 30_000 && matches!(fit, Fit::Factored(_)));
//! # Ok::<(), brdf_fit::FitError>(())
//! ```

mod auto;
mod basis;
mod compact;
mod compare;
mod distribution;
mod error;
mod factor_model;
mod factored;
mod fit;
mod fitted;
mod isotropic;
mod judge;
mod lobes;
mod material;
mod measures;
mod method;
mod network;
mod note;
mod preinvert;
mod record;
mod report;
mod search;
mod separable;
mod spectrum;
mod training;
mod tried;

pub use auto::{Aim, AutoSettings, fit_auto};
pub use basis::Basis;
pub use compact::{
    CompactBrdf, CompactFit, CompactMethod, CompactModel, CompactRecord, CompactSettings,
    CompactSettingsRecord, Makeup, fit_compact,
};
pub use compare::{Candidate, CompareSettings, Comparison, compare, metric_lights};
pub use distribution::{Distribution, FolderComparison, MeasureDistribution};
pub use error::FitError;
pub use factor_model::{FactorChannel, FactorModel, FactorModelSettings, fit_factor_model};
pub use factored::{
    FactoredFit, FactoredMethod, FactoredModel, FactoredSettings, Reciprocity, fit_factored,
};
pub use fit::{FitSettings, fit};
pub use fitted::Fit;
pub use isotropic::{IsotropicSettings, TriedPairs};
pub use material::Material;
pub use measures::{Measure, ModelMeasures, PictureMeasures};
pub use method::{Method, SeparableMap, StrategyKind};
pub use network::{NetworkSettings, train_network};
pub use note::FitNote;
pub use preinvert::preinvert;
pub use record::{
    Albedo, BasisRecord, FactoredRecord, FitSettingsRecord, RankRecord, SearchSettingsRecord,
    SeparableRecord, SeparableSettingsRecord, StoredErrors, TermRecord, TriedModel,
};
pub use report::{
    BaselineReport, CompactReport, FactoredEvaluation, FactoredReport, KeptReport, MatrixReport,
    SamplesReport, SeparableEvaluation, SeparableReport, SolveReport,
};
pub use search::{FixedFactors, SearchSettings, Strategy};
pub use separable::{
    LogChoice, SeparableFit, SeparableMethod, SeparableModel, SeparableSettings, fit_separable,
};
pub use spectrum::{RankErrors, light_view_spectrum, rank_errors};
pub use training::HELD_OUT_PAIRS;
pub use tried::{FamilyRecord, SearchReport, Tried};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDocTests;
