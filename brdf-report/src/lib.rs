//! Reports for people: folders of results with a self-contained page, figures, and notes as sentences.
//!
//! Libraries return numbers and typed notes; this crate turns them into pages, pictures and words. It writes nothing:
//! [`factored_files`], [`separable_files`], [`study_files`], [`paint_files`] and [`sweep_files`] return the files of a
//! folder.

mod btf_text;
mod compact;
mod error;
mod factored;
mod fidelity;
mod figures;
mod files;
mod notes;
mod numbers;
mod page;
mod paint;
mod rates;
mod relight;
#[cfg(feature = "schema")]
mod schema;
mod separable;
mod separable_view;
mod spheres;
mod study;
mod text;
mod texture_view;
mod tried;

pub use btf_text::{
    brdf_comparison_text, breakdown_text, compress_text, facts_text, rate_text, speed_text,
    synth_text, texture_comparison_text,
};
pub use compact::compact_files;
pub use error::ReportError;
pub use factored::{factored_files, kept_files};
pub use figures::{
    error_chart, factored_textures_plot, rank_error_plot, separable_textures_plot, spectrum_plot,
};
pub use files::{ResultFile, sorted_json};
pub use notes::{evaluation_notes, fit_note, paint_note};
pub use numbers::{bytes, or_dash, percent, significant};
pub use paint::{PaintedView, paint_files};
pub use rates::{rate_csv, rate_plot};
pub use relight::{sweep_captions, sweep_files};
#[cfg(feature = "schema")]
pub use schema::schemas;
pub use separable::separable_files;
pub use separable_view::{Side, term_view};
pub use spheres::line_up;
pub use study::study_files;
pub use text::{
    compact_text, comparison_measures, comparison_table, factored_text, folder_comparison_text,
    info_text, kept_text, painted_text, separable_text, study_text,
};
pub use texture_view::{MASKED_OUT, texture_view};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDocTests;
