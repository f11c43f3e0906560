//! A diffuse base with a normalized Blinn lobe: the plastic of the relighting figures.

use std::f64::consts::PI;

use brdf_param::DirectionPair;

use crate::Rgb;

/// f = kd/π + ks (n + 2)/(8π) (n·h)ⁿ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plastic {
    /// Diffuse albedo kd.
    pub diffuse: Rgb,
    /// Strength of the lobe ks.
    pub specular: f64,
    /// Exponent.
    pub n: f64,
}

impl Plastic {
    pub(super) fn value(&self, pair: &DirectionPair) -> Rgb {
        let lobe = (self.n + 2.0) / (8.0 * PI) * pair.half().z.max(0.0).powf(self.n);
        self.diffuse / PI + Rgb::splat(self.specular * lobe)
    }
}
