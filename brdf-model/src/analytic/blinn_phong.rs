//! Blinn's shading formula read as a BRDF.

use brdf_param::DirectionPair;

use crate::Rgb;

/// Blinn's model, f = kD + kS (n·h)ⁿ.
///
/// Source: Cole 2002, Eq. 1.2 with kA = 0. What is printed there is a shading term, whose diffuse
/// part already holds the cosine of the light; here that cosine is divided out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlinnPhong {
    /// Diffuse part kD, in sr⁻¹.
    pub diffuse: Rgb,
    /// Largest value of the lobe kS, in sr⁻¹.
    pub specular: Rgb,
    /// Exponent n, ≥ 0.
    pub n: f64,
}

impl BlinnPhong {
    pub(super) fn value(&self, pair: &DirectionPair) -> Rgb {
        self.diffuse + self.specular * pair.half().z.max(0.0).powf(self.n)
    }
}
