//! Unit directions, pairs of them, and their spherical angles.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

/// Returns the unit direction at polar angle `theta` from the normal and azimuth `phi` from the
/// tangent, both in radians.
///
/// A negative `theta` is the direction at `|theta|` on the far side, `phi + π`, which is how
/// in-plane goniometers write it.
///
/// ```
/// use brdf_param::{azimuth, polar_angle, spherical_direction};
///
/// let w = spherical_direction(0.3, 1.2);
/// assert!((w.length() - 1.0).abs() < 1e-15);
/// assert!((polar_angle(w) - 0.3).abs() < 1e-15 && (azimuth(w) - 1.2).abs() < 1e-15);
/// ```
pub fn spherical_direction(theta: f64, phi: f64) -> DVec3 {
    let (sin_theta, cos_theta) = theta.sin_cos();
    let (sin_phi, cos_phi) = phi.sin_cos();
    DVec3::new(sin_theta * cos_phi, sin_theta * sin_phi, cos_theta)
}

/// Returns the angle between a direction and the normal in radians, [0, π]; exact to rounding at the
/// pole and at the horizon.
pub fn polar_angle(direction: DVec3) -> f64 {
    direction.x.hypot(direction.y).atan2(direction.z)
}

/// Returns the azimuth of a direction: its angle from the tangent about the normal, in radians,
/// (−π, π]; 0 at the pole, where it is undefined.
pub fn azimuth(direction: DVec3) -> f64 {
    if direction.x == 0.0 && direction.y == 0.0 { 0.0 } else { direction.y.atan2(direction.x) }
}

/// Returns an azimuth, in radians, brought to (−π, π] by whole turns.
///
/// ```
/// use std::f64::consts::PI;
///
/// assert!((brdf_param::wrap_azimuth(1.5 * PI) + 0.5 * PI).abs() < 1e-15);
/// ```
pub fn wrap_azimuth(phi: f64) -> f64 {
    let wrapped = phi - TAU * (phi / TAU).round();
    if wrapped <= -PI { wrapped + TAU } else { wrapped }
}

/// A pair of directions, to the light and to the viewer, each of unit length, in the surface frame.
///
/// ```
/// use brdf_param::DirectionPair;
/// use glam::DVec3;
///
/// // The light 30° from the normal, the viewer where a mirror would send it.
/// let pair = DirectionPair::from_angles(0.5236, 0.0, 0.5236, std::f64::consts::PI);
/// assert!(pair.is_above_horizon());
/// assert!(pair.half().distance(DVec3::Z) < 1e-12);
/// assert_eq!(pair.swapped().wi, pair.wo);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionPair {
    /// Unit direction towards the light.
    pub wi: DVec3,
    /// Unit direction towards the viewer.
    pub wo: DVec3,
}

impl DirectionPair {
    /// Returns the pair of two unit directions, towards the light and towards the viewer.
    pub fn new(wi: DVec3, wo: DVec3) -> Self {
        Self { wi, wo }
    }

    /// Returns the pair at polar angles `theta` and azimuths `phi` in radians; see
    /// [`spherical_direction`].
    pub fn from_angles(theta_i: f64, phi_i: f64, theta_o: f64, phi_o: f64) -> Self {
        Self::new(spherical_direction(theta_i, phi_i), spherical_direction(theta_o, phi_o))
    }

    /// Returns the pair with light and viewer exchanged (Helmholtz reciprocity).
    pub fn swapped(&self) -> Self {
        Self::new(self.wo, self.wi)
    }

    /// Returns the pair with both directions turned about the normal by `phi` radians.
    pub fn rotated_about_normal(&self, phi: f64) -> Self {
        let (sin, cos) = phi.sin_cos();
        let turn = |w: DVec3| DVec3::new(cos * w.x - sin * w.y, sin * w.x + cos * w.y, w.z);
        Self::new(turn(self.wi), turn(self.wo))
    }

    /// Returns whether both directions are finite and on the upper side of the surface, z ≥ 0.
    pub fn is_above_horizon(&self) -> bool {
        self.wi.is_finite() && self.wo.is_finite() && self.wi.z >= 0.0 && self.wo.z >= 0.0
    }

    /// Returns whether both directions are on the upper side or below it by no more than rounding
    /// (1e-12), as those that were rebuilt from coordinates of a pair on the horizon may be.
    pub(crate) fn reaches_horizon(&self) -> bool {
        self.wi.is_finite() && self.wo.is_finite() && self.wi.z.min(self.wo.z) >= -1e-12
    }

    /// Returns the unit half vector, norm(wi + wo).
    ///
    /// Two opposite directions have no half vector. They both lie on the horizon and mirror each
    /// other about the normal, so the normal is returned.
    ///
    /// For exact unit vectors wi + wo is perpendicular to wi − wo. For rounded ones it leans a
    /// little. Next to opposite directions, where the sum is short, this lean would cost half the
    /// digits of whatever is rebuilt from the half vector, so it is taken out.
    pub fn half(&self) -> DVec3 {
        let (sum, back) = (self.wi + self.wo, self.wi - self.wo);
        let (sum_sq, back_sq) = (sum.length_squared(), back.length_squared());
        let upright = if sum_sq < back_sq { sum - sum.dot(back) / back_sq * back } else { sum };
        upright.with_z(upright.z.max(0.0)).try_normalize().unwrap_or(DVec3::Z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_negative_polar_angle_is_the_far_side() {
        let near = spherical_direction(-0.3, 0.2);
        let far = spherical_direction(0.3, 0.2 + PI);
        assert!(near.distance(far) < 1e-15, "{near} against {far}");
    }

    #[test]
    fn opposite_directions_have_the_normal_as_half_vector() {
        let pair = DirectionPair::new(DVec3::X, DVec3::NEG_X);
        assert_eq!(pair.half(), DVec3::Z);
    }

    #[test]
    fn azimuths_wrap_to_the_half_open_turn() {
        assert!((wrap_azimuth(1.5 * PI) + 0.5 * PI).abs() < 1e-15);
        assert!((wrap_azimuth(-PI) - PI).abs() < 1e-15);
        assert!((wrap_azimuth(PI) - PI).abs() < 1e-15);
    }
}
