//! Moving a projection along the manifold of orthonormal frames (Stiefel manifold).

use brdf_param::{Bound, DiscRadii, Projection};
use glam::DVec4;

/// Directions in which two orthonormal rows can move: each row towards either vector that is
/// perpendicular to the plane, and both within the plane.
pub(crate) const DIRECTIONS: usize = 5;

/// How both rows change along each direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tangent {
    rows: [[DVec4; 2]; DIRECTIONS],
}

impl Tangent {
    /// The tangent space at a projection. The first four directions turn the plane; the last only
    /// spins the texture grid.
    pub(crate) fn at(projection: &Projection) -> Self {
        let [a, b] = projection.rows();
        let [m, n] = complement(a, b);
        let none = DVec4::ZERO;
        Self { rows: [[m, none], [n, none], [none, m], [none, n], [b, -a]] }
    }

    /// Changes of both rows along each direction.
    pub(crate) fn rows(&self) -> &[[DVec4; 2]; DIRECTIONS] {
        &self.rows
    }

    /// The projection after a step of these lengths, in radians: the rows move straight and are made
    /// orthonormal again.
    pub(crate) fn step(&self, projection: &Projection, lengths: &[f64]) -> Projection {
        let mut rows = projection.rows();
        for (direction, length) in self.rows.iter().zip(lengths) {
            rows[0] += *length * direction[0];
            rows[1] += *length * direction[1];
        }
        // Rows stay independent for any step: what a row gains is perpendicular to it.
        Projection::from_rows(rows[0].to_array(), rows[1].to_array()).unwrap_or(*projection)
    }
}

/// Two unit vectors perpendicular to two orthonormal ones and to each other.
pub(crate) fn complement(a: DVec4, b: DVec4) -> [DVec4; 2] {
    let reject = |v: DVec4, from: &[DVec4]| {
        // Twice, for full precision.
        let once = from.iter().fold(v, |v, f| v - v.dot(*f) * *f);
        from.iter().fold(once, |v, f| v - v.dot(*f) * *f)
    };
    let farthest = |from: &[DVec4]| {
        let rejected = DVec4::AXES.map(|axis| reject(axis, from));
        let longest = rejected.into_iter().fold(DVec4::ZERO, |best, v| {
            if v.length_squared() > best.length_squared() { v } else { best }
        });
        longest.normalize()
    };
    let m = farthest(&[a, b]);
    [m, farthest(&[a, b, m])]
}

/// How the extent of a row changes with the row: the gradient of what
/// [`Projection::extent`] computes.
pub(crate) fn extent_gradient(row: DVec4, bound: Bound, radii: DiscRadii) -> DVec4 {
    match bound {
        Bound::Cube => row.signum(),
        Bound::Disc => {
            let unit = |x: f64, y: f64, radius: f64| {
                let length = x.hypot(y);
                if length > 0.0 { [radius * x / length, radius * y / length] } else { [0.0; 2] }
            };
            let [x, y] = unit(row.x, row.y, radii.first);
            let [z, w] = unit(row.z, row.w, radii.second);
            DVec4::new(x, y, z, w)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::StartRng;

    #[test]
    fn tangents_are_orthonormal_and_steps_stay_on_the_manifold() {
        let mut rng = StartRng::new(1, 0, 0);
        for _ in 0..100 {
            let projection = rng.projection();
            let tangent = Tangent::at(&projection);
            let [a, b] = projection.rows();
            for [da, db] in tangent.rows() {
                let off = [a.dot(*da), b.dot(*db), a.dot(*db) + b.dot(*da)];
                assert!(off.iter().all(|v| v.abs() < 1e-14), "{off:?}");
            }
            let moved = tangent.step(&projection, &[0.3, -0.2, 0.1, 0.7, -0.4]).rows();
            assert!(moved[0].dot(moved[1]).abs() < 1e-14, "{moved:?}");
        }
    }
}
