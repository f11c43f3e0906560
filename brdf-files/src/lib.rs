//! Files as programs should treat them: mapped input, output that appears whole or not at all, resumable work.
//!
//! - [`MappedFile`] gives the bytes of a file.
//! - [`write_atomically`] writes one file, [`OutputFolder`] a folder of results. Nothing that other programs wrote is
//!   overwritten unless the caller says so ([`Overwrite`]).
//! - [`ChunkLog`] keeps finished pieces of long work, so that an interrupted run can go on.
//!
//! ```
//! use brdf_files::{MappedFile, Overwrite, write_atomically};
//!
//! # let folder = tempfile::tempdir()?;
//! let path = folder.path().join("table.csv");
//! write_atomically(&path, b"theta_i_deg,phi_i_deg,theta_o_deg,phi_o_deg\n", Overwrite::Ours)?;
//! assert!(MappedFile::open(&path)?.starts_with(b"theta_i_deg"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod atomic;
mod chunk_log;
mod error;
mod mapped;
mod output_folder;

pub use atomic::{Overwrite, check_overwrite, write_atomically};
pub use chunk_log::ChunkLog;
pub use error::FileError;
pub use mapped::MappedFile;
pub use output_folder::OutputFolder;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDocTests;
