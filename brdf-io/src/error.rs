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
        /// Hint at what may have happened, or empty.
        hint: &'static str,
    },
    /// Something that should start at an offset does not fit into the file.
    #[error("byte {offset}: {what} runs past the end of the file ({length} bytes)")]
    PastEnd {
        /// Offset where it should start, in bytes.
        offset: u64,
        /// Name of the part.
        what: String,
        /// Length of the file.
        length: usize,
    },
    /// A field holds something else than it must.
    #[error("byte {offset}: {what} is {found}; expected {expected}")]
    Field {
        /// Offset of the field, in bytes.
        offset: usize,
        /// Name of the field.
        what: &'static str,
        /// Content found.
        found: String,
        /// Expected content.
        expected: String,
    },
    /// A line of text that cannot be read.
    #[error("line {line}: found {found}; expected {expected}")]
    Line {
        /// Number of the line, counted from 1.
        line: usize,
        /// Content found there.
        found: String,
        /// Expected content.
        expected: String,
    },
    /// The file lacks something.
    #[error("no {what}; expected {expected}")]
    Missing {
        /// Name of the missing part.
        what: String,
        /// Expected content.
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
    #[error("line {line}: found columns {}; expected {expected}", few(found))]
    Columns {
        /// Line of the header, counted from 1.
        line: usize,
        /// Names of its columns.
        found: Vec<String>,
        /// Expected content.
        expected: String,
    },
    /// A column without a meaning tells rows apart, so that several materials would become one.
    #[error("line {line}: column {column:?} tells rows apart; expected a choice: {values}")]
    SeveralMaterials {
        /// Line of the header, counted from 1.
        line: usize,
        /// Name of the column.
        column: String,
        /// What stands in it, as a list.
        values: String,
    },
    /// A file of something else, or of another program.
    #[error("this is {what}; {advice}")]
    Foreign {
        /// What it is.
        what: String,
        /// What to do about it.
        advice: &'static str,
    },
    /// A library refused the content.
    #[error("{what}: {problem}")]
    Library {
        /// Name of what was being read or written.
        what: &'static str,
        /// Message of the library.
        problem: String,
    },
}

/// The first names of a header, each cut, so that they fit into a message.
fn few(names: &[String]) -> String {
    const SHOWN: usize = 12;
    let shown = names.iter().take(SHOWN).map(|name| {
        let cut: String = name.chars().take(24).flat_map(char::escape_debug).collect();
        if name.chars().count() > 24 { format!("{cut}…") } else { cut }
    });
    let list = shown.collect::<Vec<_>>().join(", ");
    match names.len().saturating_sub(SHOWN) {
        0 if names.is_empty() => "without names".to_owned(),
        0 => list,
        more => format!("{list} and {more} more"),
    }
}

/// Returns a text in quotes, cut to its first 40 characters so that it fits into a message.
pub fn quoted(text: &str) -> String {
    let mut cut: String = text.chars().take(40).collect();
    if cut.len() < text.len() {
        cut.push('…');
    }
    format!("{cut:?}")
}
