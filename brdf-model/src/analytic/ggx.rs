//! The GGX microfacet model.

use std::f64::consts::PI;

use brdf_param::DirectionPair;
use glam::DVec3;

use crate::{Fresnel, Rgb};

/// f = kd/π + F D G₂ / (4 cosθi cosθo) with the anisotropic GGX distribution and Smith's
/// height-correlated masking and shadowing.
///
/// Source: Walter et al. 2007; Heitz 2014, Eq. 86 and 99.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ggx {
    /// Diffuse albedo of the base.
    pub diffuse: Rgb,
    /// Reflectance of the facets.
    pub fresnel: Fresnel,
    /// Roughness along the tangent.
    pub alpha_x: f64,
    /// Roughness along the bitangent.
    pub alpha_y: f64,
}

impl Ggx {
    pub(super) fn value(&self, pair: &DirectionPair) -> Rgb {
        let half = pair.half();
        let stretched = DVec3::new(half.x / self.alpha_x, half.y / self.alpha_y, half.z);
        let distribution =
            1.0 / (PI * self.alpha_x * self.alpha_y * stretched.length_squared().powi(2));
        // G₂ / (4 cosθi cosθo) = ½ / (cosθo S(wi) + cosθi S(wo)): finite unless both are grazing.
        let spread = |w: DVec3| DVec3::new(self.alpha_x * w.x, self.alpha_y * w.y, w.z).length();
        let visibility = 0.5 / (pair.wo.z * spread(pair.wi) + pair.wi.z * spread(pair.wo));
        let fresnel = self.fresnel.reflectance(half.dot(pair.wi).clamp(0.0, 1.0));
        self.diffuse / PI + fresnel * (distribution * visibility)
    }
}
