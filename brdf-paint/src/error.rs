//! What can go wrong.

use brdf_factor::FactorError;

/// A problem with pictures, views or options from which no material can be made.
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
        /// Rows of the picture.
        found_height: usize,
        /// Pixels in a row of the buffers.
        width: usize,
        /// Rows of the view.
        height: usize,
    },
    /// Nothing painted.
    #[error("no painted pixel shows the object lit from above its surface: {skipped}")]
    NothingPainted {
        /// Counts of what was skipped, by reason.
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
        /// Name of the option.
        option: &'static str,
        /// The value asked for.
        value: f64,
        /// Expected content.
        expected: &'static str,
    },
    /// The factorization.
    #[error(transparent)]
    Factor(#[from] FactorError),
    /// A view that does not show the object.
    #[error("view {view}: the object is not in the picture")]
    NotInView {
        /// Name of the view.
        view: String,
    },
    /// The work was stopped.
    #[error(transparent)]
    Stopped(#[from] brdf_job::Stopped),
}
