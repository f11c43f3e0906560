//! Factor textures to look at.

use brdf_factor::Factor;
use brdf_model::{Channels, Rgb};

use brdf_image::{DisplayImage, srgb_bytes};

/// The colour of texels outside the mask: the yellow of the thesis' figures.
pub const MASKED_OUT: [u8; 3] = [230, 190, 40];

/// Side of the picture in pixels; texels become squares of equal size.
pub(crate) const SIDE: usize = 256;

/// A factor's texels, exponentiated and scaled so that each channel's largest value shows as white,
/// with v upwards. One-dimensional factors become a band.
pub fn texture_view(factor: &Factor, channels: Channels) -> DisplayImage {
    let grid = factor.grid();
    let mask = factor.mask();
    let value = |texel: usize| {
        let [r, g, b, _] = factor.texels()[texel].map(|log| f64::from(log).exp());
        match channels {
            Channels::Rgb => Rgb::new(r, g, b),
            Channels::Luminance => Rgb::splat(r),
        }
    };
    let white = (0..grid.texels())
        .filter(|&texel| mask[texel])
        .map(value)
        .fold(Rgb::splat(f64::MIN_POSITIVE), |best, v| best.zip(v, f64::max));
    let (columns, rows) = (grid.columns, grid.rows);
    let zoom = (SIDE / columns.max(rows)).max(1);
    let height = if rows == 1 { 32 } else { rows * zoom };
    let mut picture = DisplayImage::filled(columns * zoom, height, MASKED_OUT);
    for row in 0..height {
        let v = if rows == 1 { 0 } else { rows - 1 - row / zoom };
        for column in 0..columns * zoom {
            let texel = v * columns + column / zoom;
            if mask[texel] {
                picture.set(column, row, srgb_bytes(value(texel).zip(white, |v, w| v / w)));
            }
        }
    }
    picture
}
