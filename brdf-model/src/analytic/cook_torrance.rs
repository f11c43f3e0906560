//! Cook and Torrance's microfacet model with V-groove shadowing.

use std::f64::consts::PI;

use brdf_param::DirectionPair;

use crate::{Rgb, dielectric_reflectance};

/// The model of Cook and Torrance, f = kd/π + F D G / (4 cosθi cosθo).
///
/// D is the Beckmann distribution, F the exact Fresnel reflectance of a dielectric, and
/// G = min(1, 2 (n·h)(n·wo)/(wo·h), 2 (n·h)(n·wi)/(wo·h)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CookTorrance {
    /// Diffuse albedo kd, [0, 1].
    pub diffuse: Rgb,
    /// Index of refraction, > 0.
    pub ior: f64,
    /// Root-mean-square slope m of the facets, > 0.
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
