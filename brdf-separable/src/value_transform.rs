//! What of a reflectance is factored: itself, or a logarithm.

use serde::{Deserialize, Serialize};

/// The map from reflectance to what a matrix holds, for one channel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "map", rename_all = "kebab-case")]
pub enum ValueTransform {
    /// f.
    #[default]
    Linear,
    /// ln(a + f).
    Offset {
        /// a in sr⁻¹.
        a: f64,
    },
    /// ln(1 + f cosθi), the cosine not below [`ValueTransform::SMALLEST_COSINE`].
    Cosine,
}

impl ValueTransform {
    /// The cosine is divided out again, so it is kept away from 0.
    pub const SMALLEST_COSINE: f64 = 0.02;

    /// What is factored for a reflectance in sr⁻¹ and the cosine of the light.
    pub fn forward(self, f: f64, cos_theta_i: f64) -> f64 {
        match self {
            Self::Linear => f,
            Self::Offset { a } => (a + f).ln(),
            Self::Cosine => (f * cos_theta_i.max(Self::SMALLEST_COSINE)).ln_1p(),
        }
    }

    /// The reflectance in sr⁻¹ of a factored value; it may be negative.
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
