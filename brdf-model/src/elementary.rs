//! Elementary functions in f32 for loops over arrays: no calls and no tables, so that compilers turn them into vectors,
//! and no fused multiply–add, so that all instruction sets agree.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, LN_2, PI};

/// Returns the angle of a point with y ≥ 0 from the x axis, in radians, [0, π], to 1e-6.
///
/// arctan on [0, tan π/8] by its odd Taylor polynomial of degree 15 after one reduction by π/4.
#[inline(always)]
pub fn angle(y: f32, x: f32) -> f32 {
    let (small, large) = (y.min(x.abs()), y.max(x.abs()).max(1e-30));
    // arctan r = π/4 + arctan((r − 1)/(r + 1)) above tan π/8.
    let is_steep = small > 0.414_213_56 * large;
    let above = if is_steep { small - large } else { small };
    let below = if is_steep { small + large } else { large };
    let first = if is_steep { FRAC_PI_4 } else { 0.0 };
    let ratio = above / below;
    let s = ratio * ratio;
    let tail = 1.0 / 9.0 - s * (1.0 / 11.0 - s * (1.0 / 13.0 - s * (1.0 / 15.0)));
    let series = 1.0 / 3.0 - s * (1.0 / 5.0 - s * (1.0 / 7.0 - s * tail));
    let eighth = first + ratio * (1.0 - s * series);
    let quarter = if y > x.abs() { FRAC_PI_2 - eighth } else { eighth };
    if x < 0.0 { PI - quarter } else { quarter }
}

/// Returns ln x of a normal number, to 1e-6 of it or of 1.
///
/// The exponent by its bits, the rest by the series of ln((1 + s)/(1 − s)).
#[inline(always)]
pub fn ln(x: f32) -> f32 {
    /// √½: mantissas run from there to √2, so that s stays below 0.172.
    const LEAST: u32 = 0x3f35_04f3;
    let bits = x.to_bits();
    let exponent = bits.wrapping_sub(LEAST).cast_signed() >> 23;
    let mantissa = f32::from_bits(bits.wrapping_sub(exponent.cast_unsigned() << 23));
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    let q = s * s;
    let series = 1.0 + q * (1.0 / 3.0 + q * (1.0 / 5.0 + q * (1.0 / 7.0 + q * (1.0 / 9.0))));
    exponent as f32 * LN_2 + 2.0 * s * series
}

/// Returns eˣ to 2 units in the last place, for |x| ≤ 87; beyond, it saturates.
///
/// x = n ln 2 + r with |r| ≤ ln 2 / 2, e^r by its Taylor polynomial of degree 7, 2ⁿ by its bits.
#[inline(always)]
pub fn exp(x: f32) -> f32 {
    // ln 2 in two parts, the first with few enough bits that n times it is exact.
    const LN_2_HIGH: f32 = 0.693_359_4;
    const LN_2_LOW: f32 = -0.000_212_194_44;
    const TWO_23: f32 = 8_388_608.0;
    let x = x.clamp(-87.0, 87.0);
    let n = (x * std::f32::consts::LOG2_E + 0.5).floor();
    let r = (x - n * LN_2_HIGH) - n * LN_2_LOW;
    let tail = 1.0 / 120.0 + r * (1.0 / 720.0 + r * (1.0 / 5040.0));
    let e = 1.0 + r * (1.0 + r * (0.5 + r * (1.0 / 6.0 + r * (1.0 / 24.0 + r * tail))));
    e * f32::from_bits((n + (1.5 * TWO_23 + 127.0)).to_bits() << 23)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elementary_functions_are_good_to_a_millionth() {
        for step in 0..=20_000_u16 {
            let x = f32::from(step) * 0.05 + 1.0;
            assert!((ln(x) - x.ln()).abs() < 2e-6 * x.ln().max(1.0), "ln {x}");
            let turn = f32::from(step) * (PI / 20_000.0);
            let (y, x) = turn.sin_cos();
            assert!((angle(3.0 * y.abs(), 3.0 * x) - turn).abs() < 1e-6, "angle {turn}");
            let x = f32::from(step) * 0.008 - 80.0;
            let exact = f64::from(x).exp();
            assert!((f64::from(exp(x)) / exact - 1.0).abs() < 2.4e-7, "e^{x}");
        }
        assert!(angle(1e-7, 1.0) > 0.9e-7, "small angles stay small angles");
    }
}
