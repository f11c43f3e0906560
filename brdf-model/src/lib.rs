//! Reflectance models: the [`Brdf`] trait, formulas, measured tables, samples and error measures.
//!
//! A BRDF (bidirectional reflectance distribution function) says how much of the light that arrives
//! from one direction leaves in another. This crate has:
//!
//! - [`Brdf`], the trait of everything that can be evaluated, one pair of directions at a time or
//!   many at once;
//! - formulas ([`Analytic`]) and named materials made of them ([`Preset`]);
//! - measured tables: [`MerlTable`], [`RglBrdf`], [`UtiaTable`], [`Nbrdf`] and [`ScatteredBrdf`];
//! - [`SampleSet`], the samples that models are fitted to, and [`PairSampling`], which draws them;
//! - [`measure`] and its relatives, which say how far an approximation is from its reference, and
//!   [`check`], which tests a model for reciprocity and energy.
//!
//! # Conventions
//!
//! Values are in sr⁻¹, in linear RGB with Rec. 709 primaries. They do *not* include the cosine of the
//! angle of incidence. Directions are unit vectors in the local frame of [`brdf_param`]: z is the
//! normal, `wi` points to the light, `wo` to the viewer.
//!
//! # Example
//!
//! ```
//! use brdf_model::{Brdf, Preset};
//! use brdf_param::DirectionPair;
//!
//! let paint = Preset::find("lafortune-blue-paint").expect("a preset of this crate").brdf();
//! let value = paint.eval(&DirectionPair::from_angles(0.3, 0.0, 0.3, std::f64::consts::PI));
//! assert!(value.b > value.r, "blue paint is blue");
//! ```

mod analytic;
mod batch;
mod brdf;
mod checks;
mod distribution;
pub mod elementary;
mod error;
mod fidelity;
mod fresnel;
mod interpolated_warp;
mod large_table;
mod luminance;
mod merl;
mod merl_batch;
mod merl_lookup;
mod metrics;
mod nbrdf;
mod perceptual;
mod preset;
mod rgb;
mod rgl;
mod sample_set;
mod sampling;
mod scattered;
mod srgb;
mod utia;

pub use analytic::{
    Analytic, AshikhminShirley, BlinnPhong, CookTorrance, Ggx, GgxLobe, GgxLobes, Lafortune,
    LafortuneLobe, Lambert, Plastic, Ward,
};
pub use batch::{DirectionBatch, DirectionSlices, RgbBatch};
pub use brdf::{Brdf, DirectionSampler};
pub use checks::{
    ANISOTROPIC, Coverage, PhysicalChecks, SampleSummary, anisotropy, check, directional_albedo,
    largest_albedo, summarize,
};
pub use distribution::{
    Distribution1D, LinearDistributions, linear_part, linear_segment, share_of,
};
pub use error::ModelError;
pub use fidelity::{
    FIDELITY_PAIRS, Fidelity, FidelityErrors, FidelityPairs, FidelityReference, MeasuredValue,
};
pub use fresnel::{Fresnel, conductor_reflectance, dielectric_reflectance};
pub use interpolated_warp::{InterpolatedWarp, WarpShape};
pub use luminance::Luminance;
pub use merl::{MerlLookup, MerlNodes, MerlTable};
pub use metrics::{
    COSINE_RMS_PAIRS, CosineRms, ErrorMeasures, FitErrors, cosine_rms, cosine_rms_pairs,
    log_offsets, measure, measure_folds,
};
pub use nbrdf::{Nbrdf, NbrdfDomain};
pub use perceptual::{PerceptualErrors, perceptual_errors};
pub use preset::Preset;
pub use rgb::{Channels, Rgb};
pub use rgl::{RglBrdf, RglTables};
pub use sample_set::{Dropped, SampleSet};
pub use sampling::{PairSampling, ScrambledSobol, cosine_hemisphere, uniform_hemisphere};
pub use scattered::ScatteredBrdf;
pub use srgb::{decode_srgb, encode_srgb, linear_to_srgb, srgb_to_linear};
pub use utia::UtiaTable;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDocTests;
