//! Isotropic GGX lobes on a diffuse base: what renderers call a standard surface.

use std::f64::consts::PI;

use brdf_param::DirectionPair;
use serde::{Deserialize, Serialize};

use crate::brdf::is_lit;
use crate::{Brdf, Rgb};

/// A GGX lobe with Schlick's reflectance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct GgxLobe {
    /// Reflectance at normal incidence.
    pub f0: Rgb,
    /// Reflectance at grazing incidence.
    pub f90: f64,
    /// Roughness α, > 0: the square of what editors call roughness.
    pub alpha: f64,
}

/// An isotropic, reciprocal model: f = kd/π + Σ D F G₂ / (4 cosθi cosθo) + ks (1 − cosθd)⁵.
///
/// D is the GGX distribution, G₂ Smith's height-correlated masking and shadowing, F = f0 + (f90 − f0)(1 − cosθd)⁵
/// (Schlick 1994), and the last term is the sheen of Burley 2012. Nothing keeps its energy below 1.
///
/// ```
/// use brdf_model::{Brdf, GgxLobe, GgxLobes, Rgb};
/// use brdf_param::DirectionPair;
///
/// let lobe = GgxLobe { f0: Rgb::splat(0.04), f90: 1.0, alpha: 0.2 };
/// let model = GgxLobes { diffuse: Rgb::splat(0.5), lobes: vec![lobe], sheen: Rgb::BLACK };
/// let value = model.eval(&DirectionPair::from_angles(0.0, 0.0, 0.0, 0.0)).g;
/// let expected = 0.5 / std::f64::consts::PI + 0.04 / (4.0 * std::f64::consts::PI * 0.2_f64.powi(2));
/// assert!((value - expected).abs() < 1e-9);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct GgxLobes {
    /// Diffuse albedo kd of the base.
    pub diffuse: Rgb,
    /// The lobes.
    pub lobes: Vec<GgxLobe>,
    /// Sheen ks, sr⁻¹ at grazing difference angles.
    pub sheen: Rgb,
}

impl GgxLobes {
    /// Returns the number of parameters: six, and five for each lobe.
    pub fn parameters(&self) -> usize {
        6 + 5 * self.lobes.len()
    }
}

impl Brdf for GgxLobes {
    fn eval(&self, pair: &DirectionPair) -> Rgb {
        if !is_lit(pair) {
            return Rgb::BLACK;
        }
        let half = pair.half();
        let sin_sq = half.x * half.x + half.y * half.y;
        let (zi, zo) = (pair.wi.z, pair.wo.z);
        let falloff = 1.0 - half.dot(pair.wi).clamp(0.0, 1.0);
        let fifth = falloff * falloff * falloff * falloff * falloff;
        let lobes = self.lobes.iter().map(|lobe| {
            let square = lobe.alpha * lobe.alpha;
            let spread = sin_sq / square + half.z * half.z;
            let distribution = 1.0 / (PI * square * spread * spread);
            let reach = |z: f64| (square + (1.0 - square) * z * z).sqrt();
            let visibility = 0.5 / (zo * reach(zi) + zi * reach(zo));
            let fresnel = lobe.f0 * (1.0 - fifth) + Rgb::splat(lobe.f90 * fifth);
            fresnel * (distribution * visibility)
        });
        self.diffuse / PI + self.sheen * fifth + lobes.sum::<Rgb>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Analytic, Fresnel, Ggx, PairSampling};

    /// Where f0 and f90 are 1 and the facets reflect everything, it is the GGX model with a perfect mirror.
    #[test]
    fn one_white_lobe_is_the_ggx_model() {
        let white = GgxLobe { f0: Rgb::splat(1.0), f90: 1.0, alpha: 0.3 };
        let lobes = GgxLobes { diffuse: Rgb::BLACK, lobes: vec![white], sheen: Rgb::BLACK };
        let mirror = Fresnel::Conductor { eta: Rgb::splat(1e-9), k: Rgb::splat(1e9) };
        let ggx = Ggx { diffuse: Rgb::BLACK, fresnel: mirror, alpha_x: 0.3, alpha_y: 0.3 };
        let ggx = Analytic::Ggx(ggx);
        for pair in (PairSampling { count: 200, seed: 1, theta_max: 1.5 }).pairs() {
            let (a, b) = (lobes.eval(&pair).g, ggx.eval(&pair).g);
            assert!((a / b - 1.0).abs() < 1e-6, "{a} against {b} at {pair:?}");
        }
    }
}
