//! Homomorphic factorization: a BRDF as a product of small textures,
//! f(wi, wo) ≈ Π p_j(π_j(wi, wo)), solved as a linear least-squares problem for log p_j.
//!
//! The coordinates π_j are given here; searching for them is another crate's work. Source: McCool,
//! Ang and Ahmad 2001; Cole 2002, chapter 3.
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
mod factored;
mod factorization;
mod grid;
mod linear_system;
mod log_transform;
mod lsmr;
mod normal_equations;
mod preinverted;
mod problem;
mod qmr;
mod solver;
mod surface;
mod validation;

pub use columns::Columns;
pub use coordinate::{Coordinate, FactorSpec};
pub use error::FactorError;
pub use factored::{EvalCounts, Factor, FactorDescription, FactoredBrdf};
pub use factorization::{FactorParams, Fit, TermSolve, Weight, factorize, factorize_terms};
pub use grid::Grid;
pub use linear_system::LinearSystem;
pub use log_transform::{ChannelTransform, LogTransform};
pub use normal_equations::{CholeskyFactor, NormalEquations};
pub use preinverted::{
    Damping, Inverse, Inversion, Plan, Preinverted, PreinvertedWorkspace, SpectralBasis,
};
pub use problem::Problem;
pub use solver::{Solution, Solver};
pub use surface::{SurfaceProduct, SurfaceTexture};
pub use validation::{CrossValidation, cross_validate};
