//! A diffuse base with a normalized Blinn lobe.

use std::f64::consts::PI;

use brdf_param::DirectionPair;

use crate::Rgb;

/// A plastic: a diffuse base with a normalized Blinn lobe, f = kd/π + ks (n + 2)/(8π) (n·h)ⁿ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plastic {
    /// Diffuse albedo kd, [0, 1].
    pub diffuse: Rgb,
    /// Strength ks of the lobe.
    pub specular: f64,
    /// Exponent n, ≥ 0.
    pub n: f64,
}

impl Plastic {
    pub(super) fn value(&self, pair: &DirectionPair) -> Rgb {
        let lobe = (self.n + 2.0) / (8.0 * PI) * pair.half().z.max(0.0).powf(self.n);
        self.diffuse / PI + Rgb::splat(self.specular * lobe)
    }
}
