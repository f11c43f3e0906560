//! What can be wrong with a file of this project.

use brdf_factor::FactorError;
use brdf_image::ImageError;
use brdf_io::FormatError;
use brdf_model::ModelError;
use brdf_paint::PaintError;
use brdf_param::ParamError;
use brdf_separable::SeparableError;
use brdf_spline::SplineError;
use btf_vq::VqError;

use crate::kind::Kind;

/// A problem with the content of a container, a scene or a list of projections.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ContainerError {
    /// The file lacks something.
    #[error("no {what}; expected {expected}")]
    Missing {
        /// What is missing.
        what: String,
        /// What would do.
        expected: String,
    },
    /// A container of another kind.
    #[error("found {}; expected {}", found.name(), expected.name())]
    Kind {
        /// What it holds.
        found: Kind,
        /// What was asked for.
        expected: Kind,
    },
    /// A container that is no BRDF.
    #[error("no BRDF: this is {}", found.name())]
    NoBrdf {
        /// What it holds.
        found: Kind,
    },
    /// A record of another version.
    #[error("version {found}; expected version {expected}, the one that this program reads")]
    Version {
        /// That of the record.
        found: u32,
        /// The one that can be read.
        expected: u32,
    },
    /// A library refused the content.
    #[error("{what}: {problem}")]
    Library {
        /// What was being read or written.
        what: &'static str,
        /// What the library said.
        problem: String,
    },
    /// A measured file that cannot be read, or bytes that end too early.
    #[error(transparent)]
    Format(#[from] FormatError),
    /// A picture that cannot be read or written.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// The numbers make no painted material, or no scene.
    #[error(transparent)]
    Paint(#[from] PaintError),
    /// The numbers make no material.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The numbers make no factored model.
    #[error(transparent)]
    Factor(#[from] FactorError),
    /// The numbers make no sum of products.
    #[error(transparent)]
    Separable(#[from] SeparableError),
    /// The stream makes no sum of splines.
    #[error(transparent)]
    Spline(#[from] SplineError),
    /// The codebooks make no texture.
    #[error(transparent)]
    Btf(#[from] VqError),
    /// The numbers make no projection.
    #[error("projection {index}: {problem}")]
    Projection {
        /// Counted from 1.
        index: usize,
        /// What is wrong with it.
        problem: ParamError,
    },
}
