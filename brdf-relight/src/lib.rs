//! Relighting of objects under distant light from everywhere, shadows included, with separable BRDFs.
//!
//! A BRDF f ≈ Σ_k g_k(wi) h_k(wo) takes the view out of the integral over light: for each vertex and term,
//! what arrives is a product of the sky with a vector that depends on the object alone. These vectors, in a wavelet basis
//! and cut to their largest coefficients or to components that vertices share, are precomputed; a change of light is a sparse product, a change of view a lookup.
//!
//! Source: Wang, Tran and Luebke 2004.
//!
//! [`factor_for_relighting`] makes [`BrdfMaps`] of a BRDF, [`Precomputation`] the [`Transport`] of a [`Surface`],
//! a [`LightSampler`] the [`CubeLight`] of an environment, and [`picture`] a picture.

mod bundle;
mod clustered;
mod coefficients;
mod compare;
mod components;
pub mod cube;
mod error;
mod exact;
mod factor;
mod frame;
mod grouping;
pub mod haar;
mod light;
mod maps;
mod precompute;
mod raster;
mod scene;
mod store;
mod surface;
mod transport;
mod visibility;

pub use bundle::{Occluder, TILE, Tile};
pub use clustered::ClusteredTransport;
pub use coefficients::{Coding, Selection};
pub use compare::{CompareParams, Split, compare};
pub use error::RelightError;
pub use exact::exact_part;
pub use factor::{LightMaps, MapParams, factor_for_relighting};
pub use frame::tangent_frame;
pub use light::{CubeLight, LightRule, LightSampler, LitCoefficients};
pub use maps::{BrdfMaps, MapStack};
pub use precompute::{Chunk, Codec, Precomputation, PrecomputeParams};
pub use raster::{Shot, picture};
pub use scene::{Part, RelitScene};
pub use store::{BLOCK, Codes, SparseTransport, Transport};
pub use surface::Surface;
pub use transport::{Site, Sky, SparseVectors, Workspace};
pub use visibility::{Quality, Visibility};
