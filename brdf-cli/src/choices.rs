//! The choices of `brdf factor` and the library's enums behind them, so that libraries know no clap.

use brdf_factor::{IsotropicPairs, LogTransform, TexelFormat, Weight, Zeros};
use brdf_fit::{FixedFactors, Reciprocity, SeparableMap};
use brdf_param::{Bound, Parametrization, Space};
use brdf_search::Objective;
use brdf_separable::{EigenSolver, Fill};
use clap::ValueEnum;

/// Choices of an option, with the help of each, and the values of the library behind them.
macro_rules! choices {
    (
        $(#[$about:meta])*
        $visible:vis enum $choice:ident for $target:ident {
            $($(#[$help:meta])* $name:ident => $value:ident,)+
        }
    ) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
        $visible enum $choice {
            $($(#[$help])* $name,)+
        }

        impl From<$choice> for $target {
            fn from(choice: $choice) -> Self {
                match choice {
                    $($choice::$name => Self::$value,)+
                }
            }
        }
    };
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum MethodArg {
    /// The best small model of the material: splines, GGX lobes or textures if it is isotropic, else a search
    Auto,
    /// One texture for each of the best projections, which are searched for
    Search,
    /// p(wi) q(h) p(wo), two textures
    Mccool,
    /// p(|wi⊥|) q(|h⊥|) p(|wo⊥|), one-dimensional, isotropic materials
    Radial,
    /// One texture for each projection of a file
    Projections,
    /// Textures over pairs of angles, isotropic materials
    Isotropic,
    /// One texture for each entry of a list of coordinates
    Coordinates,
    /// Sum of products of splines: a few kilobytes that keep the highlight of isotropic materials
    Spline,
    /// A diffuse base, GGX lobes and sheen, isotropic
    Ggx,
    /// Sum of products: truncated singular value decomposition
    Svd,
    /// The same of logarithms
    LogSvd,
    /// Sum of products: eigenpairs, one set of textures for light and view
    Eigen,
    /// Sum of products of non-negative textures
    Nmf,
    /// One product, without iteration
    Normalized,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum SpaceArg {
    /// Directions to light and viewer
    Standard,
    /// Half and difference vector
    HalfDifference,
    /// Half and difference vector in the frame of the tangent (sums of products)
    KautzMccool,
    /// Tangent-plane parts of half and back vector (sums of products)
    Orthographic,
    /// Tangent-plane part of the half vector, whole back vector (sums of products)
    Hybrid,
    /// The view, and the light about it (sums of products)
    OnionSlice,
    /// Search both; for each number of textures the lower error on validation pairs wins
    Auto,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum StrategyArg {
    /// All projections together, by gradients, from many starts
    Joint,
    /// One projection after another by Powell's method, as in the thesis
    Powell,
}

choices! {
    pub(crate) enum ObjectiveArg for Objective {
        /// Mean square of log residuals
        Relative => Relative,
        /// Mean square of linear residuals
        Absolute => Absolute,
        /// Mean of both absolute residuals
        Blend => Blend,
    }
}

choices! {
    /// Factors of given coordinates that stand beside the searched ones.
    pub(crate) enum BesideArg for FixedFactors {
        /// p(wi) q(h) p(wo)
        Mccool => McCool,
        /// p(|wi⊥|) q(|h⊥|) p(|wo⊥|)
        Radial => Radial,
        /// The half vector, in whatever space the search takes place
        H => H,
        /// The difference vector
        D => D,
    }
}

choices! {
    pub(crate) enum BoundArg for Bound {
        /// The image of the sampled discs: nothing wasted
        Disc => Disc,
        /// The image of a cube around them, as in the thesis
        Cube => Cube,
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum LogMapArg {
    /// log(a + f), a = 1e-5 of the mean; zeros stay
    Offset,
    /// log f; samples with zeros are dropped and counted
    Log,
    /// log(a − f), a above the largest value; resolves highlights
    Highlight,
    /// log(1 + f cosθi), for --method log-svd
    Cosine,
}

choices! {
    /// How the hemisphere is laid out in the textures of sums of products.
    pub(crate) enum MapArg for SeparableMap {
        /// Seen from above: (x, y) in the unit disc
        Orthographic => Orthographic,
        /// Azimuth and √(1 − cosθ)
        Polar => Polar,
        /// (x, y) / (1 + z) in the unit disc
        Parabolic => Parabolic,
        /// Azimuth and polar angle
        Spherical => Spherical,
        /// MERL's own grid: theta_h × (theta_d, phi_d), isotropic, 90 × 16200
        Merl => Merl,
    }
}

choices! {
    pub(crate) enum FillArg for Fill {
        /// The value of the nearest pair with data
        Edge => Edge,
        /// 0
        Zero => Zero,
    }
}

choices! {
    pub(crate) enum EigenSolverArg for EigenSolver {
        /// Block Krylov, stopped by residuals
        Krylov => Krylov,
        /// As printed by the relighting paper; fails where eigenvalues of opposite sign are equal
        Power => Power,
    }
}

choices! {
    pub(crate) enum WeightArg for Weight {
        /// 1: relative error counts
        Log => Log,
        /// f: halves the linear error for a fifth more log error
        F => F,
        /// f²: close to the linear error
        F2 => F2,
        /// By what displays, cube roots, energy and logarithms see, together
        Fidelity => Fidelity,
    }
}

choices! {
    pub(crate) enum TexelsArg for TexelFormat {
        /// As they are fitted
        F32 => F32,
        /// Half the bytes
        F16 => F16,
        /// A quarter of the bytes: even steps from the smallest to the largest value of each texture and channel
        U8 => U8,
    }
}

choices! {
    pub(crate) enum ZerosArg for Zeros {
        /// Fitted as any other value
        Exact => Exact,
        /// The logarithm may be anything below: values end at 0
        Below => Below,
    }
}

choices! {
    pub(crate) enum AnglesArg for IsotropicPairs {
        /// (θh, θd), (θh, φd), (θi, θo)
        Polar => Polar,
        /// (θh, θd), (θh, θd cos φd), (θh, θd sin φd), (θi, θo)
        Cartesian => Cartesian,
        /// (θh, θd), (θh, φd mod π), (θd cos φd, θd sin φd), (θi, θo): tells mirrored pairs apart
        Oriented => Oriented,
    }
}

choices! {
    pub(crate) enum ReciprocityArg for Reciprocity {
        On => On,
        Off => Off,
        /// For --method search and isotropic: try both; the lower error on validation pairs wins, of a search for each number
        /// of textures
        Auto => Auto,
    }
}

impl SpaceArg {
    /// The spaces to search; none for those that have no projections.
    pub(crate) fn spaces(self) -> &'static [Space] {
        match self {
            Self::Standard => &[Space::Standard],
            Self::HalfDifference => &[Space::HalfDifference],
            Self::Auto => &[Space::Standard, Space::HalfDifference],
            Self::KautzMccool | Self::Orthographic | Self::Hybrid | Self::OnionSlice => &[],
        }
    }

    /// The parametrization that sums of products split, if it is one.
    pub(crate) fn parametrization(self) -> Option<Parametrization> {
        match self {
            Self::Standard => Some(Parametrization::Standard),
            Self::HalfDifference => Some(Parametrization::HalfDifference),
            Self::KautzMccool => Some(Parametrization::KautzMcCool),
            Self::Orthographic => Some(Parametrization::Orthographic),
            Self::Hybrid => Some(Parametrization::Hybrid),
            Self::OnionSlice => Some(Parametrization::OnionSlice),
            Self::Auto => None,
        }
    }
}

impl MethodArg {
    /// As it stands on the command line.
    pub(crate) fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }

    /// The model is a sum of products.
    pub(crate) fn is_separable(self) -> bool {
        matches!(self, Self::Svd | Self::LogSvd | Self::Eigen | Self::Nmf | Self::Normalized)
    }

    /// The model is a stream or a handful of numbers.
    pub(crate) fn is_compact(self) -> bool {
        matches!(self, Self::Spline | Self::Ggx)
    }
}

impl LogMapArg {
    /// The map of homomorphic fits, if it is one of theirs.
    pub(crate) fn homomorphic(self) -> Option<LogTransform> {
        match self {
            Self::Offset => Some(LogTransform::Offset),
            Self::Log => Some(LogTransform::Log),
            Self::Highlight => Some(LogTransform::Highlight),
            Self::Cosine => None,
        }
    }
}
