//! Maps of the upper hemisphere to the plane and back.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DVec2, DVec3};
#[cfg(feature = "serde")]
use serde::{Deserialize, Serialize};

use crate::direction::{azimuth, polar_angle, spherical_direction};

/// A map between unit directions of the upper hemisphere and points of a plane domain.
///
/// ```
/// use brdf_param::{HemisphereMap, spherical_direction};
///
/// let w = spherical_direction(0.7, 2.0);
/// let point = HemisphereMap::Parabolic.encode(w);
/// assert!((point.length() - 0.35_f64.tan()).abs() < 1e-15, "the radius is tan(theta/2)");
/// let back = HemisphereMap::Parabolic.decode(point).expect("the point lies in the unit disc");
/// assert!(back.distance(w) < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum HemisphereMap {
    /// Spherical angles `(theta, phi)` in radians, [0, π/2] × (−π, π].
    Spherical,
    /// Paraboloid coordinates `(x, y) / (1 + z)` in the unit disc; radius tan(theta/2).
    ///
    /// Source: Heidrich and Seidel 1998, as used by Cole 2002, section 1.1.3.
    Parabolic,
    /// Orthographic projection `(x, y)` in the unit disc; radius sin(theta).
    ///
    /// Source: Wang, Tran and Luebke 2004, Eq. 7, without their shift to [0, 1].
    OrthographicDisc,
    /// Equal-area polar coordinates `(phi / 2π + ½, √(1 − z))` in the unit square; the first
    /// coordinate wraps around.
    ///
    /// Source: Wang, Tran and Luebke 2004, Eq. 8, whose arctangent is scaled here to a turn and
    /// measured from the tangent.
    Polar,
}

impl HemisphereMap {
    /// All four maps.
    pub const ALL: [Self; 4] =
        [Self::Spherical, Self::Parabolic, Self::OrthographicDisc, Self::Polar];

    /// Returns the point of a unit direction with z ≥ 0. The azimuth of the pole is 0.
    pub fn encode(self, direction: DVec3) -> DVec2 {
        match self {
            Self::Spherical => DVec2::new(polar_angle(direction), azimuth(direction)),
            Self::Parabolic => direction.truncate() / (1.0 + direction.z),
            Self::OrthographicDisc => direction.truncate(),
            Self::Polar => {
                // On the horizon rounding may pass 1.
                let radius = one_minus_cos(direction).sqrt().min(1.0);
                DVec2::new(azimuth(direction) / TAU + 0.5, radius)
            }
        }
    }

    /// Returns the unit direction of a point, or `None` outside the domain or where the point is not
    /// finite.
    ///
    /// Azimuths are taken modulo a turn. A point that lies outside a disc by no more than rounding
    /// (1e-12) counts as lying on its rim.
    pub fn decode(self, point: DVec2) -> Option<DVec3> {
        if !point.is_finite() {
            return None;
        }
        match self {
            Self::Spherical => {
                (0.0..=FRAC_PI_2).contains(&point.x).then(|| spherical_direction(point.x, point.y))
            }
            Self::Parabolic => on_disc(point).map(|point| {
                let radius_sq = point.length_squared();
                (2.0 * point).extend((1.0 - radius_sq).max(0.0)) / (1.0 + radius_sq)
            }),
            Self::OrthographicDisc => on_disc(point)
                .map(|point| point.extend((1.0 - point.length_squared()).max(0.0).sqrt())),
            Self::Polar => (0.0..=1.0).contains(&point.y).then(|| {
                let cos_theta = 1.0 - point.y * point.y;
                let sin_theta = point.y * (1.0 + cos_theta).sqrt();
                let (sin_phi, cos_phi) = (TAU * (point.x - 0.5)).sin_cos();
                DVec3::new(sin_theta * cos_phi, sin_theta * sin_phi, cos_theta)
            }),
        }
    }

    /// Returns the solid angle per unit of area at a point of the domain, dω/dA in steradians.
    ///
    /// It is infinite on the rim of the orthographic disc, where the hemisphere is seen edge-on.
    ///
    /// ```
    /// use brdf_param::HemisphereMap;
    /// use glam::DVec2;
    ///
    /// assert_eq!(HemisphereMap::Parabolic.solid_angle_density(DVec2::ZERO), 4.0);
    /// assert_eq!(HemisphereMap::OrthographicDisc.solid_angle_density(DVec2::ZERO), 1.0);
    /// ```
    pub fn solid_angle_density(self, point: DVec2) -> f64 {
        match self {
            Self::Spherical => point.x.sin(),
            Self::Parabolic => 4.0 / (1.0 + point.length_squared()).powi(2),
            Self::OrthographicDisc => 1.0 / (1.0 - point.length_squared()).max(0.0).sqrt(),
            Self::Polar => 2.0 * TAU * point.y,
        }
    }

    /// Returns the area of the domain in its own units: π² (radians squared), π or 1.
    pub fn domain_area(self) -> f64 {
        match self {
            Self::Spherical => PI * PI,
            Self::Parabolic | Self::OrthographicDisc => PI,
            Self::Polar => 1.0,
        }
    }
}

/// A point of the unit disc; one that lies outside by rounding alone is moved to the rim.
fn on_disc(point: DVec2) -> Option<DVec2> {
    let radius = point.length();
    (radius <= 1.0 + 1e-12).then(|| if radius > 1.0 { point / radius } else { point })
}

/// 1 − z without cancellation near the pole.
fn one_minus_cos(direction: DVec3) -> f64 {
    direction.truncate().length_squared() / (1.0 + direction.z)
}
