//! Materials from pictures of an object, painted or photographed.
//!
//! A pixel that shows a surface under a known light is a sample of its reflectance. From enough of them
//! come a BRDF, a product with a factor over the surface, or a material map: a sum of BRDFs weighted by
//! maps over the surface.
//!
//! Source: Jaroszkiewicz and McCool 2003, sections 4 and 5.
//!
//! [`PaintView`]s say where camera and light stand, [`ViewBuffers`] what each pixel shows, [`PaintSamples`]
//! what was painted there, and [`extract`] makes a [`PaintedMaterial`].

mod alternating;
mod buffers;
mod coefficient_map;
mod contradictions;
mod error;
mod extract;
mod learn;
mod least_squares;
mod material;
mod paper;
pub mod pictures;
mod prepare;
mod samples;
mod truth;
mod view;

pub use buffers::{PixelSurface, ViewBuffers};
pub use coefficient_map::CoefficientMap;
pub use contradictions::Contradictions;
pub use error::PaintError;
pub use extract::{Extraction, Mode, PaintLogTransform, PaintParams, SolverChoice, extract};
pub use learn::{
    LearnParams, Learned, PaintNote, PaintRecord, PaintReport, PictureInfo, TrainAndHeldOut,
    TruthRecord, learn, truth_errors,
};
pub use material::{Clamped, Component, PaintedMaterial};
pub use prepare::{Prepared, PreparedView, prepare};
pub use samples::{PaintErrors, PaintSamples, PaintedImage, Skipped};
pub use truth::GroundTruth;
pub use view::{LightSource, PaintView, face_views, spiral_views, vertex_views};
