//! Draws that follow a highlight.

use std::f64::consts::TAU;

use brdf_param::spherical_direction;
use glam::DVec3;

/// Directions mirrored about half vectors that cluster around the normal.
pub(crate) struct HalfLobe {
    pub(crate) wo: DVec3,
}

impl HalfLobe {
    /// Exponent of the half vector's cosine: broad enough for satin, narrow enough for gloss.
    const EXPONENT: f64 = 60.0;

    pub(crate) fn sample(&self, u: f64, v: f64) -> DVec3 {
        let cosine = u.powf(1.0 / (Self::EXPONENT + 1.0));
        let half = spherical_direction(cosine.acos(), TAU * v);
        2.0 * self.wo.dot(half) * half - self.wo
    }

    pub(crate) fn pdf(&self, wi: DVec3) -> f64 {
        let half = (wi + self.wo).normalize_or(DVec3::Z);
        let cosine = self.wo.dot(half).abs().max(1e-6);
        (Self::EXPONENT + 1.0) / TAU * half.z.max(0.0).powf(Self::EXPONENT) / (4.0 * cosine)
    }
}
