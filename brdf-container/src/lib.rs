//! The native file of the project, and materials opened whatever their format.
//!
//! A container is safetensors with one JSON record under the metadata key `brdf`.
//!
//! A factored model: tensors `factor0`, `factor1` … hold log texels in f32: `[v, u, channel]` for two-dimensional
//! factors, `[x, channel]` for one-dimensional ones; the record says how coordinates reach texels,
//! and holds the log maps, the options and the errors of the fit. No time, path or thread count, so
//! that equal runs give equal bytes. The best models of fewer textures follow as `of1.factor0`,
//! `of2.factor0`, `of2.factor1` …
//!
//! A sum of products: `first` and `second`, f32 `[row, column, term, channel]` over the texels of
//! their hemisphere grids, `first` with one channel where its textures are scalar; where both sides share
//! textures, `signs`, f32 `[term, channel]`, in place of `second`.
//!
//! A painted material: tensors `product0.factor0` … of the factors of each product, as of a factored model,
//! `product0.surface`, `[v, u, channel]`, and `map0`, `[v, u]`, where it has them, all f32.
//!
//! A preinverted matrix: `cholesky`, f64 `[column, row]`, or `vectors`, f64 `[component, unknown]`, and `weights`.
//!
//! Transport of an object: for each part `part0.positions`, `part0.normals` (f32), `part0.triangles` (u32), `part0.light` and
//! `part0.view`, f32 `[row, column, value]`, and the arrays of [`brdf_relight::SparseTransport`]: `part0.scales` (f32),
//! `part0.offsets` (u32), `part0.owners` (u16) and `part0.codes` (u32, or u16 where light maps are scalar).
//!
//! A compressed BTF: packed books as tensors of bytes.
//!
//! A MERL-grid table: one tensor `cells`, f32 `[theta_h, theta_d, phi_d, channel]`, negative where
//! invalid. Scattered samples: `directions`, f64 `[sample, 6]` (wi, then wo), and `values`, f64
//! `[sample, channel]`.
//!
//! ```
//! use brdf_container::{MaterialFile, read_factored, write_factored};
//! use brdf_fit::{FactoredMethod, FactoredSettings, fit_factored};
//! use brdf_io::ReadOptions;
//! use brdf_job::Job;
//!
//! let paint = MaterialFile::open("preset:lafortune-blue-paint", &ReadOptions::default())?;
//! let settings = FactoredSettings { samples: 2_000, ..FactoredSettings::of(FactoredMethod::Radial) };
//! let fit = fit_factored(&paint.material(), &settings, &Job::new())?;
//! let bytes = write_factored(&fit.model())?;
//! assert_eq!(read_factored(&bytes)?, fit.model());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod basis;
mod btf;
mod btf_report;
mod compact;
mod contained;
mod convert;
mod coordinates;
mod error;
mod evaluate;
mod factored;
mod folders;
mod head;
mod info;
mod kind;
mod mesh_file;
mod open;
mod painted;
mod piece_log;
mod projections;
mod relight;
mod scene;
mod scene_folder;
mod separable;
mod table;

pub use basis::{read_basis, write_basis};
pub use btf::{CompressedBtf, open_compressed_btf, read_btf, write_btf};
pub use btf_report::{
    BookSizes, BrdfComparison, CompressReport, CompressedBtfInfo, TextureComparison, TextureSummary,
};
pub use compact::write_compact;
pub use contained::{Contained, read_container};
pub use convert::{Converted, Tabulated};
pub use coordinates::read_coordinates;
pub use error::ContainerError;
pub use evaluate::Evaluated;
pub use factored::{factored_record, read_factored, write_factored};
pub use folders::{FolderError, compare_folders};
pub use head::{kind_of, looks_like_container};
pub use info::MaterialInfo;
pub use kind::Kind;
pub use mesh_file::{TORUS, open_mesh};
pub use open::{Content, MaterialFile, OpenError, PRESET};
pub use painted::{PaintedFile, read_painted, write_painted};
pub use piece_log::{PieceError, PieceLog};
pub use projections::{ProjectionFile, read_projection_source, read_projections};
pub use relight::{RelightFile, read_piece, read_relight, write_piece, write_relight};
pub use scene::{
    PaintScene, read_buffers, read_painting, read_scene, read_views, write_buffers, write_painting,
    write_scene,
};
pub use scene_folder::{Painting, Paintings, SceneError, SceneFolder, SceneSetup};
pub use separable::write_separable;
pub use table::{write_samples, write_table};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDocTests;

#[cfg(doctest)]
#[doc = include_str!("../../docs/library.md")]
struct LibraryGuide;
