//! Files as programs of this project treat them: input is mapped, output appears whole or not at all, and
//! nothing that others wrote is overwritten unasked.
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
