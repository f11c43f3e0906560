//! One image of a BTF: recognized by its first bytes and decoded to three channels.

use brdf_image::{StoredImage, check_claim, decode_hdr, decode_stored, hdr_size, stored_size};
use half::f16;
use half::slice::HalfFloatSliceExt as _;

use crate::error::image_error;
use crate::exr_picture::{exr_size, read_exr};
use crate::linear::halves;
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
        ImageKind::Jpeg | ImageKind::Png => stored_size(bytes).map_err(image_error("image")),
        ImageKind::Radiance => hdr_size(bytes).map_err(image_error("image")),
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
        ImageKind::Jpeg | ImageKind::Png => {
            let image = decode_stored(bytes).map_err(image_error("image"))?;
            fill(out, &rgb_bytes(image)?).map(|()| 0)
        }
        ImageKind::Radiance => {
            let image = decode_hdr(bytes).map_err(image_error("image"))?;
            let (halves, negative) = halves(image.pixels.as_flattened(), image.width)?;
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

/// Three bytes for each texel.
fn rgb_bytes(image: StoredImage) -> Result<Vec<u8>, FormatError> {
    let bytes = image.samples.into_bytes();
    Ok(match image.channels {
        1 => bytes.iter().flat_map(|&grey| [grey; 3]).collect(),
        2 => opaque::<2>(&bytes)?.flat_map(|[grey, _]| [*grey; 3]).collect(),
        4 => opaque::<4>(&bytes)?.flat_map(|[r, g, b, _]| [*r, *g, *b]).collect(),
        _ => bytes,
    })
}

/// Texels with alpha, all of which must be opaque: what lies behind a texel nobody knows.
fn opaque<const N: usize>(values: &[u8]) -> Result<impl Iterator<Item = &[u8; N]>, FormatError> {
    let texels = values.as_chunks::<N>().0;
    match texels.iter().position(|texel| texel[N - 1] != 255) {
        Some(at) => {
            Err(FormatError::Library { what: "PNG", problem: format!("texel {at} is transparent") })
        }
        None => Ok(texels.iter()),
    }
}
