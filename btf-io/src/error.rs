//! What can be wrong with a set of images.

use std::path::PathBuf;

use brdf_image::ImageError;
use brdf_io::FormatError;

/// A problem with the images of a bidirectional texture function; they are named within their folder or archive.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BtfError {
    /// The work was stopped.
    #[error(transparent)]
    Stopped(#[from] brdf_job::Stopped),
    /// No file is named as an image of a BTF.
    #[error(
        "no BTF in {files} files; expected images named by angles, such as \
         \"tl015 pl000 tv030 pv090.jpg\""
    )]
    NoImages {
        /// Files that are there.
        files: usize,
    },
    /// A name that has some of the keys.
    #[error("{name}: its name has {found}; expected one angle for each of tl, pl, tv and pv")]
    PartialName {
        /// Name of the image.
        name: String,
        /// Keys that its name has.
        found: String,
    },
    /// A direction that does not point away from the surface.
    #[error("{name}: the {what} stands at {theta_deg}° from the normal; expected 0° to 90°")]
    BelowHorizon {
        /// Name of the image.
        name: String,
        /// View or light.
        what: &'static str,
        /// Polar angle of the direction, degrees.
        theta_deg: f64,
    },
    /// Two images of the same directions.
    #[error("{name}: {other} has the same view and light; expected one image for each pair")]
    Duplicate {
        /// Name of the image.
        name: String,
        /// The other one.
        other: String,
    },
    /// Too few directions to interpolate between.
    #[error("found {found} {what}; expected at least {least}")]
    TooFew {
        /// Name of what there is too little of.
        what: String,
        /// Number found.
        found: usize,
        /// Number expected.
        least: usize,
    },
    /// More files, entries or directions than any BTF has.
    #[error("more than {limit} {what}")]
    TooMany {
        /// Name of what there is too much of.
        what: &'static str,
        /// Most that are read.
        limit: usize,
    },
    /// Images of different size.
    #[error("{name}: {} × {} texels; expected {} × {} as in {other}", size[0], size[1],
        expected[0], expected[1])]
    Sizes {
        /// Name of the image.
        name: String,
        /// Width and height of the image.
        size: [usize; 2],
        /// Width and height of the first image.
        expected: [usize; 2],
        /// The first image.
        other: String,
    },
    /// Display-referred 8-bit images together with linear ones.
    #[error("{name}: {}; expected {} as in {other}", range(*linear), range(!*linear))]
    MixedRanges {
        /// Name of the image.
        name: String,
        /// Whether it is the linear one.
        linear: bool,
        /// The first image.
        other: String,
    },
    /// An image that cannot be decoded.
    #[error("{name}: {problem}")]
    Image {
        /// Name of the image.
        name: String,
        /// Error of the reader.
        problem: FormatError,
    },
    /// More bytes, packed or unpacked, than an image may have.
    #[error("{name}: more than {limit} bytes")]
    TooLong {
        /// Name of the image.
        name: String,
        /// Most that are read.
        limit: u64,
    },
    /// An archive that needs a password.
    #[error("{name}: encrypted; expected an archive without a password")]
    Encrypted {
        /// Name of the image.
        name: String,
    },
    /// An archive that cannot be read.
    #[error("archive: {problem}")]
    Archive {
        /// Message of the library.
        problem: String,
    },
    /// The file system refused.
    #[error("{name}: {action}: {problem}")]
    File {
        /// Name of the file or folder.
        name: String,
        /// Action that was attempted.
        action: &'static str,
        /// Error of the file system.
        problem: std::io::Error,
    },
    /// No room for the decoded images.
    #[error(
        "decoded images take {needed} bytes, more than the memory limit of {limit}, and {} has {free} \
         bytes free",
        folder.display()
    )]
    NoRoom {
        /// Bytes of all images.
        needed: u64,
        /// Bytes that may be in memory.
        limit: usize,
        /// Folder of temporary files.
        folder: PathBuf,
        /// Bytes that are free there.
        free: u64,
    },
    /// The system refused memory or a temporary file.
    #[error("{action} for {needed} bytes of decoded images: {problem}")]
    Storage {
        /// Action that was attempted.
        action: &'static str,
        /// Bytes of all images.
        needed: u64,
        /// Error of the file system.
        problem: std::io::Error,
    },
}

/// What an image holds, for a message.
fn range(linear: bool) -> &'static str {
    if linear { "linear values" } else { "display-referred 8-bit values" }
}

/// What a decoder of pictures says, as a problem of the file.
pub(crate) fn image_error(what: &'static str) -> impl Fn(ImageError) -> FormatError {
    move |error| match error {
        ImageError::Coder { what, problem } => FormatError::Library { what, problem },
        ImageError::Claim { found, expected } => {
            FormatError::Size { found, expected, hint: " or more for the size its header claims" }
        }
        ImageError::PastEnd { offset, what, length } => {
            FormatError::PastEnd { offset: offset as u64, what: what.to_owned(), length }
        }
        other => FormatError::Library { what, problem: other.to_string() },
    }
}
