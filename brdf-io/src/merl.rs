//! MERL `.binary`: three 32-bit dimensions, then all red values, all green, all blue as f64,
//! little-endian and unscaled.

use brdf_model::{MerlLookup, MerlTable};

use crate::FormatError;
use crate::bytes::{Cursor, f64_values};

/// sr⁻¹ per stored unit, for red, green and blue.
const SCALE: [f64; 3] = [1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0];
/// theta_h, theta_d, phi_d, as in [`MerlTable`].
const DIMENSIONS: [u32; 3] = [90, 90, 180];
const HEADER: usize = 12;
const PLANE: usize = MerlTable::CELLS * 8;
const FILE_LENGTH: usize = HEADER + 3 * PLANE;

/// The three dimensions are there, or the length is right and the dimensions are damaged: either
/// way the reader has something useful to say.
pub(crate) fn looks_like_merl(bytes: &[u8]) -> bool {
    let header: Vec<u8> = DIMENSIONS.iter().flat_map(|d| d.to_le_bytes()).collect();
    bytes.starts_with(&header) || bytes.len() == FILE_LENGTH
}

/// Reads a table. Negative cells are invalid.
///
/// # Errors
///
/// [`FormatError`] for wrong dimensions or length, or infinite values.
pub fn read_merl(bytes: &[u8], lookup: MerlLookup) -> Result<MerlTable, FormatError> {
    let mut cursor = Cursor::new(bytes, 0);
    for (axis, expected) in
        ["the theta_h dimension", "the theta_d dimension", "the phi_d dimension"]
            .into_iter()
            .zip(DIMENSIONS)
    {
        let offset = cursor.offset();
        let found = cursor.u32(axis)?;
        if found != expected {
            return Err(FormatError::Field {
                offset,
                what: axis,
                found: found.to_string(),
                expected: format!("{expected}, the grid of the MERL database"),
            });
        }
    }
    if bytes.len() != FILE_LENGTH {
        let hint = if bytes.len() < FILE_LENGTH {
            ", three planes of 90 × 90 × 180 doubles; the download may be incomplete"
        } else {
            ", three planes of 90 × 90 × 180 doubles"
        };
        return Err(FormatError::Size { found: bytes.len(), expected: FILE_LENGTH, hint });
    }
    let plane = |channel: usize| f64_values(&bytes[HEADER + channel * PLANE..][..PLANE]);
    #[expect(clippy::cast_possible_truncation, reason = "the table stores f32")]
    let cells = plane(0)
        .zip(plane(1))
        .zip(plane(2))
        .map(|((r, g), b)| [r * SCALE[0], g * SCALE[1], b * SCALE[2]].map(|v| v as f32));
    Ok(MerlTable::new(cells, lookup)?)
}

/// The bytes of a table; invalid cells are −1 in every channel, unscaled.
pub fn merl_to_bytes(table: &MerlTable) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(FILE_LENGTH);
    DIMENSIONS.iter().for_each(|d| bytes.extend(d.to_le_bytes()));
    for (channel, scale) in SCALE.into_iter().enumerate() {
        for cell in table.cells() {
            let raw = if cell[0] < 0.0 { -1.0 } else { f64::from(cell[channel]) / scale };
            bytes.extend(raw.to_le_bytes());
        }
    }
    bytes
}
