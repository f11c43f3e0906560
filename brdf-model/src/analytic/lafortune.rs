//! The generalized cosine lobes of Lafortune et al. 1997.

use std::f64::consts::PI;

use brdf_param::DirectionPair;

use crate::Rgb;

/// A generalized cosine lobe, max(0, Cxy (wi.x wo.x + wi.y wo.y) + Cz wi.z wo.z)ⁿ for each channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LafortuneLobe {
    /// Coefficient Cxy of the tangent-plane part; negative for forward scattering.
    pub cxy: Rgb,
    /// Coefficient Cz of the normal part.
    pub cz: Rgb,
    /// Exponent n.
    pub n: Rgb,
}

/// The model of Lafortune et al. 1997, f = ρd/π + the sum of the lobes.
#[derive(Clone, Debug, PartialEq)]
pub struct Lafortune {
    /// Diffuse albedo ρd, [0, 1].
    pub diffuse: Rgb,
    /// Specular, off-specular and retro-reflective lobes.
    pub lobes: Vec<LafortuneLobe>,
}

impl Lafortune {
    pub(super) fn value(&self, pair: &DirectionPair) -> Rgb {
        let across = pair.wi.x * pair.wo.x + pair.wi.y * pair.wo.y;
        let along = pair.wi.z * pair.wo.z;
        let lobes: Rgb = self
            .lobes
            .iter()
            .map(|lobe| {
                (lobe.cxy * across + lobe.cz * along).zip(lobe.n, |base, n| base.max(0.0).powf(n))
            })
            .sum();
        self.diffuse / PI + lobes
    }
}
