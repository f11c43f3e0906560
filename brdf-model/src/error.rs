//! The errors of tables and samples.

/// An error of this crate: a table that cannot be used, or no samples.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// A table has the wrong number of values.
    #[error("table {table} holds {found} values; expected {expected}")]
    TableSize {
        /// Name of the table.
        table: &'static str,
        /// Values that its shape asks for.
        expected: usize,
        /// Values given.
        found: usize,
    },
    /// A table holds a value that it must not.
    #[error("table {table} holds {value} at index {index}; expected {expected}")]
    TableValue {
        /// Name of the table.
        table: &'static str,
        /// Index of the value in the table.
        index: usize,
        /// The value found there.
        value: f64,
        /// What is allowed there.
        expected: &'static str,
    },
    /// A table has a shape that it cannot have.
    #[error("table {table} has shape {shape:?}; expected {expected}")]
    TableShape {
        /// Name of the table.
        table: &'static str,
        /// Shape given.
        shape: Vec<usize>,
        /// What is allowed there.
        expected: &'static str,
    },
    /// No sample is left to work with.
    #[error("no usable samples: {dropped}")]
    NoSamples {
        /// What was dropped and why.
        dropped: String,
    },
}
