//! The anisotropic Phong model of Ashikhmin and Shirley 2000.

use std::f64::consts::PI;

use brdf_param::DirectionPair;

use crate::Rgb;

/// The model of Ashikhmin and Shirley 2000: an anisotropic specular lobe with Schlick's Fresnel term
/// over a diffuse base.
///
/// The lobe grows without bound as 1/max(cosθi, cosθo) towards grazing; that cosine is clamped to
/// [`AshikhminShirley::COSINE_CLAMP`] from below.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AshikhminShirley {
    /// Diffuse albedo kd, [0, 1].
    pub diffuse: Rgb,
    /// Specular reflectance at normal incidence ks, [0, 1].
    pub specular: Rgb,
    /// Exponent along the tangent, ≥ 0.
    pub nu: f64,
    /// Exponent along the bitangent, ≥ 0.
    pub nv: f64,
}

impl AshikhminShirley {
    /// Smallest value of max(cosθi, cosθo) in the denominator of the lobe.
    ///
    /// Only pairs with both directions more than 89.94° from the normal are below it.
    pub const COSINE_CLAMP: f64 = 1e-3;

    pub(super) fn value(&self, pair: &DirectionPair) -> Rgb {
        let half = pair.half();
        let cos_d = half.dot(pair.wi).max(f64::MIN_POSITIVE);
        let sin_h_sq = half.truncate().length_squared();
        let exponent = if sin_h_sq > 0.0 {
            (self.nu * half.x * half.x + self.nv * half.y * half.y) / sin_h_sq
        } else {
            0.0
        };
        let larger_cosine = pair.wi.z.max(pair.wo.z).max(Self::COSINE_CLAMP);
        let lobe = ((self.nu + 1.0) * (self.nv + 1.0)).sqrt() / (8.0 * PI) * half.z.powf(exponent)
            / (cos_d * larger_cosine);
        let fresnel = self.specular + (Rgb::splat(1.0) - self.specular) * (1.0 - cos_d).powi(5);
        let dim = |cosine: f64| 1.0 - (1.0 - 0.5 * cosine).powi(5);
        let base = 28.0 / (23.0 * PI) * dim(pair.wi.z) * dim(pair.wo.z);
        fresnel * lobe + self.diffuse * (Rgb::splat(1.0) - self.specular) * base
    }
}
