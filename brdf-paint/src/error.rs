//! What can go wrong.

use brdf_factor::FactorError;

/// Errors of this crate.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PaintError {
    /// A picture of another size than its buffers.
    #[error(
        "view {view}: {found_width} × {found_height} pixels; expected {width} × {height}, the size of its guide"
    )]
    Size {
        /// Name of the view.
        view: String,
        /// Pixels in a row of the picture.
        found_width: usize,
        /// Its rows.
        found_height: usize,
        /// Pixels in a row of the buffers.
        width: usize,
        /// Their rows.
        height: usize,
    },
    /// Nothing painted.
    #[error("no painted pixel shows the object lit from above its surface: {skipped}")]
    NothingPainted {
        /// What was skipped, and why.
        skipped: String,
    },
    /// A light that cannot light.
    #[error("view {view}: the light stands inside the sphere around the object; move it out")]
    LightInside {
        /// Name of the view.
        view: String,
    },
    /// An option outside its range.
    #[error("{option} is {value}; expected {expected}")]
    Option {
        /// Which option.
        option: &'static str,
        /// The value asked for.
        value: f64,
        /// What would do.
        expected: &'static str,
    },
    /// The factorization.
    #[error(transparent)]
    Factor(#[from] FactorError),
    /// A view that does not show the object.
    #[error("view {view}: the object is not in the picture")]
    NotInView {
        /// Which one.
        view: String,
    },
    /// The work was stopped.
    #[error(transparent)]
    Stopped(#[from] brdf_job::Stopped),
}
