//! What can be wrong with the bytes of an image.

/// A problem with an image: its size, its content, or a coder that refused it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// A coder refused.
    #[error("{what}: {problem}")]
    Coder {
        /// Name of the format.
        what: &'static str,
        /// Message of the library.
        problem: String,
    },
    /// No image can have this size.
    #[error("no image of usable size: it has {} × {} pixels; expected 1 to {most} in each direction", size[0], size[1])]
    Sides {
        /// Width and height.
        size: [usize; 2],
        /// Longest side.
        most: usize,
    },
    /// The file is too short for what its header claims.
    #[error("found {found} bytes; expected {expected} or more for the size its header claims")]
    Claim {
        /// Bytes that are there.
        found: usize,
        /// Bytes that there should be at least.
        expected: usize,
    },
    /// A header that cannot be used.
    #[error("no usable {what} header: its {found}; expected {expected}")]
    Header {
        /// Name of the format.
        what: &'static str,
        /// Content found.
        found: String,
        /// Expected content.
        expected: &'static str,
    },
    /// The file ends too early.
    #[error("byte {offset}: {what} runs past the end of the file ({length} bytes)")]
    PastEnd {
        /// Offset where the part starts, in bytes.
        offset: usize,
        /// Name of the part.
        what: &'static str,
        /// Length of the file.
        length: usize,
    },
    /// A run of equal pixels that does not end with its line.
    #[error(
        "byte {offset}: the length of a run is {found}; expected 1 to {most}, to the end of the line"
    )]
    Run {
        /// Offset of the run, in bytes.
        offset: usize,
        /// Length found.
        found: usize,
        /// Longest that fits.
        most: usize,
    },
    /// A channel that is needed is not there.
    #[error("no channel `{channel}`; expected {expected}")]
    Channel {
        /// Name of the channel.
        channel: String,
        /// Expected content.
        expected: &'static str,
    },
}

impl ImageError {
    pub(crate) fn coder(what: &'static str) -> impl Fn(String) -> Self {
        move |problem| Self::Coder { what, problem: problem.replace('\n', " ") }
    }
}
