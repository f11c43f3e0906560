//! Rotations of four-dimensional space as pairs of unit quaternions.
//!
//! Source: Cole 2002, section 2.3.1, with a period corrected: the printed directions are half-turns, so
//! that along Dᵗ a quaternion returns after t = 4.

use std::f64::consts::PI;

use brdf_param::Projection;
use glam::{DMat4, DQuat, DVec4};

/// A rotation of four-dimensional space, v ↦ S v T, with unit quaternions S and T.
///
/// A vector v = (x, y, z, w) is read as the quaternion w + xi + yj + zk. (S, T) and (−S, −T) are the same
/// rotation; (−S, T) is its point reflection.
///
/// ```
/// use brdf_param::Projection;
/// use brdf_search::Rotation4;
///
/// let rotation = Rotation4::from_projection(&Projection::SECOND);
/// let [u, v] = rotation.projection().rows();
/// assert!(u.distance(glam::DVec4::Z) < 1e-12 && v.distance(glam::DVec4::W) < 1e-12);
/// let half = rotation.power(0.5);
/// assert!(half.after(&half).angle_to(&rotation) < 1e-6);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotation4 {
    left: DQuat,
    right: DQuat,
}

impl Rotation4 {
    /// The identity, which moves nothing.
    pub const IDENTITY: Self = Self { left: DQuat::IDENTITY, right: DQuat::IDENTITY };

    /// Returns the rotation of two quaternions, which are scaled to unit length, or `None` where one is zero
    /// or not finite.
    pub fn new(left: DQuat, right: DQuat) -> Option<Self> {
        let unit = |q: DQuat| {
            let length = q.length();
            (length.is_finite() && length > 0.0).then(|| q / length)
        };
        Some(Self { left: unit(left)?, right: unit(right)? })
    }

    /// Returns the left quaternion S.
    pub fn left(&self) -> DQuat {
        self.left
    }

    /// Returns the right quaternion T.
    pub fn right(&self) -> DQuat {
        self.right
    }

    /// Returns the image of a vector.
    pub fn apply(&self, v: DVec4) -> DVec4 {
        (self.left * DQuat::from_vec4(v) * self.right).into()
    }

    /// Returns the product of this rotation and `first`, which acts first.
    #[must_use]
    pub fn after(&self, first: &Self) -> Self {
        Self {
            left: (self.left * first.left).normalize(),
            right: (first.right * self.right).normalize(),
        }
    }

    /// Returns the rotation that undoes this one.
    #[must_use]
    pub fn inverse(&self) -> Self {
        Self { left: self.left.conjugate(), right: self.right.conjugate() }
    }

    /// Returns this rotation applied t times, for any real t: both quaternions raised to the power t.
    #[must_use]
    pub fn power(&self, t: f64) -> Self {
        Self { left: quaternion_power(self.left, t), right: quaternion_power(self.right, t) }
    }

    /// Returns the axis-angle vectors of both quaternions, with half angles in radians.
    ///
    /// Of the two pairs of quaternions of this rotation, the one with the shorter vectors is taken.
    pub fn shortest_log(&self) -> [glam::DVec3; 2] {
        let logs = |sign: f64| [self.left, self.right].map(|q| quaternion_log(q * sign));
        let length = |[a, b]: [glam::DVec3; 2]| a.length_squared() + b.length_squared();
        let (plus, minus) = (logs(1.0), logs(-1.0));
        if length(plus) <= length(minus) { plus } else { minus }
    }

    /// Returns the rotation of these axis-angle vectors, with half angles in radians.
    pub fn from_log([left, right]: [glam::DVec3; 2]) -> Self {
        Self { left: quaternion_exp(left), right: quaternion_exp(right) }
    }

    /// Returns the angle to another rotation, in radians: the length of the shortest log of the rotation that
    /// leads from one to the other.
    pub fn angle_to(&self, other: &Self) -> f64 {
        let [a, b] = other.after(&self.inverse()).shortest_log();
        (a.length_squared() + b.length_squared()).sqrt()
    }

    /// Returns the matrix whose columns are the images of the axes.
    pub fn to_matrix(&self) -> DMat4 {
        let [x, y, z, w] = DVec4::AXES.map(|axis| self.apply(axis));
        DMat4::from_cols(x, y, z, w)
    }

    /// Returns the rotation of an orthogonal matrix of determinant 1, to rounding, or `None` for another
    /// matrix.
    ///
    /// Source: van Elfrinkhof 1897, as given by Mebius 2005: the associate matrix has rank one.
    pub fn from_matrix(matrix: &DMat4) -> Option<Self> {
        let rest = *matrix * matrix.transpose() - DMat4::IDENTITY;
        let orthogonal = rest.to_cols_array().iter().all(|v| v.abs() < 1e-9);
        if !orthogonal || matrix.determinant() < 0.0 {
            return None;
        }
        // S e T for the unit quaternions e of all pairs: the sum over axes of M(e) conj(e) weighted by
        // a probe gives S times a number, unless the probe is blind for this rotation.
        let probes = [DQuat::IDENTITY, DQuat::from_xyzw(1.0, 0.0, 0.0, 0.0)]
            .into_iter()
            .chain([DQuat::from_xyzw(0.0, 1.0, 0.0, 0.0), DQuat::from_xyzw(0.0, 0.0, 1.0, 0.0)]);
        let left = probes
            .map(|probe| {
                // Σ_e M(e) · probe · conj(e) = S Σ_e e T probe conj(e) = 4 Re(T probe) S.
                let sum = DVec4::AXES.iter().fold(DVec4::ZERO, |sum, &axis| {
                    let image = DQuat::from_vec4(*matrix * axis);
                    let term = image * probe * DQuat::from_vec4(axis).conjugate();
                    sum + DVec4::from(term)
                });
                DQuat::from_vec4(sum)
            })
            .fold(DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0), |longest, q| {
                if q.length_squared() > longest.length_squared() { q } else { longest }
            })
            .normalize();
        // M(1) = S T.
        let right = left.conjugate() * DQuat::from_vec4(*matrix * DVec4::W);
        Self::new(left, right)
    }

    /// Returns the projection onto the images of the first two axes: u = R(x) · p, v = R(y) · p.
    pub fn projection(&self) -> Projection {
        let rows = [self.apply(DVec4::X).to_array(), self.apply(DVec4::Y).to_array()];
        // Images of two axes are orthonormal.
        Projection::from_rows(rows[0], rows[1]).unwrap_or(Projection::FIRST)
    }

    /// Returns a rotation whose [`Rotation4::projection`] is the given one.
    pub fn from_projection(projection: &Projection) -> Self {
        let [a, b] = projection.rows();
        let [c, d] = crate::tangent::complement(a, b);
        let candidates = [DMat4::from_cols(a, b, c, d), DMat4::from_cols(a, b, d, c)];
        candidates.iter().find_map(Self::from_matrix).unwrap_or(Self::IDENTITY)
    }
}

/// q = exp(log q): a power multiplies the angle.
fn quaternion_power(q: DQuat, t: f64) -> DQuat {
    quaternion_exp(t * quaternion_log(q))
}

/// Axis times half angle in [0, π].
fn quaternion_log(q: DQuat) -> glam::DVec3 {
    let vector = q.xyz();
    let sin = vector.length();
    if sin > 1e-12 {
        sin.atan2(q.w) / sin * vector
    } else if q.w < 0.0 {
        // Half a turn of the quaternion about no axis in particular.
        glam::DVec3::new(PI, 0.0, 0.0)
    } else {
        vector
    }
}

fn quaternion_exp(log: glam::DVec3) -> DQuat {
    let angle = log.length();
    let (sin, cos) = angle.sin_cos();
    let axis = if angle > 1e-12 { sin / angle * log } else { log };
    DQuat::from_xyzw(axis.x, axis.y, axis.z, cos).normalize()
}
