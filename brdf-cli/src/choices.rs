//! The choices of `brdf factor` and the library's enums behind them, so that libraries know no clap.

use brdf_factor::{LogMap, Weight};
use brdf_param::{Bound, Space};
use clap::ValueEnum;

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum MethodArg {
    /// p(wi) q(h) p(wo), two textures
    Mccool,
    /// p(|wi⊥|) q(|h⊥|) p(|wo⊥|), one-dimensional, isotropic materials
    Radial,
    /// One texture for each projection of a file
    Projections,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum SpaceArg {
    /// Directions to light and viewer
    Standard,
    /// Half and difference vector
    HalfDifference,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum BoundArg {
    /// The image of the sampled discs: nothing wasted
    Disc,
    /// The image of a cube around them, as in the thesis
    Cube,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum LogMapArg {
    /// log(a + f), a = 1e-5 of the mean; zeros stay
    Offset,
    /// log f; samples with zeros are dropped and counted
    Log,
    /// log(a − f), a above the largest value; resolves highlights
    Highlight,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum WeightArg {
    /// 1: relative error counts
    Log,
    /// f: halves the linear error for a fifth more log error
    F,
    /// f²: close to the linear error
    F2,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Switch {
    On,
    Off,
}

impl From<SpaceArg> for Space {
    fn from(space: SpaceArg) -> Self {
        match space {
            SpaceArg::Standard => Self::Standard,
            SpaceArg::HalfDifference => Self::HalfDifference,
        }
    }
}

impl MethodArg {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Mccool => "mccool",
            Self::Radial => "radial",
            Self::Projections => "projections",
        }
    }
}

impl From<BoundArg> for Bound {
    fn from(bound: BoundArg) -> Self {
        match bound {
            BoundArg::Disc => Self::Disc,
            BoundArg::Cube => Self::Cube,
        }
    }
}

impl From<LogMapArg> for LogMap {
    fn from(log_map: LogMapArg) -> Self {
        match log_map {
            LogMapArg::Offset => Self::Offset,
            LogMapArg::Log => Self::Log,
            LogMapArg::Highlight => Self::Highlight,
        }
    }
}

impl From<WeightArg> for Weight {
    fn from(weight: WeightArg) -> Self {
        match weight {
            WeightArg::Log => Self::Log,
            WeightArg::F => Self::F,
            WeightArg::F2 => Self::F2,
        }
    }
}
