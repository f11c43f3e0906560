//! What can be wrong with a set of images.

use std::path::PathBuf;

use brdf_io::FormatError;

/// A problem with the images of a bidirectional texture function; they are named within their folder or archive.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BtfError {
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
        /// Which image.
        name: String,
        /// What its name has.
        found: String,
    },
    /// A direction that does not point away from the surface.
    #[error("{name}: the {what} stands at {theta_deg}° from the normal; expected 0° to 90°")]
    BelowHorizon {
        /// Which image.
        name: String,
        /// View or light.
        what: &'static str,
        /// Its polar angle in degrees.
        theta_deg: f64,
    },
    /// Two images of the same directions.
    #[error("{name}: {other} has the same view and light; expected one image for each pair")]
    Duplicate {
        /// Which image.
        name: String,
        /// The other one.
        other: String,
    },
    /// Too few directions to interpolate between.
    #[error("found {found} {what}; expected at least {least}")]
    TooFew {
        /// What there is too little of.
        what: String,
        /// How many there are.
        found: usize,
        /// How many there should be.
        least: usize,
    },
    /// More files, entries or directions than any BTF has.
    #[error("more than {limit} {what}")]
    TooMany {
        /// What there is too much of.
        what: &'static str,
        /// How many are read.
        limit: usize,
    },
    /// Images of different size.
    #[error("{name}: {} × {} texels; expected {} × {} as in {other}", size[0], size[1],
        expected[0], expected[1])]
    Sizes {
        /// Which image.
        name: String,
        /// Its width and height.
        size: [usize; 2],
        /// Width and height of the first image.
        expected: [usize; 2],
        /// The first image.
        other: String,
    },
    /// Display-referred 8-bit images together with linear ones.
    #[error("{name}: {}; expected {} as in {other}", range(*linear), range(!*linear))]
    MixedRanges {
        /// Which image.
        name: String,
        /// Whether it is the linear one.
        linear: bool,
        /// The first image.
        other: String,
    },
    /// An image that cannot be decoded.
    #[error("{name}: {problem}")]
    Image {
        /// Which image.
        name: String,
        /// What is wrong with it.
        problem: FormatError,
    },
    /// More bytes, packed or unpacked, than an image may have.
    #[error("{name}: more than {limit} bytes")]
    TooLong {
        /// Which image.
        name: String,
        /// How many are read.
        limit: u64,
    },
    /// An archive that needs a password.
    #[error("{name}: encrypted; expected an archive without a password")]
    Encrypted {
        /// Which image.
        name: String,
    },
    /// An archive that cannot be read.
    #[error("archive: {problem}")]
    Archive {
        /// What the library said.
        problem: String,
    },
    /// The file system refused.
    #[error("{name}: {action}: {problem}")]
    File {
        /// Which file or folder.
        name: String,
        /// What was attempted.
        action: &'static str,
        /// What the system said.
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
        /// Where temporary files go.
        folder: PathBuf,
        /// Bytes that are free there.
        free: u64,
    },
    /// The system refused memory or a temporary file.
    #[error("{action} for {needed} bytes of decoded images: {problem}")]
    Storage {
        /// What was attempted.
        action: &'static str,
        /// Bytes of all images.
        needed: u64,
        /// What the system said.
        problem: std::io::Error,
    },
}

/// What an image holds, for a message.
fn range(linear: bool) -> &'static str {
    if linear { "linear values" } else { "display-referred 8-bit values" }
}
