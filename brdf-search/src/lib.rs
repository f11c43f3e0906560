//! Search for the projections of a homomorphic factorization.
//!
//! `brdf-factor` makes a BRDF into a product of textures, f(wi, wo) ≈ Π p_j(π_j(wi, wo)), for given
//! coordinates π_j. Here the coordinates are linear projections from four dimensions to two
//! ([`Projection`](brdf_param::Projection)), and the search finds those with the smallest error.
//!
//! - A [`Family`] says what is searched: projections of one space, reciprocal or not, perhaps beside
//!   factors that are fixed.
//! - [`search_joint`] moves all projections of a model together, from many starts. It is the search to use.
//! - [`search_greedy`] adds one projection after another by Powell's method, as Cole 2002 did.
//! - The result is a [`SearchOutcome`]: the best projections of every number of terms. Textures are then
//!   fitted by [`brdf_factor::factorize`].
//!
//! Rotations of four dimensions ([`Rotation4`]), Powell's method over them ([`minimize_rotation`]) and the
//! line search below it ([`minimize_on_line`]) can be used alone. Source: Cole 2002, chapters 2 and 3.
//!
//! # Example
//!
//! ```
//! use brdf_factor::{FactorParams, Problem, factorize};
//! use brdf_job::Job;
//! use brdf_model::{Channels, PairSampling, Preset, SampleSet};
//! use brdf_param::Space;
//! use brdf_search::{Family, JointParams, search_joint};
//!
//! let plastic = Preset::find("plastic").expect("a preset").brdf();
//! let params = FactorParams { texture_size: 8, ..FactorParams::default() };
//! let sampling = PairSampling { count: 1_000, seed: 1, theta_max: params.theta_max };
//! let samples = SampleSet::draw(&plastic, &sampling, Channels::Luminance);
//!
//! let problem = Problem::new(&samples, &params)?;
//! let family = Family::new(Space::HalfDifference, true);
//! let search = JointParams { terms: 1, texture_size: 8, restarts: 2, ..JointParams::default() };
//! let found = search_joint(&problem, &family, &search, &Job::new())?;
//! let fit = factorize(&samples, &family.specs(&found.terms[0].projections), &params)?;
//! assert_eq!(fit.model.factors().len(), 1);
//! # Ok::<(), brdf_search::SearchError>(())
//! ```

mod error;
mod family;
mod greedy;
mod joint;
mod line_search;
mod monitor;
mod outcome;
mod powell;
mod random;
mod rotation;
mod starts;
mod tangent;
mod varpro;

pub use error::SearchError;
pub use family::{Family, MAX_TERMS};
pub use greedy::{GreedyParams, Objective, search_greedy};
pub use joint::{JointParams, search_joint};
pub use line_search::{LineParams, LinePoint, minimize_on_line};
pub use outcome::{SearchOutcome, TermOutcome};
pub use powell::{Minimum, PowellParams, minimize_rotation};
pub use rotation::Rotation4;
pub use starts::canonical_projections;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDocTests;
