//! The standard parametrization: spherical angles of both directions.

use crate::direction::{DirectionPair, azimuth, polar_angle, wrap_azimuth};
use std::f64::consts::FRAC_PI_2;

/// Polar angles and azimuths of `wi` and `wo`, in radians.
///
/// ```
/// use brdf_param::{DirectionPair, Standard};
///
/// let angles = Standard::from_pair(&DirectionPair::from_angles(0.2, 0.1, 0.4, 1.1));
/// assert!((angles.theta_o - 0.4).abs() < 1e-12);
/// assert!((angles.isotropic().phi_o - 1.0).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Standard {
    /// Angle between `wi` and the normal, [0, π/2].
    pub theta_i: f64,
    /// Azimuth of `wi`, (−π, π]; 0 at the pole.
    pub phi_i: f64,
    /// Angle between `wo` and the normal, [0, π/2].
    pub theta_o: f64,
    /// Azimuth of `wo`, (−π, π]; 0 at the pole.
    pub phi_o: f64,
}

impl Standard {
    /// Returns the angles of a pair.
    pub fn from_pair(pair: &DirectionPair) -> Self {
        Self {
            theta_i: polar_angle(pair.wi),
            phi_i: azimuth(pair.wi),
            theta_o: polar_angle(pair.wo),
            phi_o: azimuth(pair.wo),
        }
    }

    /// Returns the pair at these angles.
    pub fn to_pair(&self) -> DirectionPair {
        DirectionPair::from_angles(self.theta_i, self.phi_i, self.theta_o, self.phi_o)
    }

    /// Returns whether both polar angles lie in [0, π/2] and all four angles are finite.
    pub fn is_in_domain(&self) -> bool {
        let quarter_turn = 0.0..=FRAC_PI_2;
        quarter_turn.contains(&self.theta_i)
            && quarter_turn.contains(&self.theta_o)
            && self.phi_i.is_finite()
            && self.phi_o.is_finite()
    }

    /// Returns the angles with light and viewer exchanged.
    pub fn reciprocal(&self) -> Self {
        Self { theta_i: self.theta_o, phi_i: self.phi_o, theta_o: self.theta_i, phi_o: self.phi_i }
    }

    /// Returns the angles of the pair turned about the normal so that `phi_i` = 0.
    pub fn isotropic(&self) -> Self {
        Self { phi_i: 0.0, phi_o: wrap_azimuth(self.phi_o - self.phi_i), ..*self }
    }
}
