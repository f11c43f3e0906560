//! What can be wrong with a file, in one line: which file, and what.

use std::error::Error;
use std::path::{Path, PathBuf};

/// A problem with a file or folder: which one, and what.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    /// The file system refused.
    #[error("{}: {action}: {problem}", path.display())]
    File {
        /// Path of the file.
        path: PathBuf,
        /// Action that was attempted.
        action: &'static str,
        /// Error of the file system.
        problem: std::io::Error,
    },
    /// A folder stands where a file was expected.
    #[error("{}: found a folder; expected a file", path.display())]
    Folder {
        /// Path of the folder.
        path: PathBuf,
    },
    /// A file stands where a folder should go.
    #[error("{}: found a file; expected a folder, or nothing", path.display())]
    NotAFolder {
        /// Path of the place.
        path: PathBuf,
    },
    /// The output folder is the one that the program runs in, which cannot be replaced whole.
    #[error("{}: this is the current folder; name a new one, such as ./out", path.display())]
    CurrentFolder {
        /// Path of the place.
        path: PathBuf,
    },
    /// Something stands where output should go.
    #[error("{}: found {found} that brdf did not write; choose another place", path.display())]
    InTheWay {
        /// Path of the place.
        path: PathBuf,
        /// Content found there.
        found: &'static str,
    },
    /// The disk has too little room.
    #[error(
        "{}: {} MB are free on the disk; about {} MB are needed",
        path.display(), available / 1_000_000, needed / 1_000_000
    )]
    DiskFull {
        /// Path of what was to be written.
        path: PathBuf,
        /// Bytes that it takes.
        needed: u64,
        /// Bytes that are free.
        available: u64,
    },
    /// The content is wrong.
    #[error("{}: {problem}", path.display())]
    Content {
        /// Path of the file.
        path: PathBuf,
        /// Error of the reader: what is wrong with the content.
        problem: Box<dyn Error + Send + Sync>,
    },
}

impl FileError {
    /// Returns a function that adds a path and an action to an error of the file system, for `map_err`.
    pub fn file(path: &Path, action: &'static str) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.to_owned();
        move |problem| Self::File { path, action, problem }
    }

    /// Returns a function that adds a path to an error of a reader, for `map_err`.
    pub fn content<E: Into<Box<dyn Error + Send + Sync>>>(path: &Path) -> impl FnOnce(E) -> Self {
        let path = path.to_owned();
        move |problem| Self::Content { path, problem: problem.into() }
    }
}
