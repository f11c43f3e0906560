//! BRDFs and material maps from pictures of an object, painted or photographed.
//!
//! A pixel that shows a surface under a known light is a sample of its reflectance. From enough of them this crate fits a
//! BRDF, a BRDF times a factor over the surface, or a material map: a sum of BRDFs weighted by maps over the surface.
//!
//! 1. A [`PaintView`] says where camera and light stand; [`vertex_views`] gives twelve around a mesh.
//! 2. [`ViewBuffers`] holds what each pixel of a view shows: normal, directions to light and camera, texture coordinates.
//!    [`prepare`] makes it for all views, with grey guides to paint over ([`pictures::guide`]).
//! 3. [`PaintSamples`] collects reflectance from the painted pixels of a [`PaintedImage`].
//! 4. [`extract()`] fits a [`PaintedMaterial`]. [`learn()`] does steps 3 and 4 and judges the result by pictures that were
//!    held out.
//!
//! [`GroundTruth`] is a material whose value is known everywhere; pictures of it stand in for paintings in tests.
//!
//! Source: L. Jaroszkiewicz and M. McCool, *Fast Extraction of BRDFs and Material Maps from Images*, Graphics Interface
//! 2003, sections 4 and 5.
//!
//! ```
//! use brdf_job::Job;
//! use brdf_mesh::{Mesh, Soup};
//! use brdf_model::Preset;
//! use brdf_paint::{
//!     GroundTruth, Mode, PaintParams, PaintSamples, ViewBuffers, extract, vertex_views,
//! };
//!
//! let (torus, _) = Mesh::new(Soup::torus())?;
//! let clay = Preset::find("lafortune-clay").expect("a built-in material").brdf();
//! let truth = GroundTruth { brdfs: [&clay, &clay, &clay], scale: 1.0 };
//! let mut samples = PaintSamples::new();
//! for (number, view) in vertex_views(&torus).iter().enumerate() {
//!     let buffers = ViewBuffers::of(&torus, view, 24, 24);
//!     samples.add(number, &view.name, &buffers, &truth.paint(&buffers), 0.1)?;
//! }
//! let params = PaintParams { mode: Mode::Brdf, texels: 16, ..PaintParams::default() };
//! let extraction = extract(&samples, &params, &Job::new())?;
//! assert!(extraction.errors.rms < 0.05, "one BRDF explains clay");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod alternating;
mod buffers;
mod coefficient_map;
mod contradictions;
mod error;
mod extract;
mod layout;
mod learn;
mod least_squares;
mod material;
mod paper;
mod params;
pub mod pictures;
mod prepare;
mod samples;
mod truth;
mod view;

pub use buffers::{PixelSurface, ViewBuffers};
pub use coefficient_map::CoefficientMap;
pub use contradictions::Contradictions;
pub use error::PaintError;
pub use extract::{Extraction, extract};
pub use learn::{
    LearnParams, Learned, PaintNote, PaintRecord, PaintReport, PictureInfo, TrainAndHeldOut, learn,
    truth_errors,
};
pub use material::{Clamped, Component, PaintedMaterial};
pub use params::{Mode, PaintLogTransform, PaintParams, SolverChoice};
pub use prepare::{Prepared, PreparedView, SetupReport, prepare};
pub use samples::{PaintErrors, PaintSamples, PaintedImage, Skipped};
pub use truth::{GroundTruth, TruthRecord};
pub use view::{LightSource, PaintView, face_views, spiral_views, vertex_views};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDocTests;
