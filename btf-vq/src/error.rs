//! What can be wrong with a BTF or its codebooks.

/// A BTF that cannot be compressed, or a compressed one that cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VqError {
    /// A grid with too few or too many nodes.
    #[error(
        "a grid of {alphas} × {betas} × {thetas} × {phis} nodes; expected at least 2 × 2 × 2 × 1 and \
         at most 2^24 in all"
    )]
    Grid {
        /// Nodes along α.
        alphas: usize,
        /// Nodes along β.
        betas: usize,
        /// Nodes along θv.
        thetas: usize,
        /// Nodes along φv.
        phis: usize,
    },
    /// Too few directions to interpolate between.
    #[error("{found} {what}; expected at least {expected} different ones above the horizon")]
    Directions {
        /// Views, or lights of a view.
        what: &'static str,
        /// Number found.
        found: usize,
        /// Number needed.
        expected: usize,
    },
    /// A source without texels.
    #[error("{width} × {height} texels; expected at least one, and at most 2^28")]
    Size {
        /// Texels in a row.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// A value that is no number.
    #[error("texel {texel}: a value is not finite; expected finite radiance")]
    NotFinite {
        /// Row-major.
        texel: usize,
    },
    /// The source could not be read.
    #[error("{0}")]
    Source(#[source] SourceError),
    /// A model that no budget of this size can hold.
    #[error("{bytes} bytes are too few for {what}; the least is {least}")]
    Budget {
        /// Bytes that were asked for.
        bytes: u64,
        /// Name of what should fit.
        what: String,
        /// Bytes that it takes.
        least: u64,
    },
    /// Materials that cannot share books.
    #[error("{what} differ: {found}; expected {expected}")]
    Mixed {
        /// Name of the property.
        what: &'static str,
        /// Property of the second set.
        found: String,
        /// Property of the first set.
        expected: String,
    },
    /// An index past the end of the book that it points into.
    #[error("{book}: row {row} points to row {index} of {target}, which has {rows}")]
    Index {
        /// Name of the book where it stands.
        book: &'static str,
        /// Row there.
        row: usize,
        /// Index found.
        index: u32,
        /// Name of the book that it points into.
        target: &'static str,
        /// Rows there.
        rows: usize,
    },
    /// A stream of another length than its rows need.
    #[error("{book}: {found} bytes; expected {expected} for {rows} rows")]
    Stream {
        /// Name of the book.
        book: &'static str,
        /// Bytes found.
        found: usize,
        /// Bytes expected.
        expected: usize,
        /// Rows.
        rows: usize,
    },
    /// A header that makes no sense.
    #[error("{what} is {found}; expected {expected}")]
    Header {
        /// Name of the field.
        what: &'static str,
        /// Content found.
        found: String,
        /// Expected content.
        expected: &'static str,
    },
    /// A texture of this name is there already.
    #[error("there is a texture {name} already; give the new one another name")]
    NameTaken {
        /// The name.
        name: String,
    },
    /// A texture that the model does not hold.
    #[error("no texture {name}")]
    NoTexture {
        /// Name of the BRDF.
        name: String,
    },
    /// The work was stopped.
    #[error(transparent)]
    Stopped(#[from] brdf_job::Stopped),
}

/// The reason why a source could not be read.
pub type SourceError = Box<dyn std::error::Error + Send + Sync>;
