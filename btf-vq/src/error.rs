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
        /// Along α.
        alphas: usize,
        /// Along β.
        betas: usize,
        /// Along θv.
        thetas: usize,
        /// Along φv.
        phis: usize,
    },
    /// Too few directions to interpolate between.
    #[error("{found} {what}; expected at least {expected} different ones above the horizon")]
    Directions {
        /// Views, or lights of a view.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many are needed.
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
    Source(#[source] crate::SourceError),
    /// A model that no budget of this size can hold.
    #[error("{bytes} bytes are too few for {what}; the least is {least}")]
    Budget {
        /// What was asked for.
        bytes: u64,
        /// What should fit.
        what: String,
        /// What it takes.
        least: u64,
    },
    /// Materials that cannot share books.
    #[error("{what} differ: {found}; expected {expected}")]
    Mixed {
        /// Which property.
        what: &'static str,
        /// Of the second.
        found: String,
        /// Of the first.
        expected: String,
    },
    /// An index past the end of the book that it points into.
    #[error("{book}: row {row} points to row {index} of {target}, which has {rows}")]
    Index {
        /// Where it stands.
        book: &'static str,
        /// Row there.
        row: usize,
        /// What it says.
        index: u32,
        /// Where it points.
        target: &'static str,
        /// Rows there.
        rows: usize,
    },
    /// A stream of another length than its rows need.
    #[error("{book}: {found} bytes; expected {expected} for {rows} rows")]
    Stream {
        /// Which book.
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
        /// Which field.
        what: &'static str,
        /// What it holds.
        found: String,
        /// What would do.
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
        /// Its name.
        name: String,
    },
    /// The work was stopped.
    #[error(transparent)]
    Stopped(#[from] brdf_job::Stopped),
}
