//! What can be wrong with a file, in one line: where, what was found, what was expected.

use brdf_model::ModelError;

/// A problem with the content of a file: where it is, what was found, and what was expected.
///
/// ```
/// let error = brdf_io::read(b"\x01\x02\x03", &brdf_io::ReadOptions::default()).unwrap_err();
/// assert!(error.to_string().starts_with("unknown format"));
/// ```
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
         UTIA .bin, ALTA text, a table with a header, or an archive of neural BRDFs (.npz)"
    )]
    Unknown {
        /// The first bytes, made printable.
        start: String,
    },
    /// The numbers make no material.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The header of a table does not say what is needed.
    #[error("line {line}: found columns {}; expected {expected}", found.join(", "))]
    Columns {
        /// Where the header stands, counted from 1.
        line: usize,
        /// Its names.
        found: Vec<String>,
        /// What would do.
        expected: String,
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

/// Returns a text in quotes, cut to its first 40 characters so that it fits into a message.
pub fn quoted(text: &str) -> String {
    let mut cut: String = text.chars().take(40).collect();
    if cut.len() < text.len() {
        cut.push('…');
    }
    format!("{cut:?}")
}
