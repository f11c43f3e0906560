//! Linear values in half precision, and what cannot be one.

use half::f16;

use brdf_io::FormatError;

/// Narrows the three channels of all texels, row by row, to half precision. Values below zero become
/// zero, as colours outside the gamut do; returns how many did.
///
/// # Errors
///
/// [`FormatError::Missing`] for the first value that is not finite or above the largest half, 65504,
/// with how many there are.
pub(crate) fn halves(values: &[f32], width: usize) -> Result<(Vec<f16>, u64), FormatError> {
    let fits = |value: f32| value.is_finite() && value <= f16::MAX.to_f32();
    if let Some(at) = values.iter().position(|&value| !fits(value)) {
        let count = values.iter().filter(|&&value| !fits(value)).count();
        let (column, row) = (at / 3 % width, at / 3 / width);
        return Err(FormatError::Missing {
            what: format!(
                "usable value at column {column}, row {row}: it is {} ({count} such values)",
                values[at]
            ),
            expected: "finite numbers of at most 65504".to_owned(),
        });
    }
    let negative = values.iter().filter(|&&value| value < 0.0).count() as u64;
    let values = values.iter().map(|value| f16::from_f32(value.max(0.0))).collect();
    Ok((values, negative))
}

/// CIE XYZ with the white of D65 to linear Rec. 709: the inverse of what IEC 61966-2-1 derives from
/// the primaries.
pub(crate) fn xyz_to_rgb([x, y, z]: [f32; 3]) -> [f32; 3] {
    [
        3.240_454_2 * x - 1.537_138_5 * y - 0.498_531_4 * z,
        -0.969_266 * x + 1.876_010_8 * y + 0.041_556 * z,
        0.055_643_4 * x - 0.204_025_9 * y + 1.057_225_2 * z,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_beyond_half_precision_are_refused_with_their_place() {
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 70_000.0] {
            let mut values = vec![0.5; 3 * 12];
            values[3 * 7 + 1] = bad;
            let message = halves(&values, 5).unwrap_err().to_string();
            assert!(message.contains("column 2, row 1"), "{message}");
        }
    }

    #[test]
    fn values_below_zero_are_counted() {
        let (values, negative) = halves(&[-0.5, 0.25, -0.0], 1).unwrap();
        assert_eq!((values[0], values[1], negative), (f16::ZERO, f16::from_f32(0.25), 1));
    }

    #[test]
    fn the_white_of_d65_is_white() {
        for channel in xyz_to_rgb([0.950_47, 1.0, 1.088_83]) {
            assert!((channel - 1.0).abs() < 1e-4, "{channel}");
        }
    }
}
