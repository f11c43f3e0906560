//! Pictures that people make: PNG, JPEG and EXR with opacity, as linear values.

use brdf_model::srgb_to_linear;

use crate::exr::{exr_error, exr_size, read_exr_layer};
use crate::{ImageError, check_claim, decode_stored};

/// A linear picture with opacity.
#[derive(Clone, Debug, PartialEq)]
pub struct RgbaPicture {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Linear red, green and blue, not multiplied by opacity, and opacity; row by row from the top.
    pub pixels: Vec<[f32; 4]>,
}

/// The channels of an EXR image by name, each row-major from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct ExrPlanes {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Name and values of each channel.
    pub channels: Vec<(String, Vec<f32>)>,
}

impl ExrPlanes {
    /// Returns the values of a channel, or `None` if there is no such channel.
    pub fn channel(&self, name: &str) -> Option<&[f32]> {
        let found = self.channels.iter().find(|(own, _)| own == name);
        found.map(|(_, values)| values.as_slice())
    }
}

/// Returns the picture of a PNG or JPEG of 8 or 16 bits, taken as sRGB, or of a linear EXR. Where the file has no
/// opacity, all of it is opaque.
///
/// ```
/// use brdf_image::{DisplayImage, decode_picture, encode_png};
///
/// let red = decode_picture(&encode_png(&DisplayImage::filled(2, 2, [255, 0, 0]))?)?;
/// assert_eq!(red.pixels[3], [1.0, 0.0, 0.0, 1.0]);
/// # Ok::<(), brdf_image::ImageError>(())
/// ```
///
/// # Errors
///
/// [`ImageError`] for anything else.
pub fn decode_picture(bytes: &[u8]) -> Result<RgbaPicture, ImageError> {
    if bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        decode_exr_picture(bytes)
    } else {
        decode_display_picture(bytes)
    }
}

fn decode_exr_picture(bytes: &[u8]) -> Result<RgbaPicture, ImageError> {
    let planes = exr_planes(bytes)?;
    let grey = planes.channel("Y");
    let colour = |name: &str| {
        planes.channel(name).or(grey).ok_or_else(|| ImageError::Channel {
            channel: name.to_owned(),
            expected: "R, G, B, or Y, and perhaps A",
        })
    };
    let (red, green, blue) = (colour("R")?, colour("G")?, colour("B")?);
    let alpha = planes.channel("A");
    // EXR holds colours times coverage.
    let pixels = (0..planes.width * planes.height).map(|at| {
        let a = alpha.map_or(1.0, |alpha| alpha[at]);
        let scale = if a > 0.0 { a.recip() } else { 0.0 };
        [scale * red[at], scale * green[at], scale * blue[at], a]
    });
    Ok(RgbaPicture { width: planes.width, height: planes.height, pixels: pixels.collect() })
}

fn decode_display_picture(bytes: &[u8]) -> Result<RgbaPicture, ImageError> {
    let image = decode_stored(bytes)?;
    let samples = image.samples.to_unit();
    let pixels = samples.chunks_exact(image.channels).map(|pixel| {
        let colour = |index: usize| srgb_to_linear(pixel[index]);
        match *pixel {
            [_] => [colour(0), colour(0), colour(0), 1.0],
            [_, a] => [colour(0), colour(0), colour(0), a],
            [_, _, _] => [colour(0), colour(1), colour(2), 1.0],
            _ => [colour(0), colour(1), colour(2), pixel[3]],
        }
    });
    Ok(RgbaPicture { width: image.width, height: image.height, pixels: pixels.collect() })
}

/// Returns the channels of an EXR image.
///
/// # Errors
///
/// [`ImageError`] for what is no EXR image, or has subsampled channels.
pub fn exr_planes(bytes: &[u8]) -> Result<ExrPlanes, ImageError> {
    let [width, height] = exr_size(bytes)?;
    check_claim(bytes.len(), [width, height])?;
    let layer = read_exr_layer(bytes)?;
    let channels: Vec<(String, Vec<f32>)> = layer
        .channel_data
        .list
        .iter()
        .map(|channel| {
            (channel.name.to_string(), channel.sample_data.values_as_f32().collect::<Vec<f32>>())
        })
        .collect();
    match channels.iter().find(|(_, values)| values.len() != width * height) {
        Some((name, _)) => Err(exr_error(format!("channel {name} is subsampled"))),
        None => Ok(ExrPlanes { width, height, channels }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::encode_exr;

    #[test]
    fn pictures_are_linear_and_keep_their_coverage() {
        let channels = [
            ("A", vec![1.0, 0.0]),
            ("B", vec![1.0, 0.0]),
            ("G", vec![0.5, 0.0]),
            ("R", vec![0.25, 0.0]),
        ];
        let exr = decode_picture(&encode_exr(2, 1, &channels).unwrap()).unwrap();
        assert_eq!(exr.pixels, [[0.25, 0.5, 1.0, 1.0], [0.0; 4]]);
        let mut png = Vec::new();
        let mut encoder = png::Encoder::new(&mut png, 2, 1);
        encoder.set_color(png::ColorType::Rgba);
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(&[188, 188, 188, 255, 9, 9, 9, 0]).unwrap();
        drop(writer);
        let read = decode_picture(&png).unwrap();
        assert!((read.pixels[0][0] - 0.5).abs() < 0.01 && read.pixels[1][3] == 0.0, "{read:?}");
        assert!(decode_picture(b"no picture").is_err() && exr_planes(&png).is_err());
    }
}
