//! What can go wrong when a report is put together.

use brdf_factor::FactorError;
use brdf_image::ImageError;
use brdf_plot::PlotError;

/// A report that cannot be put together.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// A picture that cannot be encoded.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// A figure that cannot be drawn.
    #[error(transparent)]
    Plot(#[from] PlotError),
    /// A model that is not whole.
    #[error(transparent)]
    Factor(#[from] FactorError),
    /// A record that is no JSON.
    #[error("report: {0}")]
    Json(#[from] serde_json::Error),
}
