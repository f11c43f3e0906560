//! MERL `.binary`: three 32-bit dimensions, then all red values, all green, all blue as f64,
//! little-endian and unscaled.

use brdf_model::{MerlLookup, MerlTable};

use crate::FormatError;
use crate::bytes::{Cursor, f64_values};
use crate::detect::{MERL_DIMENSIONS, MERL_LENGTH};

/// sr⁻¹ per stored unit, for red, green and blue.
const SCALE: [f64; 3] = [1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0];
const HEADER: usize = 12;
const PLANE: usize = MerlTable::CELLS * 8;

/// Reads a MERL table of 90 × 90 × 180 cells and scales its values to sr⁻¹. Negative cells are invalid.
///
/// Grid and scales are those of the MERL database: W. Matusik, H. Pfister, M. Brand and L. McMillan, *A Data-Driven
/// Reflectance Model*, 2003.
///
/// # Errors
///
/// [`FormatError`] for wrong dimensions or length, or infinite values.
pub fn read_merl(bytes: &[u8], lookup: MerlLookup) -> Result<MerlTable, FormatError> {
    let mut cursor = Cursor::new(bytes, 0);
    for (axis, expected) in
        ["the theta_h dimension", "the theta_d dimension", "the phi_d dimension"]
            .into_iter()
            .zip(MERL_DIMENSIONS)
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
    if bytes.len() != MERL_LENGTH {
        let hint = if bytes.len() < MERL_LENGTH {
            ", three planes of 90 × 90 × 180 doubles; the download may be incomplete"
        } else {
            ", three planes of 90 × 90 × 180 doubles"
        };
        return Err(FormatError::Size { found: bytes.len(), expected: MERL_LENGTH, hint });
    }
    let plane = |channel: usize| f64_values(&bytes[HEADER + channel * PLANE..][..PLANE]);
    #[expect(clippy::cast_possible_truncation, reason = "the table stores f32")]
    let cells = plane(0)
        .zip(plane(1))
        .zip(plane(2))
        .map(|((r, g), b)| [r * SCALE[0], g * SCALE[1], b * SCALE[2]].map(|v| v as f32));
    Ok(MerlTable::new(cells, lookup)?)
}

/// Writes a table as the bytes of a MERL file; invalid cells are −1 in every channel, unscaled.
///
/// ```
/// use brdf_model::{MerlLookup, MerlNodes, MerlTable, Preset};
///
/// let table = MerlTable::tabulate(&Preset::find("plastic").expect("a built-in material").brdf());
/// let bytes = brdf_io::write_merl(&table);
/// let read = brdf_io::read_merl(&bytes, MerlLookup::Trilinear(MerlNodes::Centre))?;
/// assert_eq!(read.cells(), table.cells());
/// # Ok::<(), brdf_io::FormatError>(())
/// ```
pub fn write_merl(table: &MerlTable) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(MERL_LENGTH);
    MERL_DIMENSIONS.iter().for_each(|d| bytes.extend(d.to_le_bytes()));
    for (channel, scale) in SCALE.into_iter().enumerate() {
        for cell in table.cells() {
            let raw = if cell[0] < 0.0 { -1.0 } else { f64::from(cell[channel]) / scale };
            bytes.extend(raw.to_le_bytes());
        }
    }
    bytes
}
