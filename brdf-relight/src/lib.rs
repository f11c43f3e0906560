//! Relighting of objects under distant light from everywhere, shadows included, with separable BRDFs.
//!
//! A BRDF f ≈ Σ_k g_k(wi) h_k(wo) takes the view out of the integral over light: for each vertex and term,
//! what arrives is a product of the sky with a vector that depends on the object alone. These vectors, in a wavelet basis
//! and cut to their largest coefficients or to components that vertices share, are precomputed; a change of light is a sparse product, a change of view a lookup.
//!
//! Source: Wang, Tran and Luebke 2004.
//!
//! [`factor_for_relighting`] makes [`BrdfMaps`] of a BRDF, [`Precomputation`] the [`Transport`] of a [`Surface`],
//! a [`CubeLightSampler`] the [`CubeLight`] of an environment, and [`render`] a picture.

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
mod object;
mod orbit;
mod precompute;
mod raster;
mod ray_packet;
mod scene;
mod speed;
mod store;
mod surface;
mod sweep;
mod transport;
mod visibility;

pub use clustered::ClusteredTransport;
pub use coefficients::{Coding, Selection};
pub use compare::{CompareParams, ErrorBreakdown, compare};
pub use error::RelightError;
pub use exact::exact_part;
pub use factor::{LightMaps, MapParams, factor_for_relighting};
pub use frame::tangent_frame;
pub use light::{CubeLight, CubeLightSampler, LightRule, LitCoefficients};
pub use maps::{BrdfMaps, MapStack};
pub use object::{ObjectParams, ObjectPrecomputation, RelightRecord};
pub use orbit::Orbit;
pub use precompute::{Chunk, Codec, Precomputation, PrecomputeParams};
pub use raster::{RenderParams, render};
pub use ray_packet::{Occluder, TILE, Tile};
pub use scene::{Part, RelitScene};
pub use speed::{Speed, SpeedParams, measure_speed};
pub use store::{Codes, SparseTransport, Transport, VERTEX_BLOCK};
pub use surface::Surface;
pub use sweep::{Sweep, Vary, sweep};
pub use transport::{CubeDirections, ShadingPoint, SparseVectors, TransportWorkspace};
pub use visibility::{Quality, Visibility};
