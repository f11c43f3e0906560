//! The sRGB transfer function, IEC 61966-2-1, in f64 and in f32.

/// Returns the sRGB display value of a linear one; both are clipped to [0, 1].
///
/// ```
/// use brdf_model::{decode_srgb, encode_srgb};
///
/// assert!((encode_srgb(0.18) - 0.461).abs() < 1e-3);
/// assert!((decode_srgb(encode_srgb(0.18)) - 0.18).abs() < 1e-12);
/// ```
pub fn encode_srgb(linear: f64) -> f64 {
    let v = linear.clamp(0.0, 1.0);
    if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 }
}

/// Returns the linear value of an sRGB display value.
pub fn decode_srgb(v: f64) -> f64 {
    if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}

/// Returns the linear value of an sRGB display value, in f32.
pub fn srgb_to_linear(v: f32) -> f32 {
    if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}

/// Returns the sRGB display value of a linear one of 0 or more, in f32, not clipped.
pub fn linear_to_srgb(v: f32) -> f32 {
    if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_comes_back() {
        for byte in 0..=255_u8 {
            let v = f64::from(byte) / 255.0;
            assert!((encode_srgb(decode_srgb(v)) - v).abs() < 1e-6, "{byte}");
            let narrow = f32::from(byte) / 255.0;
            assert!((linear_to_srgb(srgb_to_linear(narrow)) - narrow).abs() < 1e-5, "{byte}");
        }
    }
}
