//! BRDFs as sums of products: f(wi, wo) ≈ Σ_k g_k(a) h_k(b).
//!
//! A parametrization turns a pair of directions into two points a and b of the unit hemisphere, such as
//! wi and wo, or half and difference vector. The g_k and h_k are textures over these points.
//!
//! - A [`HemisphereGrid`] lays texels over one point; a [`Layout`] is two grids and a parametrization.
//! - [`BrdfMatrix::sample`] samples a BRDF on a layout: one row for each node of the first grid, one
//!   column for each node of the second.
//! - [`factorize_matrix`] decomposes the matrix (singular values, eigenpairs, non-negative factors or the
//!   normalized decomposition) and keeps the leading terms.
//! - The result holds a [`SeparableBrdf`], which is a [`Brdf`](brdf_model::Brdf) again.
//! - [`top_eigenpairs`] and [`top_singular_triplets`] do the same for any matrix.
//!
//! # Example
//!
//! ```
//! use brdf_job::Job;
//! use brdf_model::{Brdf, Preset};
//! use brdf_param::{DirectionPair, HemisphereMap, Parametrization};
//! use brdf_separable::{
//!     BrdfMatrix, HemisphereGrid, Layout, MatrixParams, SeparableParams, factorize_matrix,
//! };
//!
//! let plastic = Preset::find("plastic").expect("a preset").brdf();
//! let grid = HemisphereGrid::Plane { map: HemisphereMap::OrthographicDisc, resolution: 16 };
//! let layout = Layout::new(Parametrization::Standard, grid, grid);
//! let matrix = BrdfMatrix::sample(&plastic, &layout, &MatrixParams::default())?;
//! let params = SeparableParams { rank: 9, ..SeparableParams::default() };
//! let fit = factorize_matrix(&matrix, &params, &Job::new())?;
//! let pair = DirectionPair::from_angles(0.5, 0.0, 0.4, 3.0);
//! let (exact, short) = (plastic.eval(&pair).g, fit.model.eval(&pair).g);
//! assert!((exact - short).abs() < 0.2 * exact, "{short} for {exact}");
//! # Ok::<(), brdf_separable::SeparableError>(())
//! ```
//!
//! Sources: Kautz and McCool 1999; Wang, Tran and Luebke 2004, section 3.2.

mod error;
mod factorize;
mod hemisphere_grid;
mod krylov;
mod layout;
mod matrix;
mod model;
mod nonnegative;
mod normalized;
mod power;
mod product;
mod rank_error;
mod value_transform;

pub use error::SeparableError;
pub use factorize::{
    ChannelSpectrum, Decomposition, EigenSolver, SeparableFit, SeparableParams, factorize_matrix,
};
pub use hemisphere_grid::{HemisphereGrid, Node};
pub use krylov::{KrylovParams, TopPairs, top_eigenpairs, top_singular_triplets};
pub use layout::Layout;
pub use matrix::{BrdfMatrix, CellCounts, Fill, MatrixParams, RankError};
pub use model::{SecondSide, SeparableBrdf};
pub use nonnegative::{NonnegativeParams, nonnegative_factors};
pub use power::{PowerPair, power_iteration};
pub use rank_error::{RankCosineRms, cosine_rms_by_rank};
pub use value_transform::ValueTransform;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDocTests;
