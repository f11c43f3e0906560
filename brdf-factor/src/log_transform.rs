//! The maps that turn a product into a sum.

use serde::{Deserialize, Serialize};

use brdf_model::SampleSet;

/// Which logarithm is fitted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum LogTransform {
    /// log(a + f) with a = 1e-5 of the channel's mean. Exact zeros stay in.
    #[default]
    Offset,
    /// log f. Samples with a zero channel are dropped and counted.
    Log,
    /// log(a − f) with a a little above the largest value: resolves highlights, not shadows.
    Highlight,
}

/// The map of one channel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "map", rename_all = "kebab-case")]
pub enum ChannelTransform {
    /// ln(a + f).
    Offset {
        /// a in sr⁻¹.
        a: f64,
    },
    /// ln f.
    Log,
    /// ln(a − f).
    Highlight {
        /// a in sr⁻¹, above every fitted value.
        a: f64,
    },
    /// The channel is zero everywhere; its texels are not read.
    Zero,
}

/// How far a of [`ChannelTransform::Highlight`] lies above the largest value: the brightest sample then
/// is 1 % of a away from the singularity.
const HIGHLIGHT_MARGIN: f64 = 1.01;

impl ChannelTransform {
    /// The maps of each channel of a set of samples.
    pub fn for_samples(log_map: LogTransform, samples: &SampleSet) -> Vec<Self> {
        samples
            .values()
            .iter()
            .zip(brdf_model::log_offsets(samples))
            .map(|(channel, offset)| {
                let largest = channel.iter().copied().fold(0.0, f64::max);
                match log_map {
                    _ if largest <= 0.0 => Self::Zero,
                    LogTransform::Offset => Self::Offset { a: offset },
                    LogTransform::Log => Self::Log,
                    LogTransform::Highlight => Self::highlight(largest),
                }
            })
            .collect()
    }

    /// ln(a − f) for values up to `largest`; [`ChannelTransform::Zero`] if that is not above 0.
    pub fn highlight(largest: f64) -> Self {
        if largest > 0.0 { Self::Highlight { a: HIGHLIGHT_MARGIN * largest } } else { Self::Zero }
    }

    /// The value that is fitted for a reflectance in sr⁻¹.
    pub fn forward(&self, f: f64) -> f64 {
        match *self {
            Self::Offset { a } => (a + f).ln(),
            Self::Log => f.ln(),
            Self::Highlight { a } => (a - f).ln(),
            Self::Zero => 0.0,
        }
    }

    /// How fast the reflectance changes with a fitted value.
    pub fn slope(&self, value: f64) -> f64 {
        match self {
            Self::Offset { .. } | Self::Log => value.exp(),
            Self::Highlight { .. } => -value.exp(),
            Self::Zero => 0.0,
        }
    }

    /// The reflectance of a fitted value, in sr⁻¹; it may be negative.
    pub fn inverse(&self, value: f64) -> f64 {
        match *self {
            Self::Offset { a } => value.exp() - a,
            Self::Log => value.exp(),
            Self::Highlight { a } => a - value.exp(),
            Self::Zero => 0.0,
        }
    }
}
