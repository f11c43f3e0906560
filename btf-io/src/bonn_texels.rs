//! BTFs as all values of each texel, in half precision, without packing.

use std::ops::Range;

use half::f16;

use crate::bonn_header::{BonnHeader, check_end, skip_rotations};
use brdf_io::Cursor;
use brdf_io::FormatError;

/// Mark of a texel without values.
const ABSENT: usize = usize::MAX;

/// Where the values of texels lie.
#[derive(Debug)]
pub(crate) struct Texels {
    /// Offset of each texel's values in the file, or [`ABSENT`].
    offsets: Vec<usize>,
    images: usize,
}

impl Texels {
    /// Reads the lengths of all chunks, and makes sure that their values are all there.
    pub(crate) fn read(
        bytes: &[u8],
        header: &BonnHeader,
        cursor: &mut Cursor<'_>,
    ) -> Result<Self, FormatError> {
        let at = cursor.offset();
        let lines = cursor.u32("the number of lines in a chunk")? as usize;
        if lines == 0 {
            return Err(FormatError::Field {
                offset: at,
                what: "the number of lines in a chunk",
                found: "0".to_owned(),
                expected: "1 or more".to_owned(),
            });
        }
        let sparse = read_sparseness(cursor)?;
        let mask = cursor.take(header.texels(), "the mask of texels")?;
        if header.rotations {
            skip_rotations(cursor)?;
        }
        let is_stored = |texel: &usize| !sparse || mask[*texel] != 0;
        let stored: Vec<usize> = (0..header.texels()).filter(is_stored).collect();
        let images = header.images();
        let mut offsets = vec![ABSENT; header.texels()];
        for chunk in stored.chunks(lines.saturating_mul(header.width)) {
            read_chunk(cursor, chunk, 6 * images, &mut offsets)?;
        }
        check_end(bytes, cursor)?;
        Ok(Self { offsets, images })
    }

    /// Values of consecutive texels, `out[image][texel][channel]`. Texels that are not in the file
    /// are black.
    pub(crate) fn read_texels(&self, bytes: &[u8], texels: Range<usize>, out: &mut [f32]) {
        let count = texels.len();
        for (place, &offset) in self.offsets[texels].iter().enumerate() {
            let values: &[u8] =
                if offset == ABSENT { &[] } else { &bytes[offset..offset + 6 * self.images] };
            let mut values =
                values.as_chunks::<2>().0.iter().map(|value| f16::from_le_bytes(*value).to_f32());
            for texel in out.as_chunks_mut::<3>().0.iter_mut().skip(place).step_by(count) {
                *texel = std::array::from_fn(|_| values.next().unwrap_or(0.0));
            }
        }
    }

    /// How many texels have no values.
    pub(crate) fn absent(&self) -> usize {
        self.offsets.iter().filter(|&&offset| offset == ABSENT).count()
    }
}

/// Whether only texels of the mask are stored.
fn read_sparseness(cursor: &mut Cursor<'_>) -> Result<bool, FormatError> {
    let offset = cursor.offset();
    let packing = cursor.u8("the packing of texels")?;
    match packing {
        0 => Ok(false),
        2 => Ok(true),
        other => Err(FormatError::Field {
            offset,
            what: "the packing of texels",
            found: if other == 1 { "1 (bzip)".to_owned() } else { other.to_string() },
            expected: "0 or 2, without packing".to_owned(),
        }),
    }
}

/// A chunk of texels with its length before it; the last one may be as long as the others.
fn read_chunk(
    cursor: &mut Cursor<'_>,
    texels: &[usize],
    texel_bytes: usize,
    offsets: &mut [usize],
) -> Result<(), FormatError> {
    let offset = cursor.offset();
    let length = cursor.u32("the length of a chunk")? as usize;
    let needed = texels.len().saturating_mul(texel_bytes);
    if length < needed || !length.is_multiple_of(texel_bytes) {
        return Err(FormatError::Field {
            offset,
            what: "the length of a chunk",
            found: format!("{length} bytes"),
            expected: format!("{needed} for {} texels", texels.len()),
        });
    }
    let start = cursor.offset();
    cursor.take(length, "a chunk of texels")?;
    for (number, &texel) in texels.iter().enumerate() {
        offsets[texel] = start + number * texel_bytes;
    }
    Ok(())
}
