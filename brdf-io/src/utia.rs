//! UTIA `.bin`: three planes of 288 × 288 f64 values, little-endian, without a header.

use brdf_model::UtiaTable;

use crate::FormatError;
use crate::bytes::f64_values;
use crate::detect::UTIA_LENGTH;

const PLANE: usize = UtiaTable::SIDE * UtiaTable::SIDE;

/// Reads a UTIA table of 288 × 288 direction pairs, RGB in sr⁻¹.
///
/// # Errors
///
/// [`FormatError::Size`]; [`FormatError::Model`] for values that are not finite.
pub fn read_utia(bytes: &[u8]) -> Result<UtiaTable, FormatError> {
    if bytes.len() != UTIA_LENGTH {
        return Err(FormatError::Size {
            found: bytes.len(),
            expected: UTIA_LENGTH,
            hint: ", three planes of 288 × 288 doubles",
        });
    }
    #[expect(clippy::cast_possible_truncation, reason = "the table stores f32")]
    let plane =
        |channel: usize| f64_values(&bytes[channel * 8 * PLANE..][..8 * PLANE]).map(|v| v as f32);
    let values = plane(0).zip(plane(1)).zip(plane(2)).map(|((r, g), b)| [r, g, b]).collect();
    Ok(UtiaTable::new(values)?)
}
