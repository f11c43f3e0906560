//! Value maps: a matrix holds reflectance itself, or a logarithm of it.

use serde::{Deserialize, Serialize};

/// The map from reflectance to the values of a matrix, for one channel.
///
/// ```
/// use brdf_separable::ValueTransform;
///
/// let map = ValueTransform::Cosine;
/// let value = map.forward(0.4, 0.5);
/// assert!((value - 1.2_f64.ln()).abs() < 1e-12);
/// assert!((map.inverse(value, 0.5) - 0.4).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "map", rename_all = "kebab-case")]
pub enum ValueTransform {
    /// The reflectance f itself.
    #[default]
    Linear,
    /// The logarithm ln(a + f).
    Offset {
        /// The offset a, in sr⁻¹, > 0.
        a: f64,
    },
    /// The logarithm ln(1 + f cosθi), the cosine not below [`ValueTransform::SMALLEST_COSINE`].
    Cosine,
}

impl ValueTransform {
    /// The smallest cosine that is used, since reflectance is divided by the cosine in the end.
    pub const SMALLEST_COSINE: f64 = 0.02;

    /// Returns the mapped value of a reflectance in sr⁻¹, given the cosine of the direction to the light.
    pub fn forward(self, f: f64, cos_theta_i: f64) -> f64 {
        match self {
            Self::Linear => f,
            Self::Offset { a } => (a + f).ln(),
            Self::Cosine => (f * cos_theta_i.max(Self::SMALLEST_COSINE)).ln_1p(),
        }
    }

    /// Returns the reflectance in sr⁻¹ of a mapped value, given the cosine of the direction to the light; it
    /// may be negative.
    pub fn inverse(self, value: f64, cos_theta_i: f64) -> f64 {
        match self {
            Self::Linear => value,
            Self::Offset { a } => value.exp() - a,
            Self::Cosine => value.exp_m1() / cos_theta_i.max(Self::SMALLEST_COSINE),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_return_what_they_took() {
        for map in
            [ValueTransform::Linear, ValueTransform::Offset { a: 1e-5 }, ValueTransform::Cosine]
        {
            for f in [0.0, 1e-3, 0.4, 250.0] {
                for cosine in [1e-4, 0.3, 1.0] {
                    let back = map.inverse(map.forward(f, cosine), cosine);
                    assert!((back - f).abs() < 1e-12 * (1.0 + f), "{map:?}: {back} for {f}");
                }
            }
        }
    }
}
