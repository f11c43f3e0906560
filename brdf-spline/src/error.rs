//! The errors of this crate.

/// An error of a fit or of a stream.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SplineError {
    /// The material has no data, or nothing but zeros.
    #[error("no value above 0 in {nodes} places; a model needs some")]
    NoData {
        /// Places that were looked at.
        nodes: usize,
    },
    /// No model is this small or this large.
    #[error("a model of {bytes} bytes; expected {min} to {max}")]
    Bytes {
        /// Bytes asked for.
        bytes: usize,
        /// Fewest.
        min: usize,
        /// Most.
        max: usize,
    },
    /// A base has no lobes, or too many for a stream.
    #[error("a base of {lobes} lobes; expected 1 to {max}")]
    Lobes {
        /// Lobes of the base.
        lobes: usize,
        /// Most.
        max: usize,
    },
    /// A stream is not that of a model.
    #[error("{what} {found}; expected {expected}")]
    Stream {
        /// The part that is wrong.
        what: &'static str,
        /// What stands there.
        found: String,
        /// What may stand there.
        expected: &'static str,
    },
    /// The work was stopped before there was a model.
    #[error(transparent)]
    Stopped(#[from] brdf_job::Stopped),
}
