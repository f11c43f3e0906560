//! Scalar quantization of scales and values.

use serde::{Deserialize, Serialize};

/// The spacing of codes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Spacing {
    /// Equal steps from the least to the largest value.
    Linear,
    /// Equal ratios; code 0 is 0.
    Log,
}

/// A map between values of a book and codes of a few bits.
///
/// ```
/// let steps = btf_vq::Quantizer::linear(8, [0.0, 1.0].into_iter());
/// assert_eq!(steps.encode(0.5), 128);
/// assert!((steps.decode(128) - 0.5).abs() < 0.002);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Quantizer {
    /// Bits of a code, 1 to 16.
    pub bits: u32,
    /// Spacing of the codes.
    #[serde(rename = "law")] // its name in files
    pub spacing: Spacing,
    /// Least value (above 0, of a logarithmic one).
    pub min: f32,
    /// Largest value.
    pub max: f32,
}

/// Ratio of the largest to the least value from which linear steps are too coarse for the small ones.
const LINEAR_RANGE: f32 = 64.0;

/// Least value of logarithmic steps over the largest.
const LEAST_SHARE: f32 = 1e-5;

impl Quantizer {
    /// Returns linear steps, as in the paper, or logarithmic ones where values differ by more than a factor of 64.
    pub fn for_scales(bits: u32, scales: &[f32]) -> Self {
        let (min, max) = range(scales.iter().copied().filter(|s| *s > 0.0));
        let has_zero = scales.contains(&0.0);
        if max > LINEAR_RANGE * min || (has_zero && scales.iter().all(|s| *s <= 0.0)) {
            Self { bits, spacing: Spacing::Log, min, max }
        } else {
            Self { bits, spacing: Spacing::Linear, min: if has_zero { 0.0 } else { min }, max }
        }
    }

    /// Returns logarithmic steps over at most five decades below the largest value, so that a few tiny ones do not
    /// make the others coarse.
    pub fn logarithmic(bits: u32, scales: &[f32]) -> Self {
        let (min, max) = range(scales.iter().copied().filter(|s| *s > 0.0));
        Self { bits, spacing: Spacing::Log, min: min.max(max * LEAST_SHARE), max }
    }

    /// Returns linear steps between the smallest and the largest value.
    pub fn linear(bits: u32, values: impl Iterator<Item = f32>) -> Self {
        let (min, max) = range(values);
        Self { bits, spacing: Spacing::Linear, min, max }
    }

    fn top(&self) -> u32 {
        (1 << self.bits) - 1
    }

    /// Returns the code whose value is nearest to `value`.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to codes of at most 16 bits"
    )]
    pub fn encode(&self, value: f32) -> u32 {
        let (position, first) = match self.spacing {
            _ if self.max <= self.min => (0.0, u32::from(self.spacing == Spacing::Log)),
            Spacing::Linear => ((value - self.min) / (self.max - self.min), 0),
            Spacing::Log => ((value / self.min).ln() / (self.max / self.min).ln(), 1),
        };
        // Below half of the least value 0 is nearer.
        if self.spacing == Spacing::Log && value <= 0.5 * self.min {
            return 0;
        }
        let steps = (self.top() - first) as f32;
        first + (position.clamp(0.0, 1.0) * steps).round() as u32
    }

    /// Returns the value of a code.
    pub fn decode(&self, code: u32) -> f32 {
        match self.spacing {
            Spacing::Linear => {
                self.min + (self.max - self.min) * code.min(self.top()) as f32 / self.top() as f32
            }
            Spacing::Log if code == 0 => 0.0,
            Spacing::Log => {
                let steps = (self.top() - 1).max(1) as f32;
                self.min * (self.max / self.min).powf((code.min(self.top()) - 1) as f32 / steps)
            }
        }
    }

    /// Returns the values of all codes, in order.
    pub fn table(&self) -> Vec<f32> {
        (0..=self.top()).map(|code| self.decode(code)).collect()
    }

    /// Whether a header's quantizer can be used.
    pub(crate) fn is_sound(&self) -> bool {
        let is_finite = self.min.is_finite() && self.max.is_finite() && self.max >= self.min;
        (1..=16).contains(&self.bits)
            && is_finite
            && (self.spacing == Spacing::Linear || self.min > 0.0)
    }
}

/// Least and largest value; 1 and 1 of none.
fn range(values: impl Iterator<Item = f32>) -> (f32, f32) {
    let (min, max) =
        values.fold((f32::INFINITY, f32::NEG_INFINITY), |(min, max), v| (min.min(v), max.max(v)));
    if min <= max { (min, max) } else { (1.0, 1.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_is_its_own_nearest() {
        for spacing in [Spacing::Linear, Spacing::Log] {
            for bits in [1, 5, 8, 16] {
                let quantizer = Quantizer { bits, spacing, min: 0.01, max: 3.0 };
                for code in 0..(1_u32 << bits).min(700) {
                    assert_eq!(
                        quantizer.encode(quantizer.decode(code)),
                        code,
                        "{spacing:?} {bits}"
                    );
                }
            }
        }
    }

    #[test]
    fn zero_stays_zero() {
        for scales in [vec![0.0, 0.5, 0.7], vec![0.0, 1e-4, 0.7], vec![0.0]] {
            let quantizer = Quantizer::for_scales(8, &scales);
            assert!(quantizer.decode(quantizer.encode(0.0)).abs() < 1e-12, "{scales:?}");
        }
    }
}
