//! Pictures to look at, and lat-long environments to light them with.

use std::io::Cursor;
use std::path::Path;

use brdf_render::{DisplayImage, Environment};
use image::{ImageFormat, ImageReader, Limits, RgbImage};

use crate::{FormatError, IoError, MappedFile};

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
    let image = RgbImage::from_raw(width, height, picture.bytes().to_vec())
        .ok_or_else(|| library("pixels missing".to_owned()))?;
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, ImageFormat::Png).map_err(|error| library(error.to_string()))?;
    Ok(bytes.into_inner())
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

fn parse_environment(bytes: &[u8]) -> Result<Environment, FormatError> {
    let library = |problem: String| FormatError::Library { what: "Radiance HDR", problem };
    let mut reader = ImageReader::with_format(Cursor::new(bytes), ImageFormat::Hdr);
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_ENVIRONMENT_SIDE);
    limits.max_image_height = Some(MAX_ENVIRONMENT_SIDE);
    limits.max_alloc = Some(MAX_ENVIRONMENT_BYTES);
    reader.limits(limits);
    let image = reader.decode().map_err(|error| library(error.to_string()))?.into_rgb32f();
    let (width, height) = (image.width() as usize, image.height() as usize);
    let texels = image.pixels().map(|pixel| pixel.0).collect();
    Environment::new(width, height, texels).map_err(|error| library(error.to_string()))
}
