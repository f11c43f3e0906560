//! ΔE_ITP: colour differences at high dynamic range.
//!
//! Source: ITU-R BT.2124, 720 √(ΔI² + ΔT² + ΔP²) with T = ½ Ct and P = Cp of ICtCp (BT.2100, PQ);
//! Rec. 709 to BT.2020 by the matrix printed in BT.2087.

use super::Planes;

/// Luminance of linear 1, cd/m²: reference white of BT.2408.
const WHITE: f64 = 203.0;
/// Largest luminance of PQ, cd/m².
const PEAK: f64 = 10_000.0;

const TO_BT2020: [[f64; 3]; 3] =
    [[0.6274, 0.3293, 0.0433], [0.0691, 0.9195, 0.0114], [0.0164, 0.0880, 0.8956]];
/// In units of 1/4096.
const TO_LMS: [[f64; 3]; 3] =
    [[1688.0, 2146.0, 262.0], [683.0, 2951.0, 462.0], [99.0, 309.0, 3688.0]];
const TO_ICTCP: [[f64; 3]; 3] =
    [[2048.0, 2048.0, 0.0], [6610.0, -13613.0, 7003.0], [17933.0, -17390.0, -543.0]];

/// Returns the ΔE_ITP difference at each pixel of two linear Rec. 709 pictures whose 1 is shown at 203 cd/m² (ITU-R
/// BT.2124). Symmetric; 0 where equal; 1 is just noticeable.
///
/// # Panics
///
/// Unless both have the same size.
pub fn delta_e_itp_map(a: &Planes, b: &Planes) -> Vec<f64> {
    assert_eq!((a.width, a.len()), (b.width, b.len()), "pictures of the same size");
    (0..a.len())
        .map(|index| {
            let [[i, ct, cp], [j, dt, dp]] = [a, b].map(|picture| to_ictcp(picture.pixel(index)));
            let t = 0.5 * (ct - dt);
            720.0 * ((i - j).powi(2) + t * t + (cp - dp).powi(2)).sqrt()
        })
        .collect()
}

fn to_ictcp(linear: [f64; 3]) -> [f64; 3] {
    let wide = times(&TO_BT2020, linear.map(|v| WHITE * v.max(0.0)), 1.0);
    let lms = times(&TO_LMS, wide, 4096.0).map(perceptual_quantizer);
    times(&TO_ICTCP, lms, 4096.0)
}

fn times(matrix: &[[f64; 3]; 3], v: [f64; 3], unit: f64) -> [f64; 3] {
    matrix.map(|row| (row[0] * v[0] + row[1] * v[1] + row[2] * v[2]) / unit)
}

/// The inverse of SMPTE ST 2084, of cd/m².
fn perceptual_quantizer(luminance: f64) -> f64 {
    const M1: f64 = 2610.0 / 16384.0;
    const M2: f64 = 128.0 * 2523.0 / 4096.0;
    const C1: f64 = 3424.0 / 4096.0;
    const C2: f64 = 32.0 * 2413.0 / 4096.0;
    const C3: f64 = 32.0 * 2392.0 / 4096.0;
    let y = (luminance / PEAK).clamp(0.0, 1.0).powf(M1);
    ((C1 + C2 * y) / (1.0 + C3 * y)).powf(M2)
}
