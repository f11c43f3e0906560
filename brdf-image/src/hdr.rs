//! Radiance HDR pictures.

use std::io::Cursor;

use image::codecs::hdr::HdrDecoder;
use image::{DynamicImage, ImageDecoder as _, Limits};

use crate::{ImageError, LONGEST_SIDE};

/// Most bytes that a decoded picture may take.
const MOST_BYTES: u64 = 2 << 30;

/// A picture of linear RGB values, without opacity.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearImage {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Linear red, green and blue, row by row from the top.
    pub pixels: Vec<[f32; 3]>,
}

/// Returns the picture of a Radiance HDR file. The field `EXPOSURE` is not read.
///
/// # Errors
///
/// [`ImageError`] for content that is no such picture.
pub fn decode_hdr(bytes: &[u8]) -> Result<LinearImage, ImageError> {
    let refused = ImageError::coder("Radiance HDR");
    check_size(bytes)?;
    // Not strict: many files start with #?RGBE instead of #?RADIANCE.
    let mut decoder = HdrDecoder::with_strictness(Cursor::new(bytes), false)
        .map_err(|error| refused(error.to_string()))?;
    let mut limits = Limits::default();
    let side = u32::try_from(LONGEST_SIDE).unwrap_or(u32::MAX);
    (limits.max_image_width, limits.max_image_height) = (Some(side), Some(side));
    limits.max_alloc = Some(MOST_BYTES);
    decoder.set_limits(limits).map_err(|error| refused(error.to_string()))?;
    let image = DynamicImage::from_decoder(decoder)
        .map_err(|error| refused(error.to_string()))?
        .into_rgb32f();
    let (width, height) = (image.width() as usize, image.height() as usize);
    Ok(LinearImage { width, height, pixels: image.pixels().map(|pixel| pixel.0).collect() })
}

/// The decoder makes room for what the header claims, so the claim is held against the file first: run-length coding
/// spends at least two bytes on 127 equal values, four times a pixel.
fn check_size(bytes: &[u8]) -> Result<(), ImageError> {
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(4096)]);
    let sides = head.lines().find_map(|line| {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[..] {
            ["-Y" | "+Y", rows, "+X" | "-X", columns] => {
                Some((rows.parse::<u64>().ok()?, columns.parse::<u64>().ok()?))
            }
            _ => None,
        }
    });
    let Some((rows, columns)) = sides else { return Ok(()) };
    let least = rows.saturating_mul(columns) / 127 * 8;
    if least > bytes.len() as u64 {
        let expected = usize::try_from(least).unwrap_or(usize::MAX);
        return Err(ImageError::Claim { found: bytes.len(), expected });
    }
    Ok(())
}
