//! Readers and writers of measured BRDF files: MERL, RGL, UTIA, Cornell, ALTA, tables and neural BRDFs.
//!
//! [`read`] takes the bytes of a file and returns the material. It recognizes the format by the content, because file
//! names don't tell: two databases use `.brdf`, and two use `.bin`. Each format also has a function of its own, such as
//! [`read_merl`], and a Cargo feature of the same name. All features are on by default.
//!
//! No function opens a file. Readers check every count against the bytes that are there before they allocate, so that a
//! damaged file ends in a [`FormatError`] that says where the problem is.
//!
//! ```
//! use brdf_io::{ReadOptions, read};
//! use brdf_model::Brdf;
//! use brdf_param::DirectionPair;
//!
//! let table = "theta_i_deg,phi_i_deg,theta_o_deg,phi_o_deg,value\n30,0,30,180,0.5\n30,0,0,0,0.3\n";
//! let measurement = read(table.as_bytes(), &ReadOptions::default())?;
//! assert_eq!(measurement.format.name(), "table of samples");
//! let mirror = DirectionPair::from_angles(0.52, 0.0, 0.52, std::f64::consts::PI);
//! assert!(measurement.measured.brdf().eval(&mirror).g > 0.4);
//! # Ok::<(), brdf_io::FormatError>(())
//! ```

#[cfg(feature = "alta")]
mod alta;
mod bytes;
#[cfg(feature = "cornell")]
mod cornell;
mod detect;
mod error;
mod foreign;
mod measurement;
#[cfg(feature = "merl")]
mod merl;
#[cfg(feature = "nbrdf")]
mod nbrdf;
mod note;
#[cfg(feature = "rgl")]
mod rgl;
#[cfg(any(feature = "cornell", feature = "table"))]
mod spectrum;
#[cfg(feature = "table")]
mod table;
mod text;
#[cfg(feature = "utia")]
mod utia;

#[cfg(feature = "alta")]
pub use alta::read_alta;
pub use bytes::{Cursor, f32_values, f64_values};
#[cfg(feature = "cornell")]
pub use cornell::{Spectra, read_cornell};
pub use detect::{Format, detect};
pub use error::{FormatError, quoted};
pub use measurement::{Measured, Measurement, ReadOptions, read};
#[cfg(feature = "merl")]
pub use merl::{read_merl, write_merl};
#[cfg(feature = "nbrdf")]
pub use nbrdf::{nbrdf_names, read_nbrdf};
pub use note::ReadNote;
#[cfg(feature = "rgl")]
pub use rgl::read_rgl;
#[cfg(any(feature = "cornell", feature = "table"))]
pub use spectrum::SpectrumToRgb;
#[cfg(feature = "table")]
pub use table::{
    Angle, AngleUnit, Column, ColumnMap, LengthUnit, RowChoice, TableOptions, direction_rows,
    direction_table_header, read_table, write_samples,
};
#[cfg(feature = "utia")]
pub use utia::read_utia;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDocTests;
