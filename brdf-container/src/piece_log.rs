//! Pieces of a precomputation that outlive an interrupted run.

use std::path::{Path, PathBuf};

use brdf_files::{ChunkLog, FileError};
use brdf_relight::{Chunk, ObjectPrecomputation, RelightError};

use crate::relight::{read_piece, write_piece};

/// A precomputation or its log that failed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PieceError {
    /// The log cannot be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// A piece cannot be made.
    #[error(transparent)]
    Relight(#[from] RelightError),
}

/// What a log found of an earlier run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Earlier {
    /// No log.
    Nothing,
    /// A log of other work, or one that was not asked for.
    Unused,
    /// Pieces of the same work.
    Taken,
}

/// The log of a precomputation, `NAME.part` beside its output: each piece as soon as it is made.
#[derive(Debug)]
pub struct PieceLog {
    path: PathBuf,
    log: ChunkLog,
    earlier: Earlier,
    resumed: usize,
}

impl PieceLog {
    /// Opens the log beside the file `output`. If an earlier run is to be resumed, gives what it made to `work`.
    ///
    /// # Errors
    ///
    /// [`PieceError::File`]; its content for pieces that are not those of the work.
    pub fn open(
        output: &Path,
        resumes: bool,
        work: &mut ObjectPrecomputation,
    ) -> Result<Self, PieceError> {
        let mut name = output.as_os_str().to_owned();
        name.push(".part");
        let path = PathBuf::from(name);
        let (key, was_interrupted) = (work.key(), path.exists());
        let mut resumed = 0;
        let (log, chunks) = match resumes {
            true => ChunkLog::resume(&path, &key)?,
            false => (ChunkLog::create(&path, &key)?, Vec::new()),
        };
        for bytes in &chunks {
            let (piece, chunk) = read_piece(bytes).map_err(FileError::content(&path))?;
            resumed += work.take(piece, chunk).map_err(FileError::content(&path))?;
        }
        let earlier = match (was_interrupted, chunks.is_empty()) {
            (false, _) => Earlier::Nothing,
            (true, true) => Earlier::Unused,
            (true, false) => Earlier::Taken,
        };
        Ok(Self { path, log, earlier, resumed })
    }

    /// Returns what a user should know who did or did not ask to resume, as a sentence.
    pub fn note(&self, resumes: bool) -> Option<String> {
        let path = self.path.display();
        match (resumes, self.earlier) {
            (true, Earlier::Nothing) => Some(format!("{path}: not there; begun anew")),
            (true, Earlier::Unused) => Some(format!("{path}: of other work; begun anew")),
            (false, Earlier::Unused) => {
                Some(format!("{path}: left by an interrupted run; begun anew"))
            }
            (false, Earlier::Nothing) | (_, Earlier::Taken) => None,
        }
    }

    /// Returns the number of vertices that an earlier run did.
    pub fn resumed(&self) -> usize {
        self.resumed
    }

    /// Keeps a piece.
    ///
    /// # Errors
    ///
    /// [`FileError::File`].
    pub fn append(&mut self, piece: usize, chunk: &Chunk) -> Result<(), FileError> {
        self.log.append(&write_piece(piece, chunk))
    }

    /// Removes the log, once the output is whole.
    ///
    /// # Errors
    ///
    /// [`FileError::File`].
    pub fn remove(self) -> Result<(), FileError> {
        self.log.remove()
    }
}
