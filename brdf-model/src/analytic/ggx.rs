//! The GGX microfacet model.

use std::f64::consts::PI;

use brdf_param::DirectionPair;
use glam::DVec3;

use crate::{Fresnel, Rgb};

/// The GGX microfacet model, f = kd/π + F D G₂ / (4 cosθi cosθo).
///
/// D is the anisotropic GGX distribution, G₂ Smith's height-correlated masking and shadowing.
///
/// ```
/// use brdf_model::{Analytic, Brdf, Fresnel, Ggx, Rgb};
/// use brdf_param::DirectionPair;
///
/// let glass = Fresnel::Dielectric { ior: 1.5 };
/// let model = Ggx { diffuse: Rgb::BLACK, fresnel: glass, alpha_x: 0.2, alpha_y: 0.2 };
/// let value = Analytic::Ggx(model).eval(&DirectionPair::from_angles(0.0, 0.0, 0.0, 0.0));
/// let expected = 0.04 / (4.0 * std::f64::consts::PI * 0.2_f64.powi(2));
/// assert!((value.g - expected).abs() < 1e-9);
/// ```
///
/// Source: Walter et al. 2007; Heitz 2014, Eq. 86 and 99.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ggx {
    /// Diffuse albedo kd of the base, [0, 1].
    pub diffuse: Rgb,
    /// Reflectance F of the facets.
    pub fresnel: Fresnel,
    /// Roughness along the tangent, > 0.
    pub alpha_x: f64,
    /// Roughness along the bitangent, > 0.
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
