//! Directions as texels of a cube map.
//!
//! Faces stand in the order +x, −x, +y, −y, +z, −z; rows go down a face, columns to its right, by the convention of
//! graphics libraries, whose faces are seen from outside.

use glam::DVec3;

/// Number of texels along a side of a face.
pub const SIDE: usize = 64;
/// Number of texels of a face.
pub const FACE_TEXELS: usize = SIDE * SIDE;
/// Number of texels of the cube.
pub const TEXELS: usize = 6 * FACE_TEXELS;

/// The right, down and outward axes of a face of the cube.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Face {
    /// Direction of growing columns.
    pub right: DVec3,
    /// Direction of growing rows.
    pub down: DVec3,
    /// Unit vector from the centre through the middle of the face.
    pub out: DVec3,
}

/// The six faces of the cube.
pub const FACES: [Face; 6] = [
    Face { right: DVec3::NEG_Z, down: DVec3::NEG_Y, out: DVec3::X },
    Face { right: DVec3::Z, down: DVec3::NEG_Y, out: DVec3::NEG_X },
    Face { right: DVec3::X, down: DVec3::Z, out: DVec3::Y },
    Face { right: DVec3::X, down: DVec3::NEG_Z, out: DVec3::NEG_Y },
    Face { right: DVec3::X, down: DVec3::NEG_Y, out: DVec3::Z },
    Face { right: DVec3::NEG_X, down: DVec3::NEG_Y, out: DVec3::NEG_Z },
];

impl Face {
    /// Returns the direction, not of unit length, through a place of the face; both coordinates in [−1, 1].
    pub fn through(&self, across: f64, along: f64) -> DVec3 {
        self.out + across * self.right + along * self.down
    }
}

/// Returns the coordinate, in [−1, 1], of the middle of column or row `at` on a face of `side` columns and rows.
pub fn middle(at: usize, side: usize) -> f64 {
    (2 * at + 1) as f64 / side as f64 - 1.0
}

/// Returns face, row and column of a texel.
pub fn place(texel: usize) -> (usize, usize, usize) {
    (texel / FACE_TEXELS, texel / SIDE % SIDE, texel % SIDE)
}

/// Returns the unit direction through the middle of a texel.
pub fn direction(texel: usize) -> DVec3 {
    let (face, row, column) = place(texel);
    FACES[face].through(middle(column, SIDE), middle(row, SIDE)).normalize()
}

/// Returns the exact solid angle of a texel, sr.
///
/// ```
/// use brdf_relight::cube::{TEXELS, solid_angle};
///
/// let sphere: f64 = (0..TEXELS).map(solid_angle).sum();
/// assert!((sphere - 4.0 * std::f64::consts::PI).abs() < 1e-9);
/// ```
pub fn solid_angle(texel: usize) -> f64 {
    let (_, row, column) = place(texel);
    let edge = |at: usize| 2.0 * at as f64 / SIDE as f64 - 1.0;
    // Of the rectangle between the middle of a face and a point of it.
    let corner = |x: f64, y: f64| (x * y).atan2((x * x + y * y + 1.0).sqrt());
    let ([x0, x1], [y0, y1]) = ([edge(column), edge(column + 1)], [edge(row), edge(row + 1)]);
    corner(x1, y1) - corner(x0, y1) - corner(x1, y0) + corner(x0, y0)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn solid_angles_fill_the_sphere() {
        let total: f64 = (0..TEXELS).map(solid_angle).sum();
        assert!((total / (4.0 * PI) - 1.0).abs() < 1e-13, "{total}");
        let (least, most) = (solid_angle(0), solid_angle(SIDE / 2 * SIDE + SIDE / 2));
        assert!(most / least > 5.0 && most / least < 5.4, "corners are small: {least}, {most}");
    }

    #[test]
    fn texels_of_all_faces_point_apart() {
        for (a, face) in FACES.iter().enumerate() {
            assert!((face.down.cross(face.right) - face.out).length() < 1e-12, "face {a}");
            for texel in [0, 63, 4032, 4095, 2080] {
                let direction = direction(a * FACE_TEXELS + texel);
                let largest = FACES.iter().map(|f| f.out.dot(direction)).fold(0.0, f64::max);
                assert!((face.out.dot(direction) - largest).abs() < 1e-12, "face {a}");
            }
        }
        assert!((direction(0) - DVec3::ONE.normalize()).length() < 0.02, "corner of +x");
    }
}
