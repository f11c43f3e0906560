//! Homomorphic factorization: a BRDF as a product of small textures,
//! f(wi, wo) ≈ Π p_j(π_j(wi, wo)), solved as a linear least-squares problem for log p_j.
//!
//! Each factor p_j is a texture, and π_j are the coordinates at which a pair of directions reads it.
//! Taking logarithms turns the product into a sum, so that the best texels are found at once.
//!
//! - A [`FactorSpec`] lists the coordinates that share a texture. [`FactorSpec::mccool`] and
//!   [`FactorSpec::radial`] are published choices, [`FactorSpec::projections`] takes any planes,
//!   [`IsotropicPairs`] has pairs of angles for isotropic materials.
//! - [`factorize`] fits the textures to a set of samples; [`FactorParams`] are its options.
//! - The result is a [`Fit`], which holds a [`FactoredBrdf`]. That is a [`Brdf`](brdf_model::Brdf) again.
//! - [`FactoredBrdf::stored_as`] rounds the texels to f16 or eight bits, a half or a quarter of the bytes.
//! - [`cross_validate`] estimates errors on samples that were not fitted.
//! - [`Preinverted`] fits many sets of values at the same directions, one after another, quickly.
//! - [`Problem`], [`Columns`], [`LinearSystem`] and [`NormalEquations`] are the parts that a fit is made
//!   of. A search for better coordinates uses them.
//!
//! The coordinates are given here; `brdf-search` finds them. Source: McCool, Ang and Ahmad 2001; Cole
//! 2002, chapter 3.
//!
//! # Example
//!
//! ```
//! use brdf_factor::{FactorParams, FactorSpec, factorize};
//! use brdf_model::{Channels, PairSampling, Preset, SampleSet, log_offsets, measure};
//!
//! let paint = Preset::find("lafortune-blue-paint").expect("a preset").brdf();
//! let params = FactorParams { texture_size: 8, ..FactorParams::default() };
//! let sampling = PairSampling { count: 4_000, seed: 1, theta_max: params.theta_max };
//! let samples = SampleSet::draw(&paint, &sampling, Channels::Luminance);
//! let fit = factorize(&samples, &FactorSpec::mccool(true), &params)?;
//! let errors = measure(&samples, &fit.model, &log_offsets(&samples));
//! assert!(errors.log.mean_square < 0.1);
//! # Ok::<(), brdf_factor::FactorError>(())
//! ```

mod batch;
mod columns;
mod coordinate;
mod error;
mod evaluation;
mod factored;
mod factorization;
mod gauge;
mod grid;
mod isotropic;
mod isotropic_pairs;
mod iterated;
mod linear_system;
mod log_transform;
mod lsmr;
mod normal_equations;
mod params;
mod preinverted;
mod problem;
mod qmr;
mod solver;
mod surface;
mod texels;
mod validation;

pub use columns::Columns;
pub use coordinate::{Coordinate, FactorSpec};
pub use error::FactorError;
pub use factored::{EvalCounts, Factor, FactorDescription, FactoredBrdf};
pub use factorization::{Fit, factorize, factorize_problem, factorize_terms};
pub use grid::Grid;
pub use isotropic::{Angle, Axis, Spacing};
pub use isotropic_pairs::IsotropicPairs;
pub use linear_system::LinearSystem;
pub use log_transform::{ChannelTransform, LogTransform};
pub use normal_equations::{CholeskyFactor, NormalEquations};
pub use params::{FactorParams, Solver, TermSolve, Weight, Zeros};
pub use preinverted::{
    Damping, Inverse, Inversion, Plan, Preinverted, PreinvertedWorkspace, SpectralBasis,
};
pub use problem::Problem;
pub use solver::{PreparedSystem, Solution};
pub use surface::{SurfaceProduct, SurfaceTexture};
pub use texels::{StoredTexels, TexelFormat};
pub use validation::{CrossValidation, cross_validate};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDocTests;
