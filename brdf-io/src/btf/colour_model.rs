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

    /// Linear RGB, not limited to any range.
    pub(crate) fn to_rgb(self, stored: [f32; 3]) -> [f32; 3] {
        let [a, b, c] = stored;
        match self {
            Self::Rgb => stored,
            Self::Yuv => yuv_to_rgb(stored),
            Self::Lab => lab_to_rgb(stored),
            Self::Basis { rows, mean } => std::array::from_fn(|channel| {
                mean[channel] + a * rows[0][channel] + b * rows[1][channel] + c * rows[2][channel]
            }),
            Self::YCoCg => [a + b - c, a + c, a - b - c],
            Self::SumShares => [(1.0 - b - c) * a, b * a, c * a],
            Self::LogYuv => yuv_to_rgb([a.exp() - EPSILON, b, c]),
            Self::LogYLogUv => yuv_to_rgb([a.exp() - EPSILON, signed_exp(b), signed_exp(c)]),
            // The ratios were taken to Y + ε, which is what the exponential gives.
            Self::LogYRatios => yuv_to_rgb([a.exp() - EPSILON, b * a.exp(), c * a.exp()]),
            Self::LogRgb => stored.map(|value| value.exp() - EPSILON),
        }
    }
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
            let found = ColourModel::of(number, basis, [0.1; 3]).unwrap().to_rgb(stored);
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
    fn unknown_models_are_none() {
        for number in [-1, 6, 7, 8, 13] {
            assert_eq!(ColourModel::of(number, [[0.0; 3]; 3], [0.0; 3]), None);
        }
    }
}
