//! What can be wrong with a file, in one line: where, what was found, what was expected.

use std::path::{Path, PathBuf};

use brdf_factor::FactorError;
use brdf_model::ModelError;
use brdf_paint::PaintError;
use brdf_param::ParamError;
use brdf_render::MeshError;
use brdf_separable::SeparableError;

use crate::btf::BtfError;

/// A problem with the content of a file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FormatError {
    /// The file ends too early, or goes on too long.
    #[error("found {found} bytes; expected {expected}{hint}")]
    Size {
        /// Bytes that are there.
        found: usize,
        /// Bytes that should be.
        expected: usize,
        /// What may have happened, or empty.
        hint: &'static str,
    },
    /// Something that should start at an offset does not fit into the file.
    #[error("byte {offset}: {what} runs past the end of the file ({length} bytes)")]
    PastEnd {
        /// Where it starts.
        offset: u64,
        /// What it is.
        what: String,
        /// Length of the file.
        length: usize,
    },
    /// A field holds something else than it must.
    #[error("byte {offset}: {what} is {found}; expected {expected}")]
    Field {
        /// Where it is.
        offset: usize,
        /// What it is.
        what: &'static str,
        /// What it holds.
        found: String,
        /// What would do.
        expected: String,
    },
    /// A line of text that cannot be read.
    #[error("line {line}: found {found}; expected {expected}")]
    Line {
        /// Counted from 1.
        line: usize,
        /// What stands there.
        found: String,
        /// What would do.
        expected: String,
    },
    /// The file lacks something.
    #[error("no {what}; expected {expected}")]
    Missing {
        /// What is missing.
        what: String,
        /// What would do.
        expected: String,
    },
    /// No reader knows the content.
    #[error(
        "unknown format (starts with {start}); expected MERL .binary, RGL .bsdf, Cornell .brdf, \
         UTIA .bin, ALTA text, a table with a header, an archive of neural BRDFs (.npz), or a container \
         written by brdf"
    )]
    Unknown {
        /// The first bytes, made printable.
        start: String,
    },
    /// The numbers make no painted material, or no scene.
    #[error(transparent)]
    Paint(#[from] PaintError),
    /// The triangles make no mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The numbers make no material.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The numbers make no factored model.
    #[error(transparent)]
    Factor(#[from] FactorError),
    /// The numbers make no sum of products.
    #[error(transparent)]
    Separable(#[from] SeparableError),
    /// The books make no texture.
    #[error(transparent)]
    Btf(#[from] btf_vq::VqError),
    /// The numbers make no projection.
    #[error("projection {index}: {problem}")]
    Projection {
        /// Counted from 1.
        index: usize,
        /// What is wrong with it.
        problem: ParamError,
    },
    /// A library refused the content.
    #[error("{what}: {problem}")]
    Library {
        /// What was being read or written.
        what: &'static str,
        /// What the library said.
        problem: String,
    },
}

/// A problem with a file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum IoError {
    /// The file system refused.
    #[error("{}: {action}: {problem}", path.display())]
    File {
        /// Which file.
        path: PathBuf,
        /// What was attempted.
        action: &'static str,
        /// What the system said.
        problem: std::io::Error,
    },
    /// A folder stands where a file was expected.
    #[error("{}: found a folder; expected a file", path.display())]
    Folder {
        /// Which one.
        path: PathBuf,
    },
    /// A file stands where a folder should go.
    #[error("{}: found a file; expected a folder, or nothing", path.display())]
    NotAFolder {
        /// Where.
        path: PathBuf,
    },
    /// The output folder is the one that the program runs in, which cannot be replaced whole.
    #[error("{}: this is the current folder; name a new one, such as ./out", path.display())]
    CurrentFolder {
        /// Where.
        path: PathBuf,
    },
    /// Something stands where output should go.
    #[error(
        "{}: found {found} that brdf did not write; choose another place or pass --force",
        path.display()
    )]
    InTheWay {
        /// Where.
        path: PathBuf,
        /// What stands there.
        found: &'static str,
    },
    /// The disk has too little room.
    #[error(
        "{}: {} MB are free on the disk; about {} MB are needed",
        path.display(), available / 1_000_000, needed / 1_000_000
    )]
    DiskFull {
        /// What was to be written.
        path: PathBuf,
        /// Bytes that it takes.
        needed: u64,
        /// Bytes that are free.
        available: u64,
    },
    /// The content is wrong.
    #[error("{}: {problem}", path.display())]
    Format {
        /// Which file.
        path: PathBuf,
        /// What is wrong with it.
        problem: FormatError,
    },
    /// A bidirectional texture function cannot be read.
    #[error("{}: {problem}", path.display())]
    Btf {
        /// Which folder, archive or file.
        path: PathBuf,
        /// What is wrong with it.
        problem: Box<BtfError>,
    },
}

impl IoError {
    pub(crate) fn btf(path: &Path) -> impl FnOnce(BtfError) -> Self {
        let path = path.to_owned();
        move |problem| Self::Btf { path, problem: Box::new(problem) }
    }

    pub(crate) fn file(path: &Path, action: &'static str) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.to_owned();
        move |problem| Self::File { path, action, problem }
    }

    /// Adds the path to a problem with the content.
    pub fn format(path: &Path) -> impl FnOnce(FormatError) -> Self {
        let path = path.to_owned();
        move |problem| Self::Format { path, problem }
    }
}

/// A text cut to a length that fits into a message, in quotes.
pub(crate) fn quoted(text: &str) -> String {
    let mut cut: String = text.chars().take(40).collect();
    if cut.len() < text.len() {
        cut.push('…');
    }
    format!("{cut:?}")
}
