//! Isotropic BRDFs as sums of products of splines: models of one to thirty kilobytes that keep the highlight.
//!
//! A model is ln(a + f) ≈ Σ_k g_k(θh) Σ_jm C_kjm B_j(θd) sinᵐθd cos mφd. The splines g_k have their knots where
//! highlights are, evenly in asinh(θh/α). [`fit_splines`] fits a material that can be evaluated,
//! [`fit_spline_samples`] scattered samples, both in as many bytes as they are given. Models of samples may change GGX
//! lobes, which are left where no sample is: f = (a + g) eʸ − a, with y the sum and g the lobes. What comes out is a
//! [`SplineBrdf`]: a stream of bytes, and a [`Brdf`](brdf_model::Brdf) that is read from two tables.
//!
//! Fits are alternating least squares: g is solved for, then C, and again. Weights make the errors of
//! [`Fidelity`](brdf_model::Fidelity) fall together. Where a value is 0 the model may be anything below. Coefficients are
//! rounded one after another, each making up for what rounding did before, and coded under adaptive probabilities.
//!
//! ```
//! use brdf_job::Job;
//! use brdf_model::{FidelityPairs, Preset};
//! use brdf_spline::{SplineSettings, fit_splines};
//!
//! let plastic = Preset::find("plastic").expect("a preset").brdf();
//! let settings = SplineSettings { bytes: 600, ..SplineSettings::default() };
//! let fit = fit_splines(&plastic, &settings, &Job::new())?;
//! let errors = FidelityPairs::new(7, 1.4).measure(&plastic, &fit.model);
//! assert!(fit.model.as_bytes().len() <= 600 && errors.score() < 0.02, "{errors:?}");
//! # Ok::<(), brdf_spline::SplineError>(())
//! ```

mod alternating;
mod banded;
mod base;
mod basis;
mod batch;
mod channel;
mod coder;
mod equations;
mod error;
mod fit;
mod harmonics;
mod judges;
mod model;
mod nodes;
mod opponent;
mod places;
mod products;
mod rounding;
mod samples;
mod size;
mod stream;
mod table;
mod trials;
mod warp;
mod weights;

pub use error::SplineError;
pub use fit::{SPLINE_BYTES, SplineFit, SplineSettings, fit_splines};
pub use harmonics::Symmetry;
pub use model::SplineBrdf;
pub use samples::{BaseFit, fit_spline_samples};
pub use trials::SplineTrial;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDocTests;
