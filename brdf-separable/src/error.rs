//! The errors of separable factorizations.

/// An error of this crate: parts that do not fit together, limits, or work that was stopped.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SeparableError {
    /// A grid cannot have this many texels.
    #[error("resolution {resolution}; expected {min} to {max}")]
    Resolution {
        /// Texels along a side, as given.
        resolution: usize,
        /// Fewest texels allowed.
        min: usize,
        /// Most texels allowed.
        max: usize,
    },
    /// Two grids make no matrix.
    #[error("{found}; expected {expected}")]
    Layout {
        /// What was found.
        found: &'static str,
        /// What is allowed there.
        expected: &'static str,
    },
    /// The matrix and the work on it would need more memory than allowed.
    #[error(
        "a matrix of {rows} × {columns} × {channels} needs {} MiB, more than the limit of {} MiB; \
         try a lower resolution",
        needed >> 20,
        limit >> 20
    )]
    Memory {
        /// Number of rows.
        rows: usize,
        /// Number of columns.
        columns: usize,
        /// Number of channels.
        channels: usize,
        /// Number of bytes needed.
        needed: usize,
        /// Number of bytes allowed.
        limit: usize,
    },
    /// No cell of the matrix has data.
    #[error("no cell of the {rows} × {columns} matrix has data; try a larger grazing limit")]
    NoData {
        /// Number of rows.
        rows: usize,
        /// Number of columns.
        columns: usize,
    },
    /// The matrix cannot have this rank.
    #[error("rank {rank}; expected 1 to {max}, the smaller side of the {rows} × {columns} matrix")]
    Rank {
        /// The rank given.
        rank: usize,
        /// Largest rank.
        max: usize,
        /// Number of rows.
        rows: usize,
        /// Number of columns.
        columns: usize,
    },
    /// A decomposition of symmetric matrices was asked for another one.
    #[error("{found}; eigenpairs need {expected}")]
    NotSymmetric {
        /// What was found.
        found: &'static str,
        /// What is allowed there.
        expected: &'static str,
    },
    /// A decomposition of non-negative matrices was asked for one that has negative values.
    #[error("{count} of {cells} values are negative; {expected}")]
    Negative {
        /// Number of negative values.
        count: usize,
        /// Number of values in all.
        cells: usize,
        /// What is allowed there.
        expected: &'static str,
    },
    /// The textures of a model do not fit its layout.
    #[error("{found} values in the {side} textures; expected {expected}")]
    Texels {
        /// Name of the side.
        side: &'static str,
        /// Number of values given.
        found: usize,
        /// Number of values that the layout needs.
        expected: usize,
    },
    /// A dense decomposition of the linear algebra library failed.
    #[error("the dense {what} of a {size} × {size} matrix did not converge")]
    Dense {
        /// Name of the decomposition.
        what: &'static str,
        /// Size of the matrix.
        size: usize,
    },
    /// The work was stopped.
    #[error(transparent)]
    Stopped(#[from] brdf_job::Stopped),
}
