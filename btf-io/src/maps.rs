//! Maps of heights, normals, roughness and albedo: PNG and JPEG, 8 or 16 bits a channel.

use std::io::Cursor;
use std::path::Path;

use brdf_model::srgb_to_linear;
use btf_synth::Map;
use image::{DynamicImage, ImageReader, Limits};

use brdf_files::{FileError, MappedFile};
use brdf_io::FormatError;

/// Largest map that is read.
const MAX_SIDE: u32 = 16_384;
const MAX_BYTES: u64 = 2 << 30;

/// Reads the channels of an image as they are stored, scaled to [0, 1]: one of a grey image, three of a coloured
/// one. Opacity is left out.
///
/// # Errors
///
/// [`FileError::File`]; [`FileError::Content`] for content that is no PNG or JPEG, or too large.
pub fn read_map(path: &Path) -> Result<Vec<Map>, FileError> {
    let bytes = MappedFile::open(path)?;
    parse_map(&bytes).map_err(FileError::content(path))
}

/// Reads an sRGB-encoded image as linear red, green and blue; of a grey image all three are the same.
///
/// # Errors
///
/// As [`read_map`].
pub fn read_albedo(path: &Path) -> Result<[Map; 3], FileError> {
    let linear = |map: &Map| {
        let values = map.values().iter().map(|&value| srgb_to_linear(value)).collect();
        Map::new(map.width(), map.height(), values)
    };
    let channels = read_map(path)?;
    let maps: Result<Vec<Map>, _> = channels.iter().map(linear).collect();
    let refused = |error: btf_synth::SynthError| {
        FileError::content(path)(FormatError::Library { what: "image", problem: error.to_string() })
    };
    let mut maps = maps.map_err(refused)?.into_iter();
    match (maps.next(), maps.next(), maps.next()) {
        (Some(red), Some(green), Some(blue)) => Ok([red, green, blue]),
        (Some(grey), ..) => Ok([grey.clone(), grey.clone(), grey]),
        _ => Err(FileError::content(path)(FormatError::Missing {
            what: "channel".to_owned(),
            expected: "one or three".to_owned(),
        })),
    }
}

fn parse_map(bytes: &[u8]) -> Result<Vec<Map>, FormatError> {
    let refused = |problem: String| FormatError::Library { what: "image (PNG or JPEG)", problem };
    let mut reader = ImageReader::new(Cursor::new(bytes))
        .with_guessed_format()
        .map_err(|error| refused(error.to_string()))?;
    match reader.format() {
        Some(image::ImageFormat::Png | image::ImageFormat::Jpeg) => {}
        _ => {
            return Err(FormatError::Missing {
                what: "image".to_owned(),
                expected: "a PNG or JPEG".to_owned(),
            });
        }
    }
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    limits.max_alloc = Some(MAX_BYTES);
    reader.limits(limits);
    channels(reader.decode().map_err(|error| refused(error.to_string()))?)
}

fn channels(image: DynamicImage) -> Result<Vec<Map>, FormatError> {
    let [width, height] = [image.width() as usize, image.height() as usize];
    let is_grey = !image.color().has_color();
    // Both ways scale by the largest value that the depth holds.
    let (count, values) = if is_grey {
        (1, image.into_luma16().into_raw())
    } else {
        (3, image.into_rgb16().into_raw())
    };
    let channel = |index: usize| {
        let scaled = |value: &u16| f32::from(*value) / f32::from(u16::MAX);
        let plane = values.iter().skip(index).step_by(count).map(scaled).collect();
        Map::new(width, height, plane)
            .map_err(|error| FormatError::Library { what: "image", problem: error.to_string() })
    };
    (0..count).map(channel).collect()
}

#[cfg(test)]
mod tests {
    use image::{GrayAlphaImage, ImageBuffer, ImageFormat, Luma, LumaA, Rgb, RgbImage};

    use super::*;

    fn encoded(image: impl Into<DynamicImage>, format: ImageFormat) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        image.into().write_to(&mut bytes, format).unwrap();
        bytes.into_inner()
    }

    #[test]
    fn depths_and_channels_are_read_as_stored() {
        let deep = ImageBuffer::from_fn(3, 2, |x, _| Luma([u16::try_from(x).unwrap() * 20_000]));
        let maps = parse_map(&encoded(deep, ImageFormat::Png)).unwrap();
        assert_eq!((maps.len(), maps[0].width(), maps[0].height()), (1, 3, 2));
        assert!((maps[0].values()[2] - 40_000.0 / 65_535.0).abs() < 1e-7);

        let veiled = GrayAlphaImage::from_pixel(2, 2, LumaA([51, 0]));
        let maps = parse_map(&encoded(veiled, ImageFormat::Png)).unwrap();
        assert_eq!((maps.len(), maps[0].values()[0]), (1, 0.2));

        let colour = RgbImage::from_pixel(8, 8, Rgb([255, 102, 0]));
        let maps = parse_map(&encoded(colour, ImageFormat::Jpeg)).unwrap();
        assert_eq!(maps.len(), 3);
        assert!((maps[1].values()[9] - 0.4).abs() < 0.02);
    }

    #[test]
    fn other_content_is_refused_in_words() {
        let text = parse_map(b"not an image").unwrap_err().to_string();
        assert_eq!(text, "no image; expected a PNG or JPEG");
        let colour = RgbImage::from_pixel(8, 8, Rgb([255, 102, 0]));
        let bytes = encoded(colour, ImageFormat::Png);
        assert!(parse_map(&bytes[..bytes.len() / 2]).is_err());
    }

    #[test]
    fn an_image_that_claims_to_be_huge_is_refused_before_memory_is_taken() {
        let mut bytes = encoded(RgbImage::new(1, 1), ImageFormat::Png);
        bytes[16..24].copy_from_slice(&[0, 1, 0, 0, 0, 1, 0, 0]); // 65,536 texels a side
        assert!(parse_map(&bytes).is_err());
    }
}
