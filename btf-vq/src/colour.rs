//! Luminance and chrominance of texels.
//!
//! Sources: ITU-R BT.601 (full range, as in JPEG); the chromaticities u′v′ of G. W. Larson, "LogLuv
//! Encoding for Full-Gamut, High-Dynamic Range Images", Journal of Graphics Tools 3(1), 1998.

use crate::Encoding;

/// Weights of squared errors in luma, Cb and Cr in the mean squared error of RGB, without the products of different
/// channels, which average out where channels are quantized apart.
pub const RGB_WEIGHTS: [f32; 3] = [1.0, (0.344_136 * 0.344_136 + 1.772 * 1.772) / 3.0, {
    (1.402 * 1.402 + 0.714_136 * 0.714_136) / 3.0
}];

/// Converts display-referred RGB to luma, Cb and Cr (the latter two around 0). The map is linear.
///
/// ```
/// use btf_vq::colour::{from_ycbcr, to_ycbcr};
///
/// let [luma, cb, cr] = to_ycbcr([0.5, 0.5, 0.5]);
/// assert!((luma - 0.5).abs() < 1e-6 && cb.abs() < 1e-6 && cr.abs() < 1e-6);
/// assert!((from_ycbcr(to_ycbcr([0.1, 0.6, 0.3]))[1] - 0.6).abs() < 1e-5);
/// ```
pub fn to_ycbcr([r, g, b]: [f32; 3]) -> [f32; 3] {
    let y = 0.299 * r + 0.587 * g + 0.114 * b;
    [y, (b - y) / 1.772, (r - y) / 1.402]
}

/// Converts luma, Cb and Cr to display-referred RGB; the inverse of [`to_ycbcr`].
pub fn from_ycbcr([y, cb, cr]: [f32; 3]) -> [f32; 3] {
    [y + 1.402 * cr, y - 0.344_136 * cb - 0.714_136 * cr, y + 1.772 * cb]
}

/// Chromaticity of white (D65) in CIE 1976 u′v′.
const WHITE_UV: [f32; 2] = [0.197_833, 0.468_331];

/// Converts linear Rec. 709 RGB to CIE Y and u′v′; black gets white's chromaticity.
pub fn to_yuv([r, g, b]: [f32; 3]) -> [f32; 3] {
    let x = 0.412_391 * r + 0.357_584 * g + 0.180_481 * b;
    let y = 0.212_639 * r + 0.715_169 * g + 0.072_192 * b;
    let z = 0.019_331 * r + 0.119_195 * g + 0.950_532 * b;
    let sum = x + 15.0 * y + 3.0 * z;
    if sum <= 0.0 || y <= 0.0 {
        return [0.0, WHITE_UV[0], WHITE_UV[1]];
    }
    [y, 4.0 * x / sum, 9.0 * y / sum]
}

/// Converts CIE Y and u′v′ to linear Rec. 709 RGB; the inverse of [`to_yuv`].
pub fn from_yuv([y, u, v]: [f32; 3]) -> [f32; 3] {
    let v = v.max(1e-3);
    let x = y * 9.0 * u / (4.0 * v);
    let z = y * (12.0 - 3.0 * u - 20.0 * v) / (4.0 * v);
    [
        3.240_97 * x - 1.537_383 * y - 0.498_611 * z,
        -0.969_244 * x + 1.875_968 * y + 0.041_555 * z,
        0.055_63 * x - 0.203_977 * y + 1.056_972 * z,
    ]
}

/// Converts RGB in the given encoding to luminance and two chromaticities: [`to_ycbcr`] or [`to_yuv`].
pub fn to_luma_chroma(encoding: Encoding, rgb: [f32; 3]) -> [f32; 3] {
    match encoding {
        Encoding::Srgb => to_ycbcr(rgb),
        Encoding::Linear => to_yuv(rgb),
    }
}

/// Converts luminance and two chromaticities to RGB in the given encoding; the inverse of [`to_luma_chroma`].
pub fn from_luma_chroma(encoding: Encoding, value: [f32; 3]) -> [f32; 3] {
    match encoding {
        Encoding::Srgb => from_ycbcr(value),
        Encoding::Linear => from_yuv(value),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_come_back() {
        for rgb in [[0.1, 0.5, 0.9], [1.0, 0.0, 0.0], [0.3, 0.3, 0.3]] {
            for encoding in [Encoding::Srgb, Encoding::Linear] {
                let back = from_luma_chroma(encoding, to_luma_chroma(encoding, rgb));
                for (a, b) in rgb.iter().zip(back) {
                    assert!((a - b).abs() < 2e-4, "{encoding:?} {rgb:?} {back:?}");
                }
            }
        }
    }

    #[test]
    fn the_weights_are_the_error_of_each_channel_in_rgb() {
        for channel in 0..3 {
            let mut step = [0.0; 3];
            step[channel] = 1.0;
            let mse = from_ycbcr(step).iter().map(|v| v * v).sum::<f32>() / 3.0;
            assert!((mse - RGB_WEIGHTS[channel]).abs() < 1e-5);
        }
    }
}
