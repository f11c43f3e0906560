//! What can go wrong with a plot.

/// A problem with a plot: there is nothing to show, or the drawing library refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PlotError {
    /// There is nothing to show.
    #[error("nothing to plot: {what}")]
    Nothing {
        /// Name of the missing part.
        what: &'static str,
    },
    /// Pictures are asked of a build that draws SVG alone.
    #[error("no PNG in this build: brdf-plot lacks its feature `raster`")]
    NoRaster,
    /// The drawing library refused.
    #[error("drawing: {problem}")]
    Drawing {
        /// Message of the library.
        problem: String,
    },
}

pub(crate) fn drawing(problem: &dyn std::fmt::Display) -> PlotError {
    PlotError::Drawing { problem: problem.to_string() }
}
