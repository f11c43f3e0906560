//! What can go wrong in a separable factorization.

/// Errors of this crate.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SeparableError {
    /// A chart cannot have this many texels.
    #[error("resolution {resolution}; expected {min} to {max}")]
    Resolution {
        /// Texels along a side.
        resolution: usize,
        /// Fewest.
        min: usize,
        /// Most.
        max: usize,
    },
    /// Charts that make no matrix.
    #[error("{found}; expected {expected}")]
    Layout {
        /// What is wrong.
        found: &'static str,
        /// What would do.
        expected: &'static str,
    },
    /// The matrix and the work on it would not fit.
    #[error(
        "a matrix of {rows} × {columns} × {channels} needs {} MiB, more than the limit of {} MiB; \
         try a lower resolution",
        needed >> 20,
        limit >> 20
    )]
    Memory {
        /// Rows.
        rows: usize,
        /// Columns.
        columns: usize,
        /// Channels.
        channels: usize,
        /// Bytes it would take.
        needed: usize,
        /// Bytes allowed.
        limit: usize,
    },
    /// No cell of the matrix has data.
    #[error("no cell of the {rows} × {columns} matrix has data; try a larger grazing limit")]
    NoData {
        /// Rows.
        rows: usize,
        /// Columns.
        columns: usize,
    },
    /// A rank that the matrix cannot have.
    #[error("rank {rank}; expected 1 to {max}, the smaller side of the {rows} × {columns} matrix")]
    Rank {
        /// The rank asked for.
        rank: usize,
        /// Largest rank.
        max: usize,
        /// Rows.
        rows: usize,
        /// Columns.
        columns: usize,
    },
    /// A decomposition of symmetric matrices was asked for another one.
    #[error("{found}; eigenpairs need {expected}")]
    NotSymmetric {
        /// What is wrong.
        found: &'static str,
        /// What would do.
        expected: &'static str,
    },
    /// A decomposition of non-negative matrices was asked for one that has negative values.
    #[error("{count} of {cells} values are negative; {expected}")]
    Negative {
        /// Negative values.
        count: usize,
        /// Values in all.
        cells: usize,
        /// What would do.
        expected: &'static str,
    },
    /// The textures of a model do not fit its layout.
    #[error("{found} values in the {side} textures; expected {expected}")]
    Texels {
        /// Which side.
        side: &'static str,
        /// Values that are there.
        found: usize,
        /// Values that the layout asks for.
        expected: usize,
    },
    /// A dense decomposition of the linear algebra library failed.
    #[error("the dense {what} of a {size} × {size} matrix did not converge")]
    Dense {
        /// Which one.
        what: &'static str,
        /// Its size.
        size: usize,
    },
    /// The work was stopped.
    #[error(transparent)]
    Stopped(#[from] brdf_job::Stopped),
}
