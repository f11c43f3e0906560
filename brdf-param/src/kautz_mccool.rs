//! Half and difference vectors in the frame of the tangent, stable where half vector and normal
//! meet.
//!
//! Source: Kautz and McCool 1999, as given by Cole 2002, Eq. 1.4:
//! h = norm(wi + wo), r = norm(t − (t·h) h), s = h × r, d = (r·wi, s·wi, h·wi).

use std::f64::consts::FRAC_PI_2;

use glam::{DVec2, DVec3};

use crate::direction::{DirectionPair, azimuth};
use crate::hemisphere::HemisphereMap;

/// Parabolic coordinates of the half vector and of the difference vector, each in the unit disc.
///
/// Next to half vectors along the tangent the frame turns quickly, and directions return with the
/// rounding error divided by the distance from there.
///
/// ```
/// use brdf_param::{DirectionPair, KautzMcCool};
///
/// let pair = DirectionPair::from_angles(0.5, 0.0, 0.5, std::f64::consts::PI);
/// let point = KautzMcCool::from_pair(&pair);
/// assert!(point.h.length() < 1e-12, "the half vector is the normal");
/// assert!((point.d.length() - 0.25_f64.tan()).abs() < 1e-12);
/// assert!(point.to_pair().is_some_and(|back| back.wi.distance(pair.wi) < 1e-12));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KautzMcCool {
    /// Parabolic coordinates of the half vector, about the normal.
    pub h: DVec2,
    /// Parabolic coordinates of `wi` in the frame (r, s, h).
    pub d: DVec2,
}

impl KautzMcCool {
    /// Returns the coordinates of a pair.
    pub fn from_pair(pair: &DirectionPair) -> Self {
        let [h, d] = Self::vectors(pair).map(|w| HemisphereMap::Parabolic.encode(w));
        Self { h, d }
    }

    /// Returns the half vector and the difference vector of a pair.
    pub fn vectors(pair: &DirectionPair) -> [DVec3; 2] {
        let half = pair.half();
        let (r, s) = tangent_frame(half);
        [half, DVec3::new(r.dot(pair.wi), s.dot(pair.wi), half.dot(pair.wi))]
    }

    /// Returns the pair at these coordinates, or `None` outside the two unit discs.
    pub fn to_pair(&self) -> Option<DirectionPair> {
        let half = HemisphereMap::Parabolic.decode(self.h)?;
        let difference = HemisphereMap::Parabolic.decode(self.d)?;
        let (r, s) = tangent_frame(half);
        let across = difference.x * r + difference.y * s;
        let along = difference.z * half;
        Some(DirectionPair::new(along + across, along - across))
    }

    /// Returns whether the coordinates lie in their discs and both directions above the horizon, to
    /// rounding.
    pub fn is_in_domain(&self) -> bool {
        self.to_pair().is_some_and(|pair| pair.reaches_horizon())
    }

    /// Returns the coordinates with light and viewer exchanged: d → −d.
    pub fn reciprocal(&self) -> Self {
        Self { h: self.h, d: -self.d }
    }

    /// Returns the coordinates of the pair turned about the normal so that the half vector leans along
    /// the bitangent.
    ///
    /// There the frame is as far from its degenerate place, the tangent, as it can be. The frame is
    /// tied to the tangent, so d turns too: this goes through the directions. Coordinates outside the
    /// domain are returned as they are.
    pub fn isotropic(&self) -> Self {
        self.to_pair().map_or(*self, |pair| {
            Self::from_pair(&pair.rotated_about_normal(FRAC_PI_2 - azimuth(pair.half())))
        })
    }
}

/// r = norm(t − (t·h) h) and s = h × r for a unit `half` with z ≥ 0.
///
/// Both vanish where the half vector meets ±tangent; there the limit from directly above is taken:
/// s = b, and r = s × h points straight down (h = t) or up (h = −t).
fn tangent_frame(half: DVec3) -> (DVec3, DVec3) {
    let sine = half.y.hypot(half.z);
    let s = if sine > 0.0 { DVec3::new(0.0, half.z, -half.y) / sine } else { DVec3::Y };
    (s.cross(half), s)
}
