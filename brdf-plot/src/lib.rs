//! Plots of BRDFs as SVG and PNG, with axes, units and legends, readable in greyscale: slices and
//! their isolines, polar and three-dimensional lobes, curves, textures, coverage.
//!
//! ```
//! use brdf_plot::{Curves, Scale, Series, plot_curves};
//!
//! let errors = Curves {
//!     title: "error against rank".to_owned(),
//!     x: "terms".to_owned(),
//!     y: "RMS".to_owned(),
//!     y_scale: Scale::Log,
//!     series: vec![Series::new("training", vec![(1.0, 0.2), (2.0, 0.05)])],
//!     ..Curves::default()
//! };
//! let plot = plot_curves(&[errors], 1)?;
//! assert!(plot.svg().starts_with("<svg"));
//! # Ok::<(), brdf_plot::PlotError>(())
//! ```

mod colours;
mod coverage;
mod curves;
mod heat;
mod lobe;
mod parametrizations;
mod plot;
mod polar;
mod slices;
mod textures;

pub use coverage::plot_coverage;
pub use curves::{Curves, Scale, Series, plot_curves};
pub use heat::{Contours, Field, Heat, HeatScale, plot_heat};
pub use lobe::plot_lobes;
pub use parametrizations::{plot_parametrizations, plot_test_functions};
pub use plot::{Plot, PlotError};
pub use polar::plot_polar;
pub use slices::plot_slices;
pub use textures::plot_textures;
