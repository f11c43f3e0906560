//! Plots of BRDFs as SVG and PNG, with axes, units and legends, readable in greyscale.
//!
//! - [`plot_slices`] and [`plot_parametrizations`] show luminance over two coordinates.
//! - [`plot_coordinate_hemispheres`], [`plot_test_function_hemispheres`] and [`plot_luminance_hemispheres`] show the
//!   hemisphere of lights over one viewer.
//! - [`plot_polar`] and [`plot_lobes`] show lobes, in the plane of incidence and in three dimensions.
//! - [`plot_coverage`] shows where a measured material has data.
//! - [`plot_curves`], [`plot_log_log`], [`plot_heat`] and [`plot_textures`] take values of any kind.
//!
//! Each returns a [`Plot`], which gives the SVG as text and, with the feature `raster`, a PNG as bytes.
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

mod axis;
mod colours;
mod coverage;
mod curves;
mod error;
mod heat;
mod hemispheres;
mod lobe;
mod log_log;
mod parametrizations;
mod plot;
mod polar;
#[cfg(feature = "raster")]
mod raster;
mod slices;
mod textures;

pub use coverage::plot_coverage;
pub use curves::{Curves, Scale, Series, plot_curves};
pub use error::PlotError;
pub use heat::{Contours, Field, Heat, HeatScale, plot_heat};
pub use hemispheres::{
    plot_coordinate_hemispheres, plot_luminance_hemispheres, plot_test_function_hemispheres,
};
pub use lobe::plot_lobes;
pub use log_log::plot_log_log;
pub use parametrizations::{plot_parametrizations, plot_test_functions};
pub use plot::Plot;
pub use polar::plot_polar;
pub use slices::plot_slices;
pub use textures::plot_textures;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDocTests;
