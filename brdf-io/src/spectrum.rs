//! Reflectance spectra to linear RGB.

use std::sync::LazyLock;

use brdf_model::Rgb;

/// Colour-matching functions times D65 at 380, 381 … 780 nm.
static LIT_OBSERVER: LazyLock<Vec<[f64; 3]>> = LazyLock::new(|| {
    let table = include_str!("../data/cie_1931_2deg_d65.csv");
    let row = |line: &str| {
        let mut numbers = line.split(',').map(|field| field.parse().unwrap_or(f64::NAN));
        let [_, x, y, z, d65] = std::array::from_fn(|_| numbers.next().unwrap_or(f64::NAN));
        [x * d65, y * d65, z * d65]
    };
    table.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit())).map(row).collect()
});

/// From XYZ to linear RGB with Rec. 709 primaries and the white of D65 under the observer above.
const TO_RGB: [[f64; 3]; 3] = [
    [3.240_624_232_349_702_5, -1.537_196_894_538_141, -0.498_585_967_486_116],
    [-0.969_183_162_334_070_9, 1.875_905_120_430_789_5, 0.041_547_034_330_732_424],
    [0.055_644_723_393_725_77, -0.204_073_035_388_015_8, 1.057_483_064_149_628_4],
];

/// Weights that turn a spectrum at given wavelengths into linear RGB (Rec. 709 primaries), as the CIE 1931 2°
/// observer sees it under D65.
///
/// Between wavelengths spectra are linear; beyond the first and last they stay constant. A spectrum
/// of equal values is grey.
///
/// ```
/// use brdf_io::SpectrumToRgb;
///
/// let to_rgb = SpectrumToRgb::new(&[400.0, 500.0, 600.0, 700.0]).expect("ascending wavelengths");
/// let red = to_rgb.rgb(&[0.1, 0.1, 0.5, 0.5]);
/// assert!(red.r > red.g && red.g > red.b);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SpectrumToRgb {
    weights: Vec<Rgb>,
}

impl SpectrumToRgb {
    /// Returns the weights for ascending wavelengths in nanometres, or `None` unless there are two or more, each
    /// above the last.
    pub fn new(wavelengths: &[f64]) -> Option<Self> {
        if wavelengths.len() < 2 || !wavelengths.windows(2).all(|w| w[0] < w[1]) {
            return None;
        }
        let raw: Vec<[f64; 3]> = (0..wavelengths.len())
            .map(|node| {
                let mut xyz = [0.0; 3];
                for (index, lit) in (0_u32..).zip(LIT_OBSERVER.iter()) {
                    let share = hat(wavelengths, node, f64::from(380 + index));
                    xyz.iter_mut().zip(lit).for_each(|(sum, v)| *sum += v * share);
                }
                TO_RGB.map(|row| row.iter().zip(xyz).map(|(m, v)| m * v).sum())
            })
            .collect();
        let white: [f64; 3] = std::array::from_fn(|c| raw.iter().map(|weight| weight[c]).sum());
        let normalized =
            |weight: [f64; 3]| Rgb::from(std::array::from_fn(|c| weight[c] / white[c]));
        Some(Self { weights: raw.into_iter().map(normalized).collect() })
    }

    /// Returns the colour of a spectrum with one value per wavelength, and whether it had to be moved into the
    /// gamut.
    ///
    /// A colour whose smallest channel lies below 1 % of its luminance moves towards the grey of the
    /// same luminance until it does not: a channel cut to 0 would be a fit in logarithms' largest
    /// outlier. A colour without positive luminance stays as it is.
    pub fn rgb_in_gamut(&self, spectrum: &[f64]) -> (Rgb, bool) {
        const FLOOR: f64 = 0.01;
        let colour = self.rgb(spectrum);
        let luminance = colour.luminance();
        let [r, g, b] = colour.channels();
        let smallest = r.min(g).min(b);
        // Written so that what is not finite stays as it is, too.
        let outside = luminance > 0.0 && smallest < FLOOR * luminance;
        if !outside {
            return (colour, false);
        }
        let saturation = (1.0 - FLOOR) * luminance / (luminance - smallest);
        let grey = Rgb::splat(luminance);
        (grey + (colour - grey) * saturation, true)
    }

    /// Returns the colour of a spectrum with one value per wavelength; saturated ones may lie outside the gamut,
    /// with a negative channel.
    pub fn rgb(&self, spectrum: &[f64]) -> Rgb {
        self.weights.iter().zip(spectrum).map(|(&weight, &value)| weight * value).sum()
    }
}

/// The piecewise linear function that is 1 at one wavelength and 0 at all others.
fn hat(wavelengths: &[f64], node: usize, at: f64) -> f64 {
    let peak = wavelengths[node];
    let neighbour = if at < peak { node.checked_sub(1) } else { Some(node + 1) };
    match neighbour.and_then(|n| wavelengths.get(n)) {
        Some(&other) => (1.0 - (at - peak) / (other - peak)).max(0.0),
        None => 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn converter() -> SpectrumToRgb {
        let wavelengths: Vec<f64> = (40..=70).map(|w| f64::from(w) * 10.0).collect();
        SpectrumToRgb::new(&wavelengths).unwrap()
    }

    #[test]
    fn an_even_spectrum_is_grey() {
        let grey = converter().rgb(&[0.25; 31]);
        assert!(grey.channels().iter().all(|v| (v - 0.25).abs() < 1e-12), "{grey:?}");
    }

    #[test]
    fn saturated_colours_keep_their_luminance_in_gamut() {
        let spectrum: Vec<f64> = (0..31).map(|i| f64::from(u8::from(i == 10))).collect();
        let converter = converter();
        let (outside, (inside, moved)) =
            (converter.rgb(&spectrum), converter.rgb_in_gamut(&spectrum));
        assert!(moved && outside.r < 0.0 && inside.r > 0.0, "{outside:?} {inside:?}");
        assert!((outside.luminance() - inside.luminance()).abs() < 1e-12);
    }

    #[test]
    fn long_wavelengths_are_red() {
        let spectrum: Vec<f64> = (0..31).map(|i| f64::from(u8::from(i >= 20))).collect();
        let red = converter().rgb(&spectrum);
        assert!(red.r > 0.8 && red.g < 0.1 && red.b.abs() < 0.05, "{red:?}");
    }
}
