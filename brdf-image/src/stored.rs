//! Display-referred images as their files store them: PNG and JPEG of 8 or 16 bits a channel.

use std::io::Cursor;

use png::{BitDepth, ColorType, Transformations};
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use crate::{ImageError, LONGEST_SIDE, check_claim};

/// An image as stored, before any curve is undone.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StoredImage {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Samples of a pixel: 1 for grey, 2 for grey and opacity, 3 for colour, 4 for colour and opacity.
    pub channels: usize,
    /// Samples of the pixels, row by row from the top.
    pub samples: Samples,
}

/// The samples of an image, all of one depth.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Samples {
    /// 8 bits or fewer, scaled to 8.
    Bytes(Vec<u8>),
    /// 16 bits.
    Words(Vec<u16>),
}

impl Samples {
    /// Returns the samples scaled to [0, 1].
    pub fn to_unit(&self) -> Vec<f32> {
        match self {
            Self::Bytes(bytes) => bytes.iter().map(|&byte| f32::from(byte) / 255.0).collect(),
            Self::Words(words) => words.iter().map(|&word| f32::from(word) / 65_535.0).collect(),
        }
    }

    /// Returns the samples in 8 bits; those of 16 are rounded.
    #[expect(clippy::cast_possible_truncation, reason = "at most (65535 + 128) / 257 = 255")]
    pub fn into_bytes(self) -> Vec<u8> {
        match self {
            Self::Bytes(bytes) => bytes,
            Self::Words(words) => {
                words.iter().map(|&word| ((u32::from(word) + 128) / 257) as u8).collect()
            }
        }
    }
}

/// Returns the width and height that the header of a PNG or JPEG claims, and that the file may hold.
///
/// # Errors
///
/// [`ImageError`] for anything else.
pub fn stored_size(bytes: &[u8]) -> Result<[usize; 2], ImageError> {
    if is_png(bytes) {
        png(bytes).map(|reader| png_size(&reader))
    } else {
        jpeg(bytes).map(|decoder| jpeg_size(&decoder))
    }
}

/// Returns the image of a PNG or JPEG. Palettes become colours; a JPEG becomes grey or RGB.
///
/// ```
/// use brdf_image::{DisplayImage, Samples, decode_stored, encode_png};
///
/// let image = decode_stored(&encode_png(&DisplayImage::filled(2, 1, [255, 0, 51]))?)?;
/// assert_eq!((image.width, image.height, image.channels), (2, 1, 3));
/// assert_eq!(image.samples, Samples::Bytes(vec![255, 0, 51, 255, 0, 51]));
/// # Ok::<(), brdf_image::ImageError>(())
/// ```
///
/// # Errors
///
/// [`ImageError`] for what is neither, for a damaged image, and for one whose header claims more than its file can
/// hold.
pub fn decode_stored(bytes: &[u8]) -> Result<StoredImage, ImageError> {
    if is_png(bytes) { decode_png(bytes) } else { decode_jpeg(bytes) }
}

fn is_png(bytes: &[u8]) -> bool {
    bytes.starts_with(b"\x89PNG\r\n\x1a\n")
}

fn png_error(problem: impl ToString) -> ImageError {
    ImageError::coder("PNG")(problem.to_string())
}

/// A reader that has read the header, whose size it held against the file.
fn png(bytes: &[u8]) -> Result<png::Reader<Cursor<&[u8]>>, ImageError> {
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(Transformations::EXPAND);
    let reader = decoder.read_info().map_err(png_error)?;
    check_claim(bytes.len(), png_size(&reader))?;
    Ok(reader)
}

fn png_size(reader: &png::Reader<Cursor<&[u8]>>) -> [usize; 2] {
    let (width, height) = reader.info().size();
    [width as usize, height as usize]
}

fn decode_png(bytes: &[u8]) -> Result<StoredImage, ImageError> {
    let mut reader = png(bytes)?;
    let [width, height] = png_size(&reader);
    let length = reader.output_buffer_size().ok_or_else(|| png_error("too large"))?;
    let mut samples = vec![0; length];
    reader.next_frame(&mut samples).map_err(png_error)?;
    let (color, depth) = reader.output_color_type();
    let channels = match color {
        ColorType::Grayscale => 1,
        ColorType::GrayscaleAlpha => 2,
        ColorType::Rgb => 3,
        ColorType::Rgba => 4,
        ColorType::Indexed => return Err(png_error("palette without colours")),
    };
    let samples = if depth == BitDepth::Sixteen {
        let pairs = samples.as_chunks().0.iter();
        Samples::Words(pairs.map(|pair| u16::from_be_bytes(*pair)).collect())
    } else {
        Samples::Bytes(samples)
    };
    Ok(StoredImage { width, height, channels, samples })
}

fn jpeg_error(problem: impl ToString) -> ImageError {
    // Some of the decoder's messages are quoted, some span lines.
    let problem = problem.to_string().replace(['\n', '"'], " ").trim().to_owned();
    ImageError::coder("JPEG")(problem)
}

/// A decoder that has read the header, whose size it held against the file.
fn jpeg(bytes: &[u8]) -> Result<JpegDecoder<ZCursor<&[u8]>>, ImageError> {
    // Strict: otherwise a damaged image comes out grey from where the damage is.
    let options = DecoderOptions::default()
        .set_strict_mode(true)
        .set_max_width(LONGEST_SIDE)
        .set_max_height(LONGEST_SIDE)
        .jpeg_set_out_colorspace(ColorSpace::RGB);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(jpeg_error)?;
    check_claim(bytes.len(), jpeg_size(&decoder))?;
    if decoder.input_colorspace() == Some(ColorSpace::Luma) {
        decoder.set_options(options.jpeg_set_out_colorspace(ColorSpace::Luma));
    }
    Ok(decoder)
}

fn jpeg_size(decoder: &JpegDecoder<ZCursor<&[u8]>>) -> [usize; 2] {
    decoder.dimensions().unwrap_or_default().into()
}

fn decode_jpeg(bytes: &[u8]) -> Result<StoredImage, ImageError> {
    let mut decoder = jpeg(bytes)?;
    let [width, height] = jpeg_size(&decoder);
    let samples = decoder.decode().map_err(jpeg_error)?;
    let channels = samples.len() / (width * height);
    if !matches!(channels, 1 | 3) {
        return Err(jpeg_error("other channels than grey or RGB"));
    }
    Ok(StoredImage { width, height, channels, samples: Samples::Bytes(samples) })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn encoded_png(size: [u32; 2], color: ColorType, depth: BitDepth, data: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, size[0], size[1]);
        encoder.set_color(color);
        encoder.set_depth(depth);
        encoder.write_header().unwrap().write_image_data(data).unwrap();
        bytes
    }

    fn encoded_jpeg(side: u16, color: jpeg_encoder::ColorType, data: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        jpeg_encoder::Encoder::new(&mut bytes, 95).encode(data, side, side, color).unwrap();
        bytes
    }

    #[test]
    fn depths_and_channels_are_read_as_stored() {
        let data = [0_u16, 20_000, 40_000, 0, 20_000, 40_000].map(u16::to_be_bytes).concat();
        let deep = encoded_png([3, 2], ColorType::Grayscale, BitDepth::Sixteen, &data);
        let image = decode_stored(&deep).unwrap();
        assert_eq!((image.width, image.height, image.channels), (3, 2, 1));
        assert_eq!(image.samples, Samples::Words(vec![0, 20_000, 40_000, 0, 20_000, 40_000]));
        assert_eq!(image.samples.into_bytes()[1], 78);

        let bits = encoded_png([8, 1], ColorType::Grayscale, BitDepth::One, &[0b1010_0000]);
        let samples = vec![255, 0, 255, 0, 0, 0, 0, 0];
        assert_eq!(decode_stored(&bits).unwrap().samples, Samples::Bytes(samples));

        let veiled = [51, 0].repeat(4);
        let veiled = encoded_png([2, 2], ColorType::GrayscaleAlpha, BitDepth::Eight, &veiled);
        let image = decode_stored(&veiled).unwrap();
        assert_eq!((image.channels, image.samples.to_unit()[0]), (2, 0.2));

        let grey = encoded_jpeg(8, jpeg_encoder::ColorType::Luma, &[102; 64]);
        let colour = encoded_jpeg(8, jpeg_encoder::ColorType::Rgb, &[255, 102, 0].repeat(64));
        for (bytes, channels) in [(grey, 1), (colour, 3)] {
            let image = decode_stored(&bytes).unwrap();
            assert_eq!(image.channels, channels);
            assert_eq!([image.width, image.height], stored_size(&bytes).unwrap());
            let green = image.samples.to_unit()[channels / 2 + channels];
            assert!((green - 0.4).abs() < 0.02, "{green}");
        }
    }

    #[test]
    fn other_and_damaged_content_is_refused() {
        assert!(decode_stored(b"not an image").is_err());
        let data: Vec<u8> = (0..4800_u32).map(|at| (at * at / 7).to_le_bytes()[0]).collect();
        let png = encoded_png([40, 40], ColorType::Rgb, BitDepth::Eight, &data);
        for bytes in [png, encoded_jpeg(40, jpeg_encoder::ColorType::Rgb, &data)] {
            assert!(decode_stored(&bytes).is_ok());
            assert!(decode_stored(&bytes[..bytes.len() / 2]).is_err());
        }
    }

    #[test]
    fn an_image_that_claims_to_be_huge_is_refused_before_memory_is_taken() {
        let mut bytes = encoded_png([1, 1], ColorType::Rgb, BitDepth::Eight, &[0; 3]);
        bytes[16..24].copy_from_slice(&[0, 1, 0, 0, 0, 1, 0, 0]); // 65,536 pixels a side
        assert!(decode_stored(&bytes).is_err());
    }
}
