//! Heights from the normals of a tile that repeats.
//!
//! Source: R. T. Frankot, R. Chellappa, "A Method for Enforcing Integrability in Shape from Shading
//! Algorithms", IEEE Trans. Pattern Analysis and Machine Intelligence 10(4), 1988.

use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

use crate::{Map, SynthError};

/// Least z of a normal: steeper ones are artefacts of compression, and 1/z would follow them.
const MIN_NORMAL_Z: f64 = 0.05;

/// Returns the heights whose gradients come nearest to those of a tangent-space normal map (least squares,
/// periodic).
///
/// Heights have mean 0 and are in units of the tile's width. The map's channels x, y and z are stored as (n + 1) /
/// 2, y up (the OpenGL convention), row 0 at the top.
///
/// ```
/// use btf_synth::{Map, heights_from_normals};
///
/// let flat = [0.5, 0.5, 1.0].map(|v| Map::constant(8, 8, v).expect("a small map"));
/// assert_eq!(heights_from_normals(&flat)?.range(), [0.0, 0.0]);
/// # Ok::<(), btf_synth::SynthError>(())
/// ```
///
/// # Errors
///
/// [`SynthError::Mismatch`] unless the channels are of one size.
pub fn heights_from_normals(normals: &[Map; 3]) -> Result<Map, SynthError> {
    let [width, height] = [normals[0].width(), normals[0].height()];
    for channel in normals {
        let found = [channel.width(), channel.height()];
        if found != [width, height] {
            return Err(SynthError::Mismatch {
                what: "normal map",
                found,
                expected: [width, height],
            });
        }
    }
    let [mut along_x, mut along_row] = slopes(normals);
    for slope in [&mut along_x, &mut along_row] {
        transform(slope, width, height, Direction::Forward);
    }
    let mut heights = integrate(&along_x, &along_row, width, height);
    transform(&mut heights, width, height, Direction::Inverse);
    // Transforms there and back multiply by the number of texels; slopes are per texel of a tile
    // that is `width` texels wide.
    let scale = 1.0 / ((width * height) as f64 * width as f64);
    #[expect(clippy::cast_possible_truncation, reason = "heights are stored as f32")]
    let values = heights.iter().map(|z| (z.re * scale) as f32).collect();
    Map::new(width, height, values)
}

/// Slopes along columns (to the right) and along rows (downwards).
fn slopes(normals: &[Map; 3]) -> [Vec<Complex<f64>>; 2] {
    let decode =
        |channel: usize, texel: usize| 2.0 * f64::from(normals[channel].values()[texel]) - 1.0;
    let along = |axis: usize, sign: f64| {
        (0..normals[0].values().len())
            .map(|texel| {
                let z = decode(2, texel).max(MIN_NORMAL_Z);
                Complex::new(sign * decode(axis, texel) / z, 0.0)
            })
            .collect()
    };
    [along(0, -1.0), along(1, 1.0)]
}

/// The spectrum of the heights: that of the slopes, projected on gradients and integrated. The mean
/// stays 0.
fn integrate(
    along_x: &[Complex<f64>],
    along_row: &[Complex<f64>],
    width: usize,
    height: usize,
) -> Vec<Complex<f64>> {
    (0..width * height)
        .map(|bin| {
            let u = frequency(bin % width, width);
            let v = frequency(bin / width, height);
            let norm_sq = u * u + v * v;
            if norm_sq > 0.0 {
                let mixed = along_x[bin] * u + along_row[bin] * v;
                Complex::new(mixed.im, -mixed.re) / norm_sq
            } else {
                Complex::default()
            }
        })
        .collect()
}

/// Angular frequency of a bin in radians per texel, from −π to π.
fn frequency(bin: usize, len: usize) -> f64 {
    let [bin, len] = [bin as f64, len as f64];
    let signed = if 2.0 * bin > len { bin - len } else { bin };
    std::f64::consts::TAU * signed / len
}

#[derive(Clone, Copy)]
enum Direction {
    Forward,
    Inverse,
}

/// Transforms rows, then columns, in place and without scaling.
fn transform(values: &mut [Complex<f64>], width: usize, height: usize, direction: Direction) {
    let mut planner = FftPlanner::new();
    let mut plan = |len| match direction {
        Direction::Forward => planner.plan_fft_forward(len),
        Direction::Inverse => planner.plan_fft_inverse(len),
    };
    plan(width).process(values);
    let columns = plan(height);
    let mut column = vec![Complex::default(); height];
    for x in 0..width {
        for (y, value) in column.iter_mut().enumerate() {
            *value = values[y * width + x];
        }
        columns.process(&mut column);
        for (y, value) in column.iter().enumerate() {
            values[y * width + x] = *value;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    /// A height at (x, y) of the unit tile, y up, and its gradient.
    fn hill(x: f64, y: f64) -> (f64, [f64; 2]) {
        let height = 0.02 * (TAU * x).sin() + 0.01 * (TAU * (x + 2.0 * y)).cos();
        let mixed = -0.01 * TAU * (TAU * (x + 2.0 * y)).sin();
        (height, [0.02 * TAU * (TAU * x).cos() + mixed, 2.0 * mixed])
    }

    #[test]
    #[expect(clippy::cast_possible_truncation, reason = "small")]
    fn a_smooth_periodic_height_comes_back() {
        // An oblong tile, square texels: y runs to 3/4.
        let (width, height) = (32, 24);
        let place = |texel: usize| {
            let (column, row) = (texel % width, texel / width);
            (column as f64 / 32.0, 1.0 - row as f64 / 32.0)
        };
        let hill = |x: f64, y: f64| {
            let (h, [dx, dy]) = hill(x, y / 0.75);
            (h, [dx, dy / 0.75])
        };
        let channel = |axis: usize| {
            let values = (0..width * height).map(|texel| {
                let (x, y) = place(texel);
                let (_, [dx, dy]) = hill(x, y);
                let norm = (dx * dx + dy * dy + 1.0).sqrt();
                (0.5 + 0.5 * [-dx, -dy, 1.0][axis] / norm) as f32
            });
            Map::new(width, height, values.collect()).unwrap()
        };
        let heights = heights_from_normals(&[channel(0), channel(1), channel(2)]).unwrap();
        for (texel, &found) in heights.values().iter().enumerate() {
            let (x, y) = place(texel);
            let expected = hill(x, y).0;
            assert!((f64::from(found) - expected).abs() < 1e-6, "{texel}: {found} {expected}");
        }
    }
}
