//! Maps of heights, normals, roughness and albedo: PNG and JPEG, 8 or 16 bits a channel.

use std::path::Path;

use brdf_files::{FileError, MappedFile};
use brdf_image::decode_stored;
use brdf_io::FormatError;
use brdf_model::srgb_to_linear;
use btf_synth::Map;

use crate::error::image_error;

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
    let is_jpeg = bytes.starts_with(b"\xff\xd8\xff");
    if !is_jpeg && !bytes.starts_with(b"\x89PNG") {
        return Err(FormatError::Missing {
            what: "image".to_owned(),
            expected: "a PNG or JPEG".to_owned(),
        });
    }
    let image = decode_stored(bytes).map_err(image_error("image (PNG or JPEG)"))?;
    let values = image.samples.to_unit();
    let channel = |index: usize| {
        let plane = values.iter().skip(index).step_by(image.channels).copied().collect();
        Map::new(image.width, image.height, plane)
            .map_err(|error| FormatError::Library { what: "image", problem: error.to_string() })
    };
    // The last of two or four channels is opacity.
    (0..if image.channels < 3 { 1 } else { 3 }).map(channel).collect()
}

#[cfg(test)]
mod tests {
    use brdf_image::{DisplayImage, encode_png};

    use super::*;

    #[test]
    fn opacity_is_left_out_and_other_content_refused_in_words() {
        let mut veiled = Vec::new();
        let mut encoder = png::Encoder::new(&mut veiled, 1, 1);
        encoder.set_color(png::ColorType::GrayscaleAlpha);
        encoder.write_header().unwrap().write_image_data(&[51, 0]).unwrap();
        let maps = parse_map(&veiled).unwrap();
        assert_eq!((maps.len(), maps[0].values()), (1, &[0.2][..]));

        let coloured = encode_png(&DisplayImage::filled(2, 2, [255, 102, 0])).unwrap();
        let maps = parse_map(&coloured).unwrap();
        assert_eq!((maps.len(), maps[1].values()[3]), (3, 0.4));
        assert!(parse_map(&coloured[..coloured.len() / 2]).is_err());
        let text = parse_map(b"not an image").unwrap_err().to_string();
        assert_eq!(text, "no image; expected a PNG or JPEG");
    }
}
