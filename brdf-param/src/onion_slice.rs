//! Onion-slice coordinates: the light relative to the azimuth of the view.
//!
//! Source: Havran, Filip and Myszkowski 2010, section 3. Their printed Eq. 3 contradicts its stated
//! intent; what is built here keeps the intent, the mirror direction in the middle of every slice:
//! sin β = sin θi · sin(φi − φv), α = atan2(sin θi · cos(φi − φv), cos θi).

use std::f64::consts::FRAC_PI_2;

use glam::DVec3;

use crate::direction::{DirectionPair, azimuth, polar_angle, spherical_direction};

/// The light at (α, sin β) in slices that stand across the view azimuth, and the view itself.
///
/// The map to (α, sin β) is equal-area: dω = dα d(sin β). Where the view is at the zenith, its
/// azimuth still fixes the frame of the light; coordinates of a pair have azimuth 0 there. Next to the
/// poles of the slices, cos β comes back through a square root, and directions return with the root of
/// the rounding error.
///
/// ```
/// use brdf_param::{DirectionPair, OnionSlice};
///
/// // The viewer at 0.6 from the normal, the light in the mirror direction.
/// let pair = DirectionPair::from_angles(0.6, 0.0, 0.6, std::f64::consts::PI);
/// let slice = OnionSlice::from_pair(&pair);
/// assert!((slice.alpha + 0.6).abs() < 1e-12 && slice.sin_beta.abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnionSlice {
    /// Angle of the slice from the normal towards the view azimuth, radians, [−π/2, π/2].
    pub alpha: f64,
    /// Sine of the angle within the slice, [−1, 1]; 0 in the plane of the view.
    pub sin_beta: f64,
    /// Angle between view and normal, radians, [0, π/2].
    pub theta_v: f64,
    /// Azimuth of the view, radians.
    pub phi_v: f64,
}

impl OnionSlice {
    /// Returns the coordinates of a pair, in the frame of its own view azimuth.
    pub fn from_pair(pair: &DirectionPair) -> Self {
        let phi_v = azimuth(pair.wo);
        let (alpha, sin_beta) = Self::light(pair.wi, phi_v);
        Self { alpha, sin_beta, theta_v: polar_angle(pair.wo), phi_v }
    }

    /// Returns (α, sin β) of a light direction, α in radians, for the view azimuth `phi_v` in radians.
    ///
    /// On the two poles of the slices, where sin β = ±1, α is 0.
    pub fn light(wi: DVec3, phi_v: f64) -> (f64, f64) {
        let (sin_v, cos_v) = phi_v.sin_cos();
        let along = cos_v * wi.x + sin_v * wi.y;
        let sin_beta = (cos_v * wi.y - sin_v * wi.x).clamp(-1.0, 1.0);
        let alpha = if along == 0.0 && wi.z == 0.0 { 0.0 } else { along.atan2(wi.z) };
        (alpha, sin_beta)
    }

    /// Returns the pair at these coordinates.
    pub fn to_pair(&self) -> DirectionPair {
        let cos_beta = (1.0 - self.sin_beta * self.sin_beta).max(0.0).sqrt();
        let (sin_alpha, cos_alpha) = self.alpha.sin_cos();
        let (sin_v, cos_v) = self.phi_v.sin_cos();
        let along = sin_alpha * cos_beta;
        let wi = DVec3::new(
            cos_v * along - sin_v * self.sin_beta,
            sin_v * along + cos_v * self.sin_beta,
            cos_alpha * cos_beta,
        );
        DirectionPair::new(wi, spherical_direction(self.theta_v, self.phi_v))
    }

    /// Returns whether all coordinates are in range.
    pub fn is_in_domain(&self) -> bool {
        self.alpha.abs() <= FRAC_PI_2
            && self.sin_beta.abs() <= 1.0
            && (0.0..=FRAC_PI_2).contains(&self.theta_v)
            && self.phi_v.is_finite()
    }

    /// Returns the coordinates with light and viewer exchanged, by way of the directions.
    pub fn reciprocal(&self) -> Self {
        Self::from_pair(&self.to_pair().swapped())
    }

    /// Returns the coordinates of the pair turned about the normal so that `phi_v` = 0.
    pub fn isotropic(&self) -> Self {
        Self { phi_v: 0.0, ..*self }
    }
}
