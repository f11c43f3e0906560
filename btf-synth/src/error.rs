//! What can be wrong with the maps of a surface.

/// A problem with maps or options that make no surface.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SynthError {
    /// A side of length 0, or more texels than this program works with.
    #[error("a map of {width} × {height} texels; expected sides from 1 to {largest}")]
    Size {
        /// Texels in a row.
        width: usize,
        /// Rows.
        height: usize,
        /// The longest side that is accepted.
        largest: usize,
    },
    /// The number of values is not that of the texels.
    #[error("{what}: {found} values; expected {expected}")]
    Length {
        /// Name of the map.
        what: &'static str,
        /// Values that are there.
        found: usize,
        /// Values that should be.
        expected: usize,
    },
    /// A value that the map must not hold.
    #[error("{what}, texel {texel}: {value}; expected {expected}")]
    Value {
        /// Name of the map.
        what: &'static str,
        /// Row-major index.
        texel: usize,
        /// Content found there.
        value: f32,
        /// Expected content.
        expected: &'static str,
    },
    /// Maps of one surface differ in size.
    #[error("{what}: {found:?} texels; expected {expected:?}")]
    Mismatch {
        /// Name of the map.
        what: &'static str,
        /// Width and height of the map.
        found: [usize; 2],
        /// Width and height of the others.
        expected: [usize; 2],
    },
    /// An option outside its range.
    #[error("{what}: {value}; expected {expected}")]
    Option {
        /// Name of the option.
        what: &'static str,
        /// Value that was given.
        value: f64,
        /// Expected content.
        expected: &'static str,
    },
}
