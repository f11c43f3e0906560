//! The orthographic parametrization: tangent-plane parts of half and back vector.
//!
//! Source: Barla, Belcour and Pacanowski 2015, section 2, after Neumann et al. 1999.

use std::f64::consts::PI;

use glam::DVec2;

use crate::direction::{DirectionPair, wrap_azimuth};
use crate::hemisphere::HemisphereMap;

/// Polar coordinates of h̄ and k̄, the tangent-plane parts of h = (wi + wo)/2 and
/// k = (wi − wo)/2. An azimuth whose length is 0 is 0.
///
/// The heights of both directions follow from their tangent-plane parts, so near the horizon they
/// return with the square root of the rounding error: 1e-8 at the horizon itself.
///
/// ```
/// use brdf_param::{DirectionPair, Orthographic};
///
/// let pair = DirectionPair::from_angles(0.5, 0.2, 0.5, 0.2);
/// let point = Orthographic::from_pair(&pair);
/// assert!((point.h_length - 0.5_f64.sin()).abs() < 1e-12 && point.k_length < 1e-12);
/// assert!(point.to_pair().is_some_and(|back| back.wi.distance(pair.wi) < 1e-12));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orthographic {
    /// ‖h̄‖, [0, 1].
    pub h_length: f64,
    /// Azimuth of h̄, radians.
    pub phi_h: f64,
    /// ‖k̄‖, [0, 1].
    pub k_length: f64,
    /// Azimuth of k̄, radians.
    pub phi_k: f64,
}

impl Orthographic {
    /// Returns the coordinates of a pair.
    pub fn from_pair(pair: &DirectionPair) -> Self {
        let h = 0.5 * (pair.wi + pair.wo).truncate();
        let k = 0.5 * (pair.wi - pair.wo).truncate();
        Self {
            h_length: h.length(),
            phi_h: planar_azimuth(h),
            k_length: k.length(),
            phi_k: planar_azimuth(k),
        }
    }

    /// Returns the pair at these coordinates (Eq. 3 and 4), or `None` where a direction would leave the
    /// hemisphere.
    pub fn to_pair(&self) -> Option<DirectionPair> {
        let h = self.h_length * DVec2::from_angle(self.phi_h);
        let k = self.k_length * DVec2::from_angle(self.phi_k);
        let lift = |point| HemisphereMap::OrthographicDisc.decode(point);
        Some(DirectionPair::new(lift(h + k)?, lift(h - k)?))
    }

    /// Returns whether the lengths are not negative and both directions exist.
    pub fn is_in_domain(&self) -> bool {
        self.h_length >= 0.0 && self.k_length >= 0.0 && self.to_pair().is_some()
    }

    /// Returns the coordinates with light and viewer exchanged: `phi_k` + π.
    pub fn reciprocal(&self) -> Self {
        Self { phi_k: wrap_azimuth(self.phi_k + PI), ..*self }
    }

    /// Returns the coordinates of the pair turned about the normal so that `phi_h` = 0.
    pub fn isotropic(&self) -> Self {
        Self { phi_h: 0.0, phi_k: wrap_azimuth(self.phi_k - self.phi_h), ..*self }
    }
}

fn planar_azimuth(v: DVec2) -> f64 {
    if v == DVec2::ZERO { 0.0 } else { v.to_angle() }
}
