//! From radiance to pictures: exposure, sRGB transfer, and what was clipped.

use brdf_model::{Rgb, encode_srgb};

use crate::film::{Film, Pixel};

/// An 8-bit sRGB picture, row-major from the top left.
///
/// ```
/// use brdf_image::DisplayImage;
///
/// let mut sheet = DisplayImage::filled(4, 2, [0, 0, 0]);
/// sheet.paste(&DisplayImage::filled(2, 2, [255, 0, 0]), 3, 0);
/// assert_eq!(sheet.pixel(3, 1), [255, 0, 0]);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DisplayImage {
    width: usize,
    bytes: Vec<u8>,
}

impl DisplayImage {
    /// Returns a picture of one colour.
    pub fn filled(width: usize, height: usize, colour: [u8; 3]) -> Self {
        Self { width: width.max(1), bytes: colour.repeat(width.max(1) * height) }
    }

    /// Returns the number of pixels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Returns the number of rows.
    pub fn height(&self) -> usize {
        self.bytes.len() / (3 * self.width)
    }

    /// Returns red, green and blue of every pixel, row by row.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Returns the pixel at a column and row.
    ///
    /// # Panics
    ///
    /// Outside the picture.
    pub fn pixel(&self, column: usize, row: usize) -> [u8; 3] {
        let at = 3 * (row * self.width + column);
        [self.bytes[at], self.bytes[at + 1], self.bytes[at + 2]]
    }

    /// Sets the pixel at a column and row; outside the picture, nothing happens.
    pub fn set(&mut self, column: usize, row: usize, colour: [u8; 3]) {
        if column < self.width && row < self.height() {
            let at = 3 * (row * self.width + column);
            self.bytes[at..at + 3].copy_from_slice(&colour);
        }
    }

    /// Copies a picture to a place in this one; what sticks out is cut.
    pub fn paste(&mut self, picture: &Self, left: usize, top: usize) {
        for row in 0..picture.height() {
            for column in 0..picture.width {
                self.set(left + column, top + row, picture.pixel(column, row));
            }
        }
    }
}

/// An exposure, followed by the sRGB transfer function. There is no curve and no bloom; what is too bright is
/// clipped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToneMap {
    /// Factor by which linear values are multiplied.
    pub exposure: f64,
}

/// Behind the object.
const BACKGROUND: [u8; 3] = [24, 24, 27];
/// Squares that mark missing data.
const NO_DATA: [[u8; 3]; 2] = [[90, 40, 110], [120, 60, 140]];
/// The share of pixels that an automatic exposure leaves unclipped.
const UNCLIPPED: f64 = 0.99;

impl ToneMap {
    /// Returns the exposure that shows 99 % of the object's pixels unclipped.
    pub fn exposed_for(film: &Film) -> Self {
        let mut brightest: Vec<f64> = film
            .pixels()
            .iter()
            .filter_map(|pixel| match pixel {
                Pixel::Radiance(rgb, _) => Some(rgb.max_channel()),
                _ => None,
            })
            .collect();
        brightest.sort_by(f64::total_cmp);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "an index into the list"
        )]
        let index = (UNCLIPPED * brightest.len().saturating_sub(1) as f64) as usize;
        let level = brightest.get(index).copied().unwrap_or(1.0);
        Self { exposure: if level > 0.0 { 1.0 / level } else { 1.0 } }
    }

    /// Returns the picture of a film. Pixels without data are chequered.
    pub fn apply(&self, film: &Film) -> DisplayImage {
        let mut picture = DisplayImage::filled(film.width(), film.height(), BACKGROUND);
        for (index, pixel) in film.pixels().iter().enumerate() {
            let (column, row) = (index % film.width(), index / film.width());
            match *pixel {
                Pixel::Background => {}
                Pixel::NoData => {
                    picture.set(column, row, NO_DATA[(column / 4 + row / 4) % 2]);
                }
                Pixel::Radiance(rgb, cover) => {
                    let shown = (rgb * self.exposure).map(encode_srgb).channels();
                    let blend = |value: f64, behind: u8| {
                        to_byte(cover * value + (1.0 - cover) * f64::from(behind) / 255.0)
                    };
                    let behind = BACKGROUND;
                    picture.set(column, row, std::array::from_fn(|c| blend(shown[c], behind[c])));
                }
            }
        }
        picture
    }

    /// Returns the share of the object's pixels with a channel above what can be shown.
    pub fn clipped_share(&self, film: &Film) -> f64 {
        let (mut clipped, mut total) = (0_u32, 0_u32);
        for pixel in film.pixels() {
            if let Pixel::Radiance(rgb, _) = pixel {
                total += 1;
                clipped += u32::from(rgb.max_channel() * self.exposure > 1.0);
            }
        }
        f64::from(clipped) / f64::from(total.max(1))
    }
}

/// Returns the sRGB bytes of a linear colour, clipped.
///
/// ```
/// use brdf_model::Rgb;
///
/// assert_eq!(brdf_image::srgb_bytes(Rgb::new(0.0, 0.2140, 2.0)), [0, 127, 255]);
/// ```
pub fn srgb_bytes(linear: Rgb) -> [u8; 3] {
    linear.channels().map(|v| to_byte(encode_srgb(v)))
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to a byte")]
fn to_byte(value: f64) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0).round() as u8
}
