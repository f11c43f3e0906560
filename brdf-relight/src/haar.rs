//! The orthonormal Haar transform of a face.

use crate::cube::{FACE_TEXELS, SIDE};

/// Transforms a face of `width` interleaved channels, `[row][column][channel]`, in place, with all levels of the
/// nonstandard two-dimensional Haar basis. `scratch` is as long as the face.
///
/// ```
/// use brdf_relight::{cube::FACE_TEXELS, haar};
///
/// let (mut face, mut scratch) = (vec![1.0; FACE_TEXELS], vec![0.0; FACE_TEXELS]);
/// haar::transform(&mut face, 1, &mut scratch);
/// assert!((face[0] - 64.0).abs() < 1e-4, "the basis is orthonormal");
/// haar::restore(&mut face, 1, &mut scratch);
/// assert!((face[77] - 1.0).abs() < 1e-5);
/// ```
///
/// # Panics
///
/// Unless both hold a face.
pub fn transform(face: &mut [f32], width: usize, scratch: &mut [f32]) {
    assert_eq!(face.len(), FACE_TEXELS * width, "a face");
    assert_eq!(scratch.len(), face.len(), "room for a face");
    pulp::Arch::new().dispatch(Forward { face, width, scratch });
}

struct Forward<'a> {
    face: &'a mut [f32],
    width: usize,
    scratch: &'a mut [f32],
}

impl pulp::NullaryFnOnce for Forward<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { face, width, scratch } = self;
        let mut side = SIDE;
        while side > 1 {
            let half = side / 2;
            for row in 0..half {
                for column in 0..half {
                    let at = |row: usize, column: usize| (row * SIDE + column) * width;
                    let a = &face[at(2 * row, 2 * column)..][..2 * width];
                    let c = &face[at(2 * row + 1, 2 * column)..][..2 * width];
                    let (a, b) = a.split_at(width);
                    let (c, d) = c.split_at(width);
                    for channel in 0..width {
                        let (a, b, c, d) = (a[channel], b[channel], c[channel], d[channel]);
                        let (above, below) = (a + b, c + d);
                        let (left, right) = (a - b, c - d);
                        scratch[at(row, column) + channel] = 0.5 * (above + below);
                        scratch[at(row, column + half) + channel] = 0.5 * (left + right);
                        scratch[at(row + half, column) + channel] = 0.5 * (above - below);
                        scratch[at(row + half, column + half) + channel] = 0.5 * (left - right);
                    }
                }
            }
            for row in 0..side {
                let line = row * SIDE * width..(row * SIDE + side) * width;
                face[line.clone()].copy_from_slice(&scratch[line]);
            }
            side = half;
        }
    }
}

/// Inverts [`transform`], in place.
///
/// # Panics
///
/// As [`transform`].
pub fn restore(face: &mut [f32], width: usize, scratch: &mut [f32]) {
    assert_eq!(face.len(), FACE_TEXELS * width, "a face");
    assert_eq!(scratch.len(), face.len(), "room for a face");
    let at = |row: usize, column: usize| (row * SIDE + column) * width;
    let mut half = 1;
    while half < SIDE {
        for row in 0..half {
            for column in 0..half {
                for channel in 0..width {
                    let value = |row, column| face[at(row, column) + channel];
                    let (mean, across) = (value(row, column), value(row, column + half));
                    let (down, both) =
                        (value(row + half, column), value(row + half, column + half));
                    let mut put =
                        |row, column, value: f32| scratch[at(row, column) + channel] = value;
                    put(2 * row, 2 * column, 0.5 * (mean + across + down + both));
                    put(2 * row, 2 * column + 1, 0.5 * (mean - across + down - both));
                    put(2 * row + 1, 2 * column, 0.5 * (mean + across - down - both));
                    put(2 * row + 1, 2 * column + 1, 0.5 * (mean - across - down + both));
                }
            }
        }
        half *= 2;
        for row in 0..half {
            let line = at(row, 0)..at(row, half);
            face[line.clone()].copy_from_slice(&scratch[line]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(seed: u32) -> f32 {
        let mixed = seed.wrapping_mul(2_654_435_761) ^ (seed >> 7);
        f32::from((mixed >> 16) as u16) / 65536.0 - 0.3
    }

    #[test]
    fn it_is_orthonormal_and_comes_back() {
        let width = 3;
        let of = |shift: u32| -> Vec<f32> {
            (0..u32::try_from(FACE_TEXELS * width).unwrap()).map(|i| noise(i + shift)).collect()
        };
        let (first, second) = (of(0), of(99_991));
        let mut scratch = vec![0.0; first.len()];
        let (mut a, mut b) = (first.clone(), second.clone());
        transform(&mut a, width, &mut scratch);
        transform(&mut b, width, &mut scratch);
        let dot = |a: &[f32], b: &[f32]| -> f64 {
            a.iter().zip(b).map(|(a, b)| f64::from(*a) * f64::from(*b)).sum()
        };
        let (plain, transformed) = (dot(&first, &second), dot(&a, &b));
        assert!((transformed / plain - 1.0).abs() < 1e-5, "{plain} and {transformed}");
        restore(&mut a, width, &mut scratch);
        let apart = a.iter().zip(&first).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(apart < 1e-5, "{apart}");
    }

    #[test]
    fn a_constant_is_one_coefficient() {
        let mut face = vec![1.0; FACE_TEXELS];
        transform(&mut face, 1, &mut vec![0.0; FACE_TEXELS]);
        assert!((face[0] - 64.0).abs() < 1e-4 && face[1..].iter().all(|v| v.abs() < 1e-5));
    }
}
