//! Which parametrization fits a material: slices of its isotropic part and the isolines in them,
//! and the errors of representations that are built on it, all measured on the same pairs.
//!
//! The question is that of Barla, Belcour and Pacanowski 2015, who left it to the eye.
//!
//! ```
//! use brdf_model::Preset;
//! use brdf_study::{StudyParams, best, study_material};
//!
//! let plastic = Preset::find("plastic").expect("a preset").brdf();
//! let params = StudyParams { pairs: 4_000, ..StudyParams::default() };
//! let rows = study_material(&plastic, &params).expect("a material with data");
//! assert_eq!(rows.len(), 5, "one row for each parametrization");
//! # let _ = best(&rows, |row| row.resampled);
//! ```

mod functions;
mod grid;
mod measure;
mod report;
mod slice;

pub use functions::TestFunction;
pub use measure::{Bivariate, ParametrizationRow, StudyParams, best, study_material};
pub use report::{GlossGroup, Medians, StudiedMaterial, StudyReport, Wins};
pub use slice::{Slice, SliceAlignment, alignment};

use brdf_param::Parametrization;

/// The parametrizations that are compared. Onion slices are made for textures and are left out.
pub const STUDIED: [Parametrization; 5] = [
    Parametrization::Standard,
    Parametrization::HalfDifference,
    Parametrization::KautzMcCool,
    Parametrization::Orthographic,
    Parametrization::Hybrid,
];
