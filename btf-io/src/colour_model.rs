//! Colour models in which factored BTFs store their channels, and the way back to linear RGB.

/// What was added before a logarithm was taken.
const EPSILON: f32 = 1e-5;
/// CIE XYZ of the white of D50, for which L*a*b* is defined.
const D50: [f32; 3] = [0.964_22, 1.0, 0.825_21];

/// How three stored channels make red, green and blue. Names give the three channels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ColourModel {
    Rgb,
    Yuv,
    /// L*, a*, b* for D50.
    Lab,
    /// Coordinates in a file's own basis, whose rows are RGB, around a mean.
    Basis {
        rows: [[f32; 3]; 3],
        mean: [f32; 3],
    },
    YCoCg,
    /// The sum, and the shares of the second and third channel in it.
    SumShares,
    LogYuv,
    /// U and V as logarithms that keep their sign.
    LogYLogUv,
    /// U and V divided by Y.
    LogYRatios,
    LogRgb,
}

impl ColourModel {
    /// The model of a file's number, as btflib names them; none for spectral and unknown ones.
    pub(crate) fn of(number: i32, rows: [[f32; 3]; 3], mean: [f32; 3]) -> Option<Self> {
        match number {
            0 => Some(Self::Rgb),
            1 => Some(Self::Yuv),
            2 => Some(Self::Lab),
            3 => Some(Self::Basis { rows, mean }),
            4 => Some(Self::YCoCg),
            5 => Some(Self::SumShares),
            9 => Some(Self::LogYuv),
            10 => Some(Self::LogYLogUv),
            11 => Some(Self::LogYRatios),
            12 => Some(Self::LogRgb),
            _ => None,
        }
    }

    /// Whether a channel is a logarithm, of which [`ColourModel::to_rgb`] wants the exponential: of
    /// many values at once that is several times faster.
    pub(crate) fn is_logarithm(self, channel: usize) -> bool {
        match self {
            Self::LogYuv | Self::LogYLogUv | Self::LogYRatios => channel == 0,
            Self::LogRgb => true,
            _ => false,
        }
    }

    /// Linear RGB, not limited to any range.
    pub(crate) fn to_rgb(self, channels: [f32; 3]) -> [f32; 3] {
        let [a, b, c] = channels;
        match self {
            Self::Rgb => channels,
            Self::Yuv => yuv_to_rgb(channels),
            Self::Lab => lab_to_rgb(channels),
            Self::Basis { rows, mean } => std::array::from_fn(|channel| {
                mean[channel] + a * rows[0][channel] + b * rows[1][channel] + c * rows[2][channel]
            }),
            Self::YCoCg => [a + b - c, a + c, a - b - c],
            Self::SumShares => [(1.0 - b - c) * a, b * a, c * a],
            Self::LogYuv => yuv_to_rgb([a - EPSILON, b, c]),
            Self::LogYLogUv => yuv_to_rgb([a - EPSILON, signed_exp(b), signed_exp(c)]),
            // The ratios were taken to Y + ε, which is what the exponential gives.
            Self::LogYRatios => yuv_to_rgb([a - EPSILON, b * a, c * a]),
            Self::LogRgb => channels.map(|value| value - EPSILON),
        }
    }
}

/// The exponential of all values, to a relative error of 2e-7; infinite from 88.38 on, and no
/// smaller than e⁻⁸⁷. Plain arithmetic, so that the compiler uses vectors, and the same bits on
/// every machine.
pub(crate) fn exponentials(values: &mut [f32]) {
    for value in values {
        *value = exponential(*value);
    }
}

/// exp(x) = 2ⁿ exp(r), |r| ≤ ln 2 / 2, the second by its Taylor series.
#[inline]
fn exponential(x: f32) -> f32 {
    /// 1.5 · 2²³: added to a small number it leaves the nearest integer in the low bits.
    const ROUND: f32 = 12_582_912.0;
    /// ln 2 in two parts, the first with zeros at its end, so that its multiples are exact.
    const LN_2: [f32; 2] = [0.693_359_4, -2.121_944_4e-4];
    let x = x.clamp(-87.0, 89.0);
    let rounded = x * std::f32::consts::LOG2_E + ROUND;
    let n = rounded - ROUND;
    let r = x - n * LN_2[0] - n * LN_2[1];
    let series = 1.0 / 120.0 + r * (1.0 / 720.0 + r * (1.0 / 5040.0));
    let series = 1.0 + r * (1.0 + r * (0.5 + r * (1.0 / 6.0 + r * (1.0 / 24.0 + r * series))));
    let exponent = rounded.to_bits().wrapping_sub(ROUND.to_bits()).wrapping_add(127);
    series * f32::from_bits(exponent << 23)
}

/// With the weights of ITU-R BT.601.
fn yuv_to_rgb([y, u, v]: [f32; 3]) -> [f32; 3] {
    [y + 1.139_83 * v, y - 0.394_65 * u - 0.580_6 * v, y + 2.032_11 * u]
}

/// The way back from sign(x) ln(|x| / ε); zero stays zero.
fn signed_exp(value: f32) -> f32 {
    if value == 0.0 { 0.0 } else { value.signum() * EPSILON * value.abs().exp() }
}

/// CIE 1976 L*a*b* for D50, adapted to D65 after Bradford.
fn lab_to_rgb([lightness, a, b]: [f32; 3]) -> [f32; 3] {
    let middle = (lightness + 16.0) / 116.0;
    let relative = [middle + a / 500.0, middle, middle - b / 200.0].map(|root: f32| {
        if root > 6.0 / 29.0 { root.powi(3) } else { (root - 4.0 / 29.0) * 108.0 / 841.0 }
    });
    let [x, y, z]: [f32; 3] = std::array::from_fn(|i| relative[i] * D50[i]);
    [
        3.133_856 * x - 1.616_866_7 * y - 0.490_614_6 * z,
        -0.978_768_4 * x + 1.916_141_5 * y + 0.033_454 * z,
        0.071_945_3 * x - 0.228_991_4 * y + 1.405_242_7 * z,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(found: [f32; 3], expected: [f32; 3]) -> bool {
        found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 2e-3)
    }

    /// Each model's own numbers for one colour, from their definitions.
    #[test]
    fn every_model_gives_back_its_colour() {
        let rgb = [0.6_f32, 0.3, 0.1];
        let y = 0.299 * rgb[0] + 0.587 * rgb[1] + 0.114 * rgb[2];
        let (u, v) = (0.492 * (rgb[2] - y), 0.877 * (rgb[0] - y));
        let log_uv = |x: f32| x.signum() * (x.abs() / EPSILON).ln();
        let basis = [[0.0, 1.0, 0.0], [0.0, 0.0, 2.0], [1.0, 0.0, 0.0]];
        for (number, stored) in [
            (0, rgb),
            (1, [y, u, v]),
            (3, [rgb[1] - 0.1, (rgb[2] - 0.1) / 2.0, rgb[0] - 0.1]),
            (4, [0.325, 0.25, -0.025]),
            (5, [1.0, 0.3, 0.1]),
            (9, [(y + EPSILON).ln(), u, v]),
            (10, [(y + EPSILON).ln(), log_uv(u), log_uv(v)]),
            (11, [(y + EPSILON).ln(), u / (y + EPSILON), v / (y + EPSILON)]),
            (12, rgb.map(|value| (value + EPSILON).ln())),
        ] {
            let model = ColourModel::of(number, basis, [0.1; 3]).unwrap();
            let mut channels = stored;
            for channel in (0..3).filter(|&channel| model.is_logarithm(channel)) {
                exponentials(&mut channels[channel..=channel]);
            }
            let found = model.to_rgb(channels);
            assert!(close(found, rgb), "model {number}: {found:?}");
        }
    }

    #[test]
    fn lightness_is_that_of_grey() {
        let model = ColourModel::of(2, [[0.0; 3]; 3], [0.0; 3]).unwrap();
        for (lightness, grey) in [(100.0, 1.0), (49.496_1, 0.18), (4.0, 0.004_428), (0.0, 0.0)] {
            let found = model.to_rgb([lightness, 0.0, 0.0]);
            assert!(close(found, [grey; 3]), "L* {lightness}: {found:?}");
        }
    }

    #[test]
    fn exponentials_are_those_of_the_library() {
        let mut values: Vec<f32> = (-8_600..8_837_i16).map(|i| f32::from(i) * 0.01).collect();
        let expected: Vec<f64> = values.iter().map(|&value| f64::from(value).exp()).collect();
        exponentials(&mut values);
        for (value, expected) in values.iter().zip(expected) {
            assert!((f64::from(*value) / expected - 1.0).abs() < 2e-7, "{value} for {expected}");
        }
        let mut ends = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 200.0];
        exponentials(&mut ends);
        assert!(ends[0].is_nan() && ends[1] == f32::INFINITY && ends[3] == f32::INFINITY);
        assert!(ends[2] >= 0.0 && ends[2] < 1e-37, "{}", ends[2]);
    }

    #[test]
    fn unknown_models_are_none() {
        for number in [-1, 6, 7, 8, 13] {
            assert_eq!(ColourModel::of(number, [[0.0; 3]; 3], [0.0; 3]), None);
        }
    }
}
