//! Linear images.

use brdf_model::Rgb;

/// The content of a pixel of a [`Film`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pixel {
    /// Nothing but background.
    Background,
    /// The object, where the material has no data.
    NoData,
    /// Radiance, linear RGB, and the share of the pixel that the object covers.
    Radiance(Rgb, f64),
}

/// A linear picture: radiance per pixel, linear RGB, row-major from the top left.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    width: usize,
    pixels: Vec<Pixel>,
}

impl Film {
    /// Returns a film made of its pixels, `width` in a row.
    ///
    /// ```
    /// use brdf_image::{Film, Pixel};
    ///
    /// let film = Film::new(3, vec![Pixel::Background; 6]);
    /// assert_eq!((film.width(), film.height()), (3, 2));
    /// ```
    ///
    /// # Panics
    ///
    /// Unless the pixels are whole rows.
    pub fn new(width: usize, pixels: Vec<Pixel>) -> Self {
        assert!(width > 0 && pixels.len().is_multiple_of(width), "pixels make whole rows");
        Self { width, pixels }
    }

    /// Returns the number of pixels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Returns the number of rows.
    pub fn height(&self) -> usize {
        self.pixels.len() / self.width
    }

    /// Returns the pixels, row by row from the top.
    pub fn pixels(&self) -> &[Pixel] {
        &self.pixels
    }
}
