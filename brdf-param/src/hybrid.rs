//! The hybrid parametrization: tangent-plane part of the half vector, full length of the back
//! vector.
//!
//! Source: Barla, Belcour and Pacanowski 2015, section 2 and appendix, after Stark et al. 2005.
//! The inverse printed there loses the branch of theta_k for half of all pairs; with
//! theta_k = atan2(h·n, −‖h̄‖ cos(phi_h − phi_k)) it is a bijection.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;

use crate::direction::{DirectionPair, azimuth, spherical_direction, wrap_azimuth};

/// Length and azimuth of h̄, the tangent-plane part of h = (wi + wo)/2, and length and azimuth of
/// k = (wi − wo)/2.
///
/// h·n is rebuilt as √(1 − ‖k‖² − ‖h̄‖²): near the horizon it returns with the square root of
/// the rounding error. Where h̄ = 0, `phi_h` is 0; where wi = wo, `phi_k` is 0; where k points
/// straight along the normal its azimuth is 0 too, and theta_k alone carries it.
///
/// ```
/// use brdf_param::{DirectionPair, HalfDifference, Hybrid};
///
/// let pair = DirectionPair::from_angles(0.9, 0.3, 0.4, 2.2);
/// let (hybrid, angles) = (Hybrid::from_pair(&pair), HalfDifference::from_pair(&pair));
/// assert!((hybrid.k_length - angles.theta_d.sin()).abs() < 1e-12);
/// assert!(hybrid.to_pair().wo.distance(pair.wo) < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hybrid {
    /// ‖h̄‖ = sin(theta_h) cos(theta_d), [0, 1].
    pub h_length: f64,
    /// Azimuth of the half vector, radians.
    pub phi_h: f64,
    /// ‖k‖ = sin(theta_d), [0, 1].
    pub k_length: f64,
    /// Azimuth of the back vector, radians.
    pub phi_k: f64,
}

impl Hybrid {
    /// Returns the coordinates of a pair.
    pub fn from_pair(pair: &DirectionPair) -> Self {
        let h = 0.5 * (pair.wi + pair.wo);
        let k = 0.5 * (pair.wi - pair.wo);
        Self {
            h_length: h.truncate().length(),
            phi_h: azimuth(h),
            k_length: k.length(),
            phi_k: azimuth(k),
        }
    }

    /// Returns the angle theta_k between the back vector k and the normal, radians in [0, π].
    ///
    /// Where h·n = 0 both directions lie on the horizon and so does k: π/2.
    pub fn theta_k(&self) -> f64 {
        let h_normal = self.half_height();
        if h_normal > 0.0 {
            h_normal.atan2(-self.h_length * (self.phi_h - self.phi_k).cos())
        } else {
            FRAC_PI_2
        }
    }

    /// Returns the pair at these coordinates (Eq. 5 and 6). Outside the domain its directions are not of
    /// unit length or lie below the horizon.
    pub fn to_pair(&self) -> DirectionPair {
        let (sin_phi, cos_phi) = self.phi_h.sin_cos();
        let h = DVec3::new(self.h_length * cos_phi, self.h_length * sin_phi, self.half_height());
        let k = self.k_length * spherical_direction(self.theta_k(), self.phi_k);
        DirectionPair::new(h + k, h - k)
    }

    /// Returns whether ‖h̄‖² + ‖k‖² ≤ 1 and both directions lie above the horizon (to 1e-7, the
    /// accuracy with which heights can be rebuilt there).
    pub fn is_in_domain(&self) -> bool {
        let pair = self.to_pair();
        self.h_length >= 0.0
            && self.k_length >= 0.0
            && self.h_length.hypot(self.k_length) <= 1.0 + 1e-12
            && pair.wi.z.min(pair.wo.z) >= -1e-7
    }

    /// Returns the coordinates with light and viewer exchanged: `phi_k` + π.
    pub fn reciprocal(&self) -> Self {
        Self { phi_k: wrap_azimuth(self.phi_k + PI), ..*self }
    }

    /// Returns the coordinates of the pair turned about the normal so that `phi_h` = 0.
    pub fn isotropic(&self) -> Self {
        Self { phi_h: 0.0, phi_k: wrap_azimuth(self.phi_k - self.phi_h), ..*self }
    }

    /// h·n.
    fn half_height(&self) -> f64 {
        (1.0 - self.k_length * self.k_length - self.h_length * self.h_length).max(0.0).sqrt()
    }
}
