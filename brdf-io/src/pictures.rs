//! Pictures to look at, and lat-long environments to light them with.

use std::io::Cursor;
use std::path::Path;

use brdf_render::{DisplayImage, Environment};
use image::codecs::hdr::HdrDecoder;
use image::{DynamicImage, ImageDecoder as _, Limits};

use crate::{FormatError, IoError, MappedFile};

/// How our pictures are recognized: their Software text.
pub(crate) const PICTURE_MARK: &[u8] = b"Software\0brdf";

/// How our plots are recognized: the comment at their head.
pub(crate) const PLOT_MARK: &[u8] = b"<!-- brdf plot -->";

/// Largest environment that is read.
const MAX_ENVIRONMENT_SIDE: u32 = 16_384;
const MAX_ENVIRONMENT_BYTES: u64 = 2 << 30;

/// The bytes of a PNG.
///
/// # Errors
///
/// [`FormatError::Library`] if the encoder refuses.
pub fn png_bytes(picture: &DisplayImage) -> Result<Vec<u8>, FormatError> {
    let library = |problem: String| FormatError::Library { what: "PNG", problem };
    let [width, height] = [picture.width(), picture.height()].map(u32::try_from);
    let (Ok(width), Ok(height)) = (width, height) else {
        return Err(library("too large".to_owned()));
    };
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::RelativeColorimetric);
    let written = encoder
        .add_text_chunk("Software".to_owned(), "brdf".to_owned())
        .and_then(|()| encoder.write_header())
        .and_then(|mut writer| writer.write_image_data(picture.bytes()));
    written.map_err(|error| library(error.to_string()))?;
    Ok(bytes)
}

/// Reads a lat-long environment, Radiance HDR.
///
/// # Errors
///
/// [`IoError::File`]; [`IoError::Format`] for content that is no usable image.
pub fn read_environment(path: &Path) -> Result<Environment, IoError> {
    let bytes = MappedFile::open(path)?;
    parse_environment(&bytes).map_err(IoError::format(path))
}

/// The decoder makes room for what the header claims, so the claim is held against the file first:
/// run-length coding spends at least two bytes on 127 equal values, four times a pixel.
fn check_size(bytes: &[u8]) -> Result<(), FormatError> {
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
        return Err(FormatError::Size {
            found: bytes.len(),
            expected: usize::try_from(least).unwrap_or(usize::MAX),
            hint: " or more for the size its header claims",
        });
    }
    Ok(())
}

/// Reads a lat-long environment from the bytes of a Radiance HDR file.
///
/// # Errors
///
/// [`FormatError`] for content that is no usable image.
pub fn parse_environment(bytes: &[u8]) -> Result<Environment, FormatError> {
    let library = |problem: String| FormatError::Library { what: "Radiance HDR", problem };
    check_size(bytes)?;
    // Not strict: many files start with #?RGBE instead of #?RADIANCE.
    let mut decoder = HdrDecoder::with_strictness(Cursor::new(bytes), false)
        .map_err(|error| library(error.to_string()))?;
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_ENVIRONMENT_SIDE);
    limits.max_image_height = Some(MAX_ENVIRONMENT_SIDE);
    limits.max_alloc = Some(MAX_ENVIRONMENT_BYTES);
    decoder.set_limits(limits).map_err(|error| library(error.to_string()))?;
    let image = DynamicImage::from_decoder(decoder)
        .map_err(|error| library(error.to_string()))?
        .into_rgb32f();
    let (width, height) = (image.width() as usize, image.height() as usize);
    let texels = image.pixels().map(|pixel| pixel.0).collect();
    Environment::new(width, height, texels).map_err(|error| library(error.to_string()))
}
