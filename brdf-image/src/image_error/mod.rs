//! How far two pictures are apart, for the eye.
//!
//! Pictures are linear Rec. 709; 1 shows as white, at 203 cd/m² where a measure needs that (the
//! reference white of ITU-R BT.2408). PSNR, SSIM and ꟻLIP see them clipped and sRGB-encoded, as a
//! display shows them; ΔE_ITP sees highlights up to 10,000 cd/m².

mod delta_e_itp;
mod fast_ssim;
mod filter;
mod flip;
mod ssim;

use brdf_model::encode_srgb;
use serde::{Deserialize, Serialize};

pub use delta_e_itp::delta_e_itp_map;
pub use fast_ssim::SsimWorkspace;
pub use flip::{PIXELS_PER_DEGREE, flip_map};
pub use ssim::ssim_map;

use crate::film::{Film, Pixel};

/// A picture of three planes, each row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Planes {
    /// Pixels in a row.
    pub width: usize,
    /// Values of red, green and blue.
    pub channels: [Vec<f64>; 3],
}

impl Planes {
    /// Returns the number of pixels.
    pub fn len(&self) -> usize {
        self.channels[0].len()
    }

    /// Returns whether there are no pixels.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the number of rows.
    pub fn height(&self) -> usize {
        self.len() / self.width.max(1)
    }

    /// Returns the picture with `f` applied to every value.
    pub fn map(&self, f: impl Fn(f64) -> f64) -> Self {
        let channels = self.channels.each_ref().map(|plane| plane.iter().map(|v| f(*v)).collect());
        Self { width: self.width, channels }
    }

    /// A function of every pixel.
    pub(crate) fn map_pixels(&self, f: impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        let mut out = self.clone();
        for index in 0..self.len() {
            let value = f(self.pixel(index));
            for (plane, value) in out.channels.iter_mut().zip(value) {
                plane[index] = value;
            }
        }
        out
    }

    /// Returns the three channels of a pixel.
    pub fn pixel(&self, index: usize) -> [f64; 3] {
        self.channels.each_ref().map(|plane| plane[index])
    }
}

/// Measures of how far two pictures of an object are apart, over its pixels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ImageErrors {
    /// Peak signal-to-noise ratio of sRGB values, decibels; none where they are equal.
    pub psnr_db: Option<f64>,
    /// Mean structural similarity of sRGB channels: 1 where equal. Wang et al. 2004.
    pub ssim: f64,
    /// Mean ꟻLIP error: 0 where equal, at most 1. Andersson et al. 2020.
    pub flip: f64,
    /// Mean ΔE_ITP: 1 is just noticeable. ITU-R BT.2124.
    pub delta_e_itp: f64,
    /// Pixels of the object that one of the pictures has no data for; they are left out.
    pub without_data: usize,
}

/// Compares two films by four measures, at an exposure that shows linear `1 / exposure` as white.
///
/// ```
/// use brdf_image::{Film, Pixel, image_errors};
/// use brdf_model::Rgb;
///
/// let film = Film::new(16, vec![Pixel::Radiance(Rgb::splat(0.3), 1.0); 256]);
/// let errors = image_errors(&film, &film, 1.0);
/// assert_eq!(errors.psnr_db, None, "equal pictures");
/// assert!((errors.ssim - 1.0).abs() < 1e-9 && errors.flip < 1e-9);
/// ```
///
/// # Panics
///
/// Unless both have the same size.
pub fn image_errors(reference: &Film, model: &Film, exposure: f64) -> ImageErrors {
    assert_eq!(
        (reference.width(), reference.height()),
        (model.width(), model.height()),
        "films of the same size"
    );
    let known = |pixel: &Pixel| matches!(pixel, Pixel::Radiance(..));
    let pixels = || reference.pixels().iter().zip(model.pixels());
    let mask: Vec<bool> = pixels().map(|(a, b)| known(a) && known(b)).collect();
    let without_data =
        pixels().filter(|(a, b)| **a == Pixel::NoData || **b == Pixel::NoData).count();
    // What is left out is black in both.
    let planes = |film: &Film| {
        let value = |(index, pixel): (usize, &Pixel)| match pixel {
            Pixel::Radiance(rgb, cover) if mask[index] => (*rgb * (exposure * cover)).channels(),
            _ => [0.0; 3],
        };
        let values: Vec<[f64; 3]> = film.pixels().iter().enumerate().map(value).collect();
        Planes {
            width: film.width(),
            channels: std::array::from_fn(|c| values.iter().map(|v| v[c]).collect()),
        }
    };
    let linear = [planes(reference), planes(model)];
    let shown = linear.each_ref().map(|picture| picture.map(encode_srgb));
    let mean = |map: &[f64]| {
        let (sum, count) = map
            .iter()
            .zip(&mask)
            .filter(|(_, inside)| **inside)
            .fold((0.0, 0.0_f64), |(sum, count), (value, _)| (sum + value, count + 1.0));
        sum / count.max(1.0)
    };
    ImageErrors {
        psnr_db: psnr_db(&shown[0], &shown[1], &mask),
        ssim: mean(&ssim_map(&shown[0], &shown[1])),
        flip: mean(&flip_map(&shown[0], &shown[1], PIXELS_PER_DEGREE)),
        delta_e_itp: mean(&delta_e_itp_map(&linear[0], &linear[1])),
        without_data,
    }
}

/// Returns the peak signal-to-noise ratio over the channels of masked pixels, 10 log10(1 / mean square difference)
/// in decibels, or `None` where they are equal.
pub fn psnr_db(a: &Planes, b: &Planes, mask: &[bool]) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0.0_f64);
    for index in (0..a.len()).filter(|&i| mask[i]) {
        for (x, y) in a.pixel(index).into_iter().zip(b.pixel(index)) {
            sum += (x - y).powi(2);
            count += 1.0;
        }
    }
    (sum > 0.0).then(|| 10.0 * (count / sum).log10())
}
