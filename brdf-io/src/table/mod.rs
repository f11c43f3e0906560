//! Tables of samples: numbers under a header that names columns and units, in the dialects that people write. Also the
//! direction tables that commands exchange.

mod angles;
mod columns;
mod dialect;
mod directions;
mod repeats;
mod samples;

pub use columns::{Angle, AngleUnit, Column, ColumnMap, LengthUnit, RowChoice};
pub use directions::{direction_rows, direction_table_header, write_samples};
pub use samples::{TableOptions, read_table};

/// There are rows of numbers, or a header that says everything.
pub(crate) fn looks_like_table(text: &str) -> bool {
    dialect::Table::new(text).is_ok()
}
