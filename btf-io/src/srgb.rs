//! The sRGB transfer function (IEC 61966-2-1) by table, for the hundreds of millions of values of a
//! BTF.

use std::sync::LazyLock;

use brdf_model::encode_srgb;

/// Steps of linear values. The curve's steepest byte spans 19 of them, so that a value is rounded
/// to another byte than by the formula only within 1/38 of the border between two.
const STEPS: u16 = u16::MAX;

static BYTES: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let byte = |step: u16| {
        let level = 255.0 * encode_srgb(f64::from(step) / f64::from(STEPS));
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most 255")]
        let byte = level.round() as u8;
        byte
    };
    (0..=STEPS).map(byte).collect()
});

/// The bytes of linear values, clipped to [0, 1]; NaN becomes 0.
pub(crate) fn srgb_bytes_clipped(linear: &[f32]) -> Vec<u8> {
    let bytes: &[u8] = &BYTES;
    let scale = f32::from(STEPS);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "casts saturate")]
    let step = |value: f32| usize::from((value * scale + 0.5) as u16);
    linear.iter().map(|&value| bytes[step(value)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_survives_decoding_and_encoding() {
        for byte in 0..=255_u8 {
            let linear = brdf_model::srgb_to_linear(f32::from(byte) / 255.0);
            assert_eq!(srgb_bytes_clipped(&[linear]), [byte]);
        }
        assert_eq!(srgb_bytes_clipped(&[-1.0, 7.0, f32::NAN]), [0, 255, 0]);
    }
}
