//! Interpolation between directions by radial basis functions, as fixed matrices.
//!
//! Source: J. Carr et al., "Reconstruction and Representation of 3D Objects with Radial Basis
//! Functions", SIGGRAPH 2001: the biharmonic kernel |x − y| with an affine tail.

use faer::Mat;
use faer::linalg::solvers::{FullPivLu, SolveCore as _};
use glam::DVec3;

use crate::VqError;

/// Below this distance two directions are one (10⁻⁵ of a radian, far below any file's digits).
const SAME: f64 = 1e-5;

/// An exact interpolator of values at given directions.
pub(crate) struct DirectionRbf {
    sites: Vec<DVec3>,
    /// Terms of the polynomial tail: 1, or 1 x y z.
    tail: usize,
    system: FullPivLu<f64>,
    /// Largest polar angle of a site, as the cosine.
    lowest_z: f64,
}

impl DirectionRbf {
    /// An interpolator between unit directions.
    ///
    /// # Errors
    ///
    /// [`VqError::Directions`] without three different ones above the horizon.
    pub(crate) fn new(what: &'static str, sites: &[DVec3]) -> Result<Self, VqError> {
        let is_repeated = |i: usize| sites[..i].iter().any(|other| other.distance(sites[i]) < SAME);
        let different =
            (0..sites.len()).filter(|&i| !is_repeated(i) && sites[i].z >= -SAME).count();
        if different < 3 || different < sites.len() {
            return Err(VqError::Directions {
                what,
                found: different,
                expected: sites.len().max(3),
            });
        }
        let lowest_z = sites.iter().map(|d| d.z).fold(1.0, f64::min);
        // Directions of one ring lie in a plane, where z is a constant.
        let is_flat = sites.iter().all(|d| (d.z - lowest_z).abs() < SAME);
        let tail = if sites.len() >= 6 && !is_flat { 4 } else { 1 };
        let count = sites.len();
        let matrix =
            Mat::from_fn(count + tail, count + tail, |i, j| match (i < count, j < count) {
                (true, true) => sites[i].distance(sites[j]),
                (true, false) => tail_term(sites[i], j - count),
                (false, true) => tail_term(sites[j], i - count),
                (false, false) => 0.0,
            });
        Ok(Self { sites: sites.to_vec(), tail, system: matrix.full_piv_lu(), lowest_z })
    }

    /// Weights of the sites in the value at each target, `[target][site]`. Targets nearer to the
    /// horizon than any site take the value at the outermost sites' polar angle.
    pub(crate) fn weights(&self, targets: &[DVec3]) -> Mat<f64> {
        let count = self.sites.len();
        let mut columns = Mat::from_fn(count + self.tail, targets.len(), |i, j| {
            let target = self.inside(targets[j]);
            if i < count { target.distance(self.sites[i]) } else { tail_term(target, i - count) }
        });
        // The matrix is symmetric: weights are rows of A⁻¹.
        self.system.solve_in_place_with_conj(faer::Conj::No, columns.as_mut());
        Mat::from_fn(targets.len(), count, |target, site| columns[(site, target)])
    }

    fn inside(&self, direction: DVec3) -> DVec3 {
        if direction.z >= self.lowest_z {
            return direction;
        }
        let planar = (1.0 - self.lowest_z * self.lowest_z).max(0.0).sqrt();
        (direction.truncate().normalize_or_zero() * planar).extend(self.lowest_z)
    }
}

fn tail_term(direction: DVec3, term: usize) -> f64 {
    match term {
        0 => 1.0,
        1 => direction.x,
        2 => direction.y,
        _ => direction.z,
    }
}
