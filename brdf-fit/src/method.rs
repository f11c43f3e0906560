//! Names of methods and choices, as records have them.

use brdf_param::HemisphereMap;
use serde::{Deserialize, Serialize};

/// How a model was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// One texture for each of the best projections, which were searched for.
    Search,
    /// p(wi) q(h) p(wo).
    #[serde(rename = "mccool")]
    McCool,
    /// p(|wi⊥|) q(|h⊥|) p(|wo⊥|).
    Radial,
    /// One texture for each of given projections.
    Projections,
    /// One texture for each of some pairs of angles, isotropic.
    Isotropic,
    /// Textures over given coordinates.
    Coordinates,
    /// With a matrix that was inverted before.
    Preinverted,
    /// Sum of products of splines, isotropic.
    Spline,
    /// GGX lobes on a diffuse base, isotropic.
    Ggx,
    /// Sum of products: truncated singular value decomposition.
    Svd,
    /// The same of logarithms.
    LogSvd,
    /// Sum of products: eigenpairs.
    Eigen,
    /// Sum of products of non-negative textures.
    Nmf,
    /// One product, without iteration.
    Normalized,
}

impl Method {
    /// Returns the name, as records have it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Search => "search",
            Self::McCool => "mccool",
            Self::Radial => "radial",
            Self::Projections => "projections",
            Self::Isotropic => "isotropic",
            Self::Coordinates => "coordinates",
            Self::Preinverted => "preinverted",
            Self::Spline => "spline",
            Self::Ggx => "ggx",
            Self::Svd => "svd",
            Self::LogSvd => "log-svd",
            Self::Eigen => "eigen",
            Self::Nmf => "nmf",
            Self::Normalized => "normalized",
        }
    }

    /// Returns whether the model is a sum of products.
    pub fn is_separable(self) -> bool {
        matches!(self, Self::Svd | Self::LogSvd | Self::Eigen | Self::Nmf | Self::Normalized)
    }
}

impl std::fmt::Display for Method {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

/// How projections were searched.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum StrategyKind {
    /// All projections together, by gradients, from many starts.
    Joint,
    /// One projection after another by Powell's method, as in the thesis.
    Powell,
}

/// How the hemisphere is laid out in the textures of sums of products.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum SeparableMap {
    /// Seen from above: (x, y) in the unit disc.
    #[default]
    Orthographic,
    /// Azimuth and √(1 − cosθ).
    Polar,
    /// (x, y) / (1 + z) in the unit disc.
    Parabolic,
    /// Azimuth and polar angle.
    Spherical,
    /// MERL's own grid: theta_h × (theta_d, phi_d), isotropic, 90 × 16200.
    Merl,
}

impl SeparableMap {
    /// Returns the name, as records have it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Orthographic => "orthographic",
            Self::Polar => "polar",
            Self::Parabolic => "parabolic",
            Self::Spherical => "spherical",
            Self::Merl => "merl",
        }
    }

    /// Returns the map, unless it is a grid of its own.
    pub fn hemisphere(self) -> Option<HemisphereMap> {
        match self {
            Self::Orthographic => Some(HemisphereMap::OrthographicDisc),
            Self::Polar => Some(HemisphereMap::Polar),
            Self::Parabolic => Some(HemisphereMap::Parabolic),
            Self::Spherical => Some(HemisphereMap::Spherical),
            Self::Merl => None,
        }
    }
}
