//! Holding what a header claims against the length of its file: decoders make room for it.

use crate::ImageError;

/// Most pixels in a row or column of an image that is read.
pub const LONGEST_SIDE: usize = 16_384;
/// Pixels that one byte may claim. Deflate packs at most 1032 bytes into one; a block of 64 pixels of a JPEG takes
/// at least one bit.
const PIXELS_PER_BYTE: u64 = 1032;
/// A file may be all header.
const SMALLEST_CLAIM: u64 = 1 << 20;

/// Checks the size that a file's header claims: refuses one that no image has, or that a file of `file_length` bytes
/// cannot hold.
///
/// ```
/// assert!(brdf_image::check_claim(100, [64, 64]).is_ok());
/// assert!(brdf_image::check_claim(100, [16_000, 16_000]).is_err());
/// ```
///
/// # Errors
///
/// [`ImageError::Sides`]; [`ImageError::Claim`].
pub fn check_claim(file_length: usize, size: [usize; 2]) -> Result<(), ImageError> {
    let [width, height] = size;
    if width == 0 || height == 0 || width > LONGEST_SIDE || height > LONGEST_SIDE {
        return Err(ImageError::Sides { size, most: LONGEST_SIDE });
    }
    let least = (width as u64 * height as u64).saturating_sub(SMALLEST_CLAIM) / PIXELS_PER_BYTE;
    if least > file_length as u64 {
        let expected = usize::try_from(least).unwrap_or(usize::MAX);
        return Err(ImageError::Claim { found: file_length, expected });
    }
    Ok(())
}
