//! Linear images.

use brdf_model::Rgb;

/// What a pixel of a film shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pixel {
    /// Nothing.
    Background,
    /// The object, where the material has no data.
    NoData,
    /// Radiance, linear RGB, and the share of the pixel that the object covers.
    Radiance(Rgb, f64),
}

/// Radiance per pixel, linear RGB, row-major from the top left.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    width: usize,
    pixels: Vec<Pixel>,
}

impl Film {
    /// A film from its pixels.
    ///
    /// # Panics
    ///
    /// Unless the pixels are whole rows.
    pub fn new(width: usize, pixels: Vec<Pixel>) -> Self {
        assert!(width > 0 && pixels.len().is_multiple_of(width), "pixels make whole rows");
        Self { width, pixels }
    }

    /// Pixels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.pixels.len() / self.width
    }

    /// The pixels, row by row.
    pub fn pixels(&self) -> &[Pixel] {
        &self.pixels
    }
}
