//! The half/difference parametrization of Rusinkiewicz.
//!
//! Source: S. Rusinkiewicz, "A New Change of Variables for Efficient BRDF Representation", 1998;
//! inverse as in Barla, Belcour and Pacanowski 2015, Eq. 1 and 2.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;

use crate::direction::{DirectionPair, azimuth, polar_angle, spherical_direction, wrap_azimuth};

/// Angles of the half vector, and of `wi` in the frame whose pole is the half vector, in radians:
/// the parametrization of Rusinkiewicz.
///
/// Where `theta_h` = 0, `phi_h` is 0. Where `wi` = `wo`, `theta_d` = 0 and `phi_d` is 0. Opposite
/// directions take the normal as half vector ([`DirectionPair::half`]).
///
/// ```
/// use brdf_param::{DirectionPair, HalfDifference};
///
/// let pair = DirectionPair::from_angles(0.3, 0.4, 0.3, 0.4);
/// let angles = HalfDifference::from_pair(&pair);
/// assert!((angles.theta_h - 0.3).abs() < 1e-12, "equal directions are their own half vector");
/// assert!(angles.theta_d < 1e-7);
/// assert!(angles.to_pair().wi.distance(pair.wi) < 1e-7);
/// ```
#[doc(alias = "Rusinkiewicz")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfDifference {
    /// Angle between half vector and normal, [0, π/2].
    pub theta_h: f64,
    /// Azimuth of the half vector, (−π, π].
    pub phi_h: f64,
    /// Angle between half vector and `wi`, [0, π/2].
    pub theta_d: f64,
    /// Azimuth of `wi` about the half vector, (−π, π].
    pub phi_d: f64,
}

impl HalfDifference {
    /// Returns the angles of a pair.
    pub fn from_pair(pair: &DirectionPair) -> Self {
        let [half, difference] = Self::vectors(pair);
        Self {
            theta_h: polar_angle(half),
            phi_h: azimuth(half),
            theta_d: polar_angle(difference),
            phi_d: azimuth(difference),
        }
    }

    /// Returns the half vector and the difference vector of a pair: d = rot(b, −theta_h) rot(n, −phi_h) wi.
    pub fn vectors(pair: &DirectionPair) -> [DVec3; 2] {
        let (half, wi) = (pair.half(), pair.wi);
        let (sin_h, cos_h) = (half.truncate().length(), half.z);
        let (sin_p, cos_p) =
            if sin_h > 0.0 { (half.y / sin_h, half.x / sin_h) } else { (0.0, 1.0) };
        let along = cos_p * wi.x + sin_p * wi.y;
        let difference = DVec3::new(
            cos_h * along - sin_h * wi.z,
            cos_p * wi.y - sin_p * wi.x,
            sin_h * along + cos_h * wi.z,
        );
        [half, difference]
    }

    /// Returns the pair at these angles; one of its directions may lie below the horizon, which
    /// [`HalfDifference::is_in_domain`] tells.
    pub fn to_pair(&self) -> DirectionPair {
        let half = spherical_direction(self.theta_h, self.phi_h);
        let d = spherical_direction(self.theta_d, self.phi_d);
        let (sin_h, cos_h) = self.theta_h.sin_cos();
        let (sin_p, cos_p) = self.phi_h.sin_cos();
        let along = cos_h * d.x + sin_h * d.z;
        let wi = DVec3::new(
            cos_p * along - sin_p * d.y,
            sin_p * along + cos_p * d.y,
            cos_h * d.z - sin_h * d.x,
        );
        let wo = 2.0 * wi.dot(half) * half - wi;
        DirectionPair::new(wi, wo)
    }

    /// Returns whether the angles are in range and both directions lie above the horizon, to rounding.
    pub fn is_in_domain(&self) -> bool {
        // The difference vector of opposite directions may pass the quarter turn by rounding.
        let quarter_turn = 0.0..=FRAC_PI_2 + 1e-12;
        quarter_turn.contains(&self.theta_h)
            && quarter_turn.contains(&self.theta_d)
            && self.to_pair().reaches_horizon()
    }

    /// Returns the angles with light and viewer exchanged: `phi_d` + π.
    pub fn reciprocal(&self) -> Self {
        Self { phi_d: wrap_azimuth(self.phi_d + PI), ..*self }
    }

    /// Returns the angles of the pair turned about the normal so that `phi_h` = 0.
    pub fn isotropic(&self) -> Self {
        Self { phi_h: 0.0, ..*self }
    }
}
