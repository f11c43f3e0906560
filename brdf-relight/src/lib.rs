//! Precomputed radiance transfer: objects under distant light from everywhere, glossy and with their shadows.
//!
//! A picture of an object under an environment map needs, at every point, the integral of light times BRDF times
//! visibility. This crate computes the parts that do not change once, and the rest in milliseconds:
//!
//! 1. [`factor_for_relighting`] writes the BRDF as a sum of products, f(wi, wo) ≈ Σ_k g_k(wi) h_k(wo). [`BrdfMaps`] holds
//!    the light maps g_k and the view maps h_k.
//! 2. [`Precomputation`] looks at the sky from each vertex of a [`Surface`] and stores, for each term k, visibility times
//!    cosine times g_k over a cube map: the [`Transport`]. It is kept in a Haar wavelet basis, either the largest
//!    coefficients of each vertex or components that neighbouring vertices share ([`Codec`]).
//! 3. [`CubeLightSampler`] turns an environment map into a [`CubeLight`], of which a few hundred wavelet coefficients are
//!    enough. [`RelitScene::relight`] multiplies them with the transport: this is the cost of new light.
//! 4. [`render`] draws the triangles and sums the terms with h_k: this is the cost of a new view.
//!
//! [`ObjectPrecomputation`] does the first two steps for a mesh and its ground, piece by piece, so that an interrupted run
//! can go on. [`compare()`] measures what each step loses, against brute force ([`exact_part`]).
//!
//! Source: R. Wang, J. Tran and D. Luebke, *All-Frequency Relighting of Non-Diffuse Objects using Separable BRDF
//! Approximation*, Eurographics Symposium on Rendering 2004.
//!
//! ```
//! use brdf_mesh::{Camera, Mesh, Soup};
//! use brdf_relight::{
//!     BrdfMaps, CubeLight, LightRule, Part, RelitScene, RenderParams, SparseTransport, SparseVectors,
//!     Surface, Transport, render,
//! };
//! use glam::DVec3;
//!
//! // Transport would come from a `Precomputation`; here every vertex is black.
//! let (torus, _) = Mesh::new(Soup::torus())?;
//! let surface = Surface::of(&torus);
//! let black = SparseVectors { largest: vec![0.0], counts: vec![0], ..SparseVectors::default() };
//! let coding = brdf_relight::Coding::Scalar;
//! let sparse = SparseTransport::of(coding, &vec![&black; surface.positions.len()]);
//! let parts = [Part::with_transport(surface, BrdfMaps::diffuse(0.5), Transport::Wavelets(sparse))?];
//!
//! let mut scene = RelitScene::default();
//! scene.relight(&parts, &CubeLight::uniform([1.0; 3]).coefficients(LightRule::Energy));
//! let camera = Camera::around(DVec3::ZERO, torus.radius(), DVec3::new(0.0, 0.6, 0.8));
//! let (picture, negative) = render(&parts, &scene, &RenderParams { camera, size: 32, points: 1 });
//! assert_eq!((picture.width(), negative), (32, 0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod chunk;
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
mod stored;
mod surface;
mod sweep;
mod transport;
mod turntable;
mod visibility;

pub use chunk::{Chunk, SparseVectors};
pub use clustered::ClusteredTransport;
pub use coefficients::{Coding, Selection};
pub use compare::{CompareParams, ErrorBreakdown, compare};
pub use error::RelightError;
pub use exact::{ExactParams, exact_part};
pub use factor::{LightMaps, MapParams, factor_for_relighting};
pub use frame::tangent_frame;
pub use light::{CubeLight, CubeLightSampler, LightRule, LitCoefficients};
pub use maps::{BrdfMaps, MapStack};
pub use object::{
    ObjectParams, ObjectPrecomputation, PrecomputeReport, PrecomputeRun, RelightRecord,
};
pub use orbit::Orbit;
pub use precompute::{Codec, Precomputation, PrecomputeParams};
pub use raster::{RenderParams, render};
pub use ray_packet::{Occluder, TILE, Tile};
pub use scene::{Part, RelitScene};
pub use speed::{Speed, SpeedParams, SpeedReport, measure_speed};
pub use store::{Codes, SparseTransport, VERTEX_BLOCK};
pub use stored::Transport;
pub use surface::{ShadingPoint, Surface};
pub use sweep::{Sweep, SweepParams, SweepReport, SweptNumbers, Vary, sweep};
pub use transport::{CubeDirections, TransportWorkspace};
pub use turntable::{Turn, TurntableParams, TurntableReport, turntable};
pub use visibility::{Quality, Visibility};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDocTests;
