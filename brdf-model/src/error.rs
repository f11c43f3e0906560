//! What can be wrong with tables and samples.

/// Errors of this crate.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// A table has the wrong number of values.
    #[error("table {table} holds {found} values; expected {expected}")]
    TableSize {
        /// Which table.
        table: &'static str,
        /// Values that its shape asks for.
        expected: usize,
        /// Values given.
        found: usize,
    },
    /// A table holds a value that it must not.
    #[error("table {table} holds {value} at index {index}; expected {expected}")]
    TableValue {
        /// Which table.
        table: &'static str,
        /// Where.
        index: usize,
        /// The value.
        value: f64,
        /// What would do.
        expected: &'static str,
    },
    /// A shape that a table cannot have.
    #[error("table {table} has shape {shape:?}; expected {expected}")]
    TableShape {
        /// Which table.
        table: &'static str,
        /// Its shape.
        shape: Vec<usize>,
        /// What would do.
        expected: &'static str,
    },
    /// Nothing is left to work with.
    #[error("no usable samples: {dropped}")]
    NoSamples {
        /// What was dropped and why.
        dropped: String,
    },
}
