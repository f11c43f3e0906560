//! A measure of how well each parametrization of BRDFs fits a material.
//!
//! Barla, Belcour and Pacanowski 2015 asked which parametrization suits which material, and judged by
//! looking at slices. Here the answer is measured. For each of the five parametrizations in [`STUDIED`],
//! [`study_material`] returns a [`ParametrizationRow`] with
//!
//! - how well the isolines of slices run along the axes ([`alignment`]),
//! - how much of a table a sum of few products keeps,
//! - the error of the best function of two coordinates, and of the two radii alone,
//! - the error of a table of fixed size.
//!
//! All errors are taken over the same pairs. [`best`] picks a parametrization by any of these figures, and a
//! [`StudyReport`] sums them up over many materials. A [`Slice`] is the table behind a picture of a
//! material, and [`TestFunction`]s are materials for which the answer is known. On the hemisphere of lights over
//! one viewer, [`ring_spread`] says how round isolines are, and [`highlight_centre`] where a highlight lies.
//!
//! # Example
//!
//! ```
//! use brdf_job::Job;
//! use brdf_model::Preset;
//! use brdf_study::{StudyParams, best, study_material};
//!
//! let plastic = Preset::find("plastic").expect("a preset").brdf();
//! let params = StudyParams { pairs: 4_000, ..StudyParams::default() };
//! let rows = study_material(&plastic, &params, &Job::new()).expect("a material with data");
//! assert_eq!(rows.len(), 5, "one row for each parametrization");
//! assert!(best(&rows, |row| row.resampled).is_some());
//! ```

mod functions;
mod grid;
mod hemisphere;
mod measure;
mod report;
mod slice;

pub use functions::TestFunction;
pub use hemisphere::{Centre, Circle, highlight_centre, radial_shares, ring_spread};
pub use measure::{Bivariate, ParametrizationRow, StudyParams, best, study_material};
pub use report::{GlossGroup, Medians, StudiedMaterial, StudyInput, StudyReport, Wins};
pub use slice::{Slice, SliceAlignment, alignment};

use brdf_param::Parametrization;

/// The parametrizations that are compared: all but onion slices, which are made for textures.
pub const STUDIED: [Parametrization; 5] = [
    Parametrization::Standard,
    Parametrization::HalfDifference,
    Parametrization::KautzMcCool,
    Parametrization::Orthographic,
    Parametrization::Hybrid,
];

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDocTests;
