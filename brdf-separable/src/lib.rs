//! BRDFs as sums of products: f(wi, wo) ≈ Σ_k g_k(a) h_k(b), where a and b are points of the unit
//! hemisphere that a parametrization makes of a pair of directions.
//!
//! A [`BrdfMatrix`] holds a BRDF sampled on the nodes of two [`HemisphereGrid`]s; [`factorize_matrix`] takes the
//! leading terms of one of several decompositions; a [`SeparableBrdf`] looks them up.
//!
//! ```
//! use brdf_model::{Brdf, Channels, Preset};
//! use brdf_param::{DirectionPair, HemisphereMap, Parametrization};
//! use brdf_separable::*;
//!
//! let plastic = Preset::find("plastic").expect("a preset").brdf();
//! let chart = HemisphereGrid::Plane { map: HemisphereMap::OrthographicDisc, resolution: 16 };
//! let layout = Layout::new(Parametrization::Standard, chart, chart);
//! let matrix = BrdfMatrix::sample(&plastic, &layout, &MatrixParams::default())?;
//! let fit = factorize_matrix(&matrix, &SeparableParams { rank: 9, ..SeparableParams::default() })?;
//! let pair = DirectionPair::from_angles(0.5, 0.0, 0.4, 3.0);
//! let (exact, short) = (plastic.eval(&pair).g, fit.model.eval(&pair).g);
//! assert!((exact - short).abs() < 0.2 * exact, "{short} for {exact}");
//! # Ok::<(), SeparableError>(())
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
