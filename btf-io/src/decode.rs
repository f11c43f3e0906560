//! One image of a BTF: recognized by its first bytes and decoded to three channels.

use std::io::Cursor;

use brdf_image::{ImageError, LONGEST_SIDE, check_claim};
use half::f16;
use half::slice::HalfFloatSliceExt as _;
use png::{BitDepth, ColorType, Transformations};
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use crate::exr_picture::{exr_size, read_exr};
use crate::linear::halves;
use crate::rgbe::{read_rgbe, read_rgbe_header};
use brdf_io::FormatError;
use brdf_io::quoted;

/// Kinds of images.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ImageKind {
    Jpeg,
    Png,
    Radiance,
    Exr,
}

impl ImageKind {
    /// Recognizes an image by its first bytes.
    pub(crate) fn of(bytes: &[u8]) -> Result<Self, FormatError> {
        let starts = |magic: &[u8]| bytes.starts_with(magic);
        match () {
            () if starts(b"\xff\xd8\xff") => Ok(Self::Jpeg),
            () if starts(b"\x89PNG\r\n\x1a\n") => Ok(Self::Png),
            () if starts(b"#?") => Ok(Self::Radiance),
            () if starts(&[0x76, 0x2f, 0x31, 0x01]) => Ok(Self::Exr),
            () => Err(FormatError::Missing {
                what: format!("image: it starts with {}", start(bytes)),
                expected: "JPEG, PNG, Radiance HDR or OpenEXR".to_owned(),
            }),
        }
    }

    /// Whether values are linear.
    pub(crate) fn is_linear(self) -> bool {
        match self {
            Self::Jpeg | Self::Png => false,
            Self::Radiance | Self::Exr => true,
        }
    }
}

fn start(bytes: &[u8]) -> String {
    quoted(&String::from_utf8_lossy(&bytes[..bytes.len().min(12)]))
}

/// Width and height that the header of an image claims, and that the file may hold.
pub(crate) fn image_size(bytes: &[u8]) -> Result<[usize; 2], FormatError> {
    let size = match ImageKind::of(bytes)? {
        ImageKind::Jpeg => jpeg(bytes).map(|decoder| jpeg_size(&decoder)),
        ImageKind::Png => png(bytes).map(|reader| png_size(&reader)),
        ImageKind::Radiance => read_rgbe_header(bytes).map(|header| header.size),
        ImageKind::Exr => exr_size(bytes),
    }?;
    check_size(bytes, size)?;
    Ok(size)
}

/// Reads one image and returns its width, height and texels, row by row from the top, three channels each.
///
/// Values are in [0, 1] as sRGB has them if the image has 8 or 16 bits, else linear.
///
/// ```
/// use brdf_image::{DisplayImage, encode_png};
///
/// let png = encode_png(&DisplayImage::filled(2, 1, [255, 0, 51]))?;
/// let (size, texels) = btf_io::read_btf_image(&png)?;
/// assert_eq!((size, &texels[..3]), ([2, 1], &[1.0, 0.0, 0.2][..]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
///
/// [`FormatError`] for what is no image, a damaged one, and values that half precision cannot hold.
pub fn read_btf_image(bytes: &[u8]) -> Result<([usize; 2], Vec<f32>), FormatError> {
    let size = image_size(bytes)?;
    let values = 3 * size[0] * size[1];
    let values = if ImageKind::of(bytes)?.is_linear() {
        let mut halves = vec![f16::ZERO; values];
        decode_image(bytes, bytemuck::cast_slice_mut(&mut halves))?;
        halves.to_f32_vec()
    } else {
        let mut stored = vec![0; values];
        decode_image(bytes, &mut stored)?;
        stored.iter().map(|&byte| f32::from(byte) / 255.0).collect()
    };
    Ok((size, values))
}

/// Decodes an image of any kind into room for its [`image_size`]: texels row by row from the top, three
/// values each, bytes of display-referred images and halves in the machine's byte order of linear
/// ones. Returns how many linear values were below zero and became zero.
pub(crate) fn decode_image(bytes: &[u8], out: &mut [u8]) -> Result<u64, FormatError> {
    match ImageKind::of(bytes)? {
        ImageKind::Jpeg => decode_jpeg(bytes, out).map(|()| 0),
        ImageKind::Png => fill(out, &decode_png(bytes)?).map(|()| 0),
        ImageKind::Radiance => {
            let header = read_rgbe_header(bytes)?;
            check_size(bytes, header.size)?;
            let (halves, negative) = halves(&read_rgbe(bytes, &header)?, header.size[0])?;
            fill(out, bytemuck::cast_slice(&halves)).map(|()| negative)
        }
        ImageKind::Exr => {
            let size = exr_size(bytes)?;
            check_size(bytes, size)?;
            let (halves, negative) = halves(&read_exr(bytes)?, size[0])?;
            fill(out, bytemuck::cast_slice(&halves)).map(|()| negative)
        }
    }
}

/// Copies, if the picture is as large as its header said.
fn fill(out: &mut [u8], values: &[u8]) -> Result<(), FormatError> {
    if out.len() != values.len() {
        let hint = " as the header says";
        return Err(FormatError::Size { found: values.len(), expected: out.len(), hint });
    }
    out.copy_from_slice(values);
    Ok(())
}

/// Decoders make room for what a header claims, so the claim is held against the file first.
fn check_size(bytes: &[u8], size: [usize; 2]) -> Result<(), FormatError> {
    check_claim(bytes.len(), size).map_err(image_error("image"))
}

/// What a decoder of pictures says, as a problem of the file.
pub(crate) fn image_error(what: &'static str) -> impl Fn(ImageError) -> FormatError {
    move |error| match error {
        ImageError::Coder { what, problem } => FormatError::Library { what, problem },
        ImageError::Claim { found, expected } => {
            FormatError::Size { found, expected, hint: " or more for the size its header claims" }
        }
        other => FormatError::Library { what, problem: other.to_string() },
    }
}

fn jpeg_error(problem: impl ToString) -> FormatError {
    // Some of the decoder's messages are quoted, some span lines.
    let problem = problem.to_string().replace(['\n', '"'], " ").trim().to_owned();
    FormatError::Library { what: "JPEG", problem }
}

/// A decoder that has read the header, whose size it held against the file.
fn jpeg(bytes: &[u8]) -> Result<JpegDecoder<ZCursor<&[u8]>>, FormatError> {
    // Strict: otherwise a damaged image comes out grey from where the damage is.
    let options = DecoderOptions::default()
        .set_strict_mode(true)
        .set_max_width(LONGEST_SIDE)
        .set_max_height(LONGEST_SIDE)
        .jpeg_set_out_colorspace(ColorSpace::RGB);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(jpeg_error)?;
    check_size(bytes, jpeg_size(&decoder))?;
    Ok(decoder)
}

fn jpeg_size(decoder: &JpegDecoder<ZCursor<&[u8]>>) -> [usize; 2] {
    decoder.dimensions().unwrap_or_default().into()
}

fn decode_jpeg(bytes: &[u8], out: &mut [u8]) -> Result<(), FormatError> {
    let mut decoder = jpeg(bytes)?;
    if decoder.output_buffer_size() != Some(out.len()) {
        return Err(jpeg_error("other channels than grey or RGB"));
    }
    decoder.decode_into(out).map_err(jpeg_error)
}

fn png_error(problem: impl ToString) -> FormatError {
    FormatError::Library { what: "PNG", problem: problem.to_string() }
}

/// A reader that has read the header, whose size it held against the file.
fn png(bytes: &[u8]) -> Result<png::Reader<Cursor<&[u8]>>, FormatError> {
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(Transformations::EXPAND);
    let reader = decoder.read_info().map_err(png_error)?;
    check_size(bytes, png_size(&reader))?;
    Ok(reader)
}

fn png_size(reader: &png::Reader<Cursor<&[u8]>>) -> [usize; 2] {
    let (width, height) = reader.info().size();
    [width as usize, height as usize]
}

fn decode_png(bytes: &[u8]) -> Result<Vec<u8>, FormatError> {
    let mut reader = png(bytes)?;
    let length = reader.output_buffer_size().ok_or_else(|| png_error("too large"))?;
    let mut values = vec![0; length];
    reader.next_frame(&mut values).map_err(png_error)?;
    let (color, depth) = reader.output_color_type();
    if depth == BitDepth::Sixteen {
        values = narrowed(&values);
    }
    Ok(match color {
        ColorType::Rgb => values,
        ColorType::Grayscale => values.iter().flat_map(|&grey| [grey; 3]).collect(),
        ColorType::GrayscaleAlpha => {
            opaque::<2>(&values)?.flat_map(|[grey, _]| [*grey; 3]).collect()
        }
        ColorType::Rgba => opaque::<4>(&values)?.flat_map(|[r, g, b, _]| [*r, *g, *b]).collect(),
        ColorType::Indexed => return Err(png_error("palette without colours")),
    })
}

/// 16-bit values, big-endian, rounded to 8 bits.
#[expect(clippy::cast_possible_truncation, reason = "at most (65535 + 128) / 257 = 255")]
fn narrowed(values: &[u8]) -> Vec<u8> {
    let wide = values.as_chunks::<2>().0.iter().map(|pair| u32::from(u16::from_be_bytes(*pair)));
    wide.map(|value| ((value + 128) / 257) as u8).collect()
}

/// Texels with alpha, all of which must be opaque: what lies behind a texel nobody knows.
fn opaque<const N: usize>(values: &[u8]) -> Result<impl Iterator<Item = &[u8; N]>, FormatError> {
    let texels = values.as_chunks::<N>().0;
    match texels.iter().position(|texel| texel[N - 1] != 255) {
        Some(at) => Err(png_error(format!("texel {at} is transparent"))),
        None => Ok(texels.iter()),
    }
}
