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
