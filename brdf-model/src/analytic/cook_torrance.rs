//! Cook and Torrance's microfacet model with V-groove shadowing.

use std::f64::consts::PI;

use brdf_param::DirectionPair;

use crate::{Rgb, dielectric_reflectance};

/// f = kd/π + F D G / (4 cosθi cosθo): Beckmann distribution, exact dielectric Fresnel,
/// G = min(1, 2 (n·h)(n·wo)/(wo·h), 2 (n·h)(n·wi)/(wo·h)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CookTorrance {
    /// Diffuse albedo.
    pub diffuse: Rgb,
    /// Index of refraction.
    pub ior: f64,
    /// Root-mean-square slope m of the facets.
    pub slope: f64,
}

impl CookTorrance {
    pub(super) fn value(&self, pair: &DirectionPair) -> Rgb {
        let half = pair.half();
        let cos_d = half.dot(pair.wo).max(f64::MIN_POSITIVE);
        let (cos_i, cos_o, cos_h) = (pair.wi.z, pair.wo.z, half.z);
        let cos_h_sq = cos_h * cos_h;
        let tan_h_sq = half.truncate().length_squared() / cos_h_sq;
        let slope_sq = self.slope * self.slope;
        let distribution = (-tan_h_sq / slope_sq).exp() / (PI * slope_sq * cos_h_sq * cos_h_sq);
        // G / (cosθi cosθo), written so that it stays finite while one cosine vanishes.
        let shadowing = (1.0 / (cos_i * cos_o)).min(2.0 * cos_h / (cos_d * cos_i.max(cos_o)));
        let fresnel = dielectric_reflectance(cos_d.min(1.0), self.ior);
        self.diffuse / PI + Rgb::splat(0.25 * fresnel * distribution * shadowing)
    }
}
