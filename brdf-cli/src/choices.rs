//! The choices of `brdf factor` and the library's enums behind them, so that libraries know no clap.

use brdf_factor::{Coordinate, FactorSpec, LogMap, Weight};
use brdf_param::{Bound, Space};
use brdf_search::Objective;
use clap::ValueEnum;

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum MethodArg {
    /// One texture for each of the best projections, which are searched for
    Search,
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
    /// Search both; the lower error on validation pairs wins
    Auto,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum StrategyArg {
    /// All projections together, by gradients, from many starts
    Joint,
    /// One projection after another by Powell's method, as in the thesis
    Powell,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ObjectiveArg {
    /// Mean square of log residuals
    Relative,
    /// Mean square of linear residuals
    Absolute,
    /// Mean of both absolute residuals
    Blend,
}

/// Factors of given coordinates that stand beside the searched ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum BesideArg {
    /// p(wi) q(h) p(wo)
    Mccool,
    /// p(|wi⊥|) q(|h⊥|) p(|wo⊥|)
    Radial,
    /// The half vector, in whatever space the search takes place
    H,
    /// The difference vector
    D,
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
pub(crate) enum ReciprocityArg {
    On,
    Off,
    /// For --method search: try both; the lower error on validation pairs wins
    Auto,
}

impl SpaceArg {
    /// The spaces to search.
    pub(crate) fn spaces(self) -> &'static [Space] {
        match self {
            Self::Standard => &[Space::Standard],
            Self::HalfDifference => &[Space::HalfDifference],
            Self::Auto => &[Space::Standard, Space::HalfDifference],
        }
    }
}

impl ReciprocityArg {
    /// Whether light and viewer share textures; both where that is to be found out.
    pub(crate) fn candidates(self) -> &'static [bool] {
        match self {
            Self::On => &[true],
            Self::Off => &[false],
            Self::Auto => &[true, false],
        }
    }
}

impl BesideArg {
    pub(crate) fn specs(self, reciprocal: bool) -> Vec<FactorSpec> {
        let one = |coordinate| {
            if reciprocal {
                FactorSpec::reciprocal(coordinate)
            } else {
                FactorSpec::single(coordinate)
            }
        };
        match self {
            Self::Mccool => FactorSpec::mccool(reciprocal),
            Self::Radial => FactorSpec::radial(reciprocal),
            Self::H => vec![one(Coordinate::H)],
            Self::D => vec![one(Coordinate::D)],
        }
    }
}

impl From<ObjectiveArg> for Objective {
    fn from(objective: ObjectiveArg) -> Self {
        match objective {
            ObjectiveArg::Relative => Self::Relative,
            ObjectiveArg::Absolute => Self::Absolute,
            ObjectiveArg::Blend => Self::Blend,
        }
    }
}

impl MethodArg {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Search => "search",
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
