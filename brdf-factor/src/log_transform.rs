//! Log maps, which turn a product into a sum.

use serde::{Deserialize, Serialize};

use brdf_model::SampleSet;

/// The kind of logarithm that is fitted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum LogTransform {
    /// log(a + f) with a a small part of the channel's mean, so that exact zeros can be fitted too.
    #[default]
    Offset,
    /// log f; samples with a channel that is zero are dropped and counted.
    Log,
    /// log(a − f) with a a little above the largest value, which resolves highlights rather than shadows.
    Highlight,
}

/// The log map of one channel, with its constant.
///
/// ```
/// use brdf_factor::ChannelTransform;
///
/// let map = ChannelTransform::Offset { a: 0.01 };
/// assert!((map.forward(0.0) - 0.01_f64.ln()).abs() < 1e-12);
/// assert!((map.inverse(map.forward(0.3)) - 0.3).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "map", rename_all = "kebab-case")]
pub enum ChannelTransform {
    /// The map ln(a + f).
    Offset {
        /// The offset a, in sr⁻¹.
        a: f64,
    },
    /// The map ln f.
    Log,
    /// The map ln(a − f).
    Highlight {
        /// The constant a, in sr⁻¹, above every fitted value.
        a: f64,
    },
    /// The map of a channel that is zero everywhere; its texels are not read.
    Zero,
}

/// How far a of [`ChannelTransform::Highlight`] lies above the largest value: the brightest sample then
/// is 1 % of a away from the singularity.
const HIGHLIGHT_MARGIN: f64 = 1.01;

impl ChannelTransform {
    /// Returns the log map of each channel of a set of samples; `offset` is a of [`LogTransform::Offset`] over the
    /// channel's mean.
    pub fn for_samples(log_map: LogTransform, offset: f64, samples: &SampleSet) -> Vec<Self> {
        samples
            .values()
            .iter()
            .zip(samples.mean())
            .map(|(channel, mean)| {
                let largest = channel.iter().copied().fold(0.0, f64::max);
                match log_map {
                    _ if largest <= 0.0 => Self::Zero,
                    LogTransform::Offset => Self::Offset { a: offset * mean },
                    LogTransform::Log => Self::Log,
                    LogTransform::Highlight => Self::highlight(largest),
                }
            })
            .collect()
    }

    /// Returns the map ln(a − f) for values up to `largest`, in sr⁻¹, or [`ChannelTransform::Zero`] if
    /// `largest` is not above 0.
    pub fn highlight(largest: f64) -> Self {
        if largest > 0.0 { Self::Highlight { a: HIGHLIGHT_MARGIN * largest } } else { Self::Zero }
    }

    /// Returns the log value that is fitted for a reflectance in sr⁻¹.
    pub fn forward(&self, f: f64) -> f64 {
        match *self {
            Self::Offset { a } => (a + f).ln(),
            Self::Log => f.ln(),
            Self::Highlight { a } => (a - f).ln(),
            Self::Zero => 0.0,
        }
    }

    /// Returns the derivative of the reflectance by the log value, in sr⁻¹.
    pub fn slope(&self, value: f64) -> f64 {
        match self {
            Self::Offset { .. } | Self::Log => value.exp(),
            Self::Highlight { .. } => -value.exp(),
            Self::Zero => 0.0,
        }
    }

    /// Returns the reflectance of a log value, in sr⁻¹; it may be negative.
    pub fn inverse(&self, value: f64) -> f64 {
        match *self {
            Self::Offset { a } => value.exp() - a,
            Self::Log => value.exp(),
            Self::Highlight { a } => a - value.exp(),
            Self::Zero => 0.0,
        }
    }
}
