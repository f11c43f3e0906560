//! The kinds of containers.

use serde::{Deserialize, Serialize};

/// What a container holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// A product of textures.
    Factored,
    /// A sum of products.
    Separable,
    /// A sum of products of splines.
    Spline,
    /// GGX lobes.
    Ggx,
    /// Transport of an object.
    Transport,
    /// A table on the MERL grid.
    MerlTable,
    /// Scattered samples.
    Samples,
    /// A BTF in nested codebooks.
    BtfVq,
    /// A BTF in local principal components.
    BtfLpca,
    /// A painted material.
    Painted,
    /// A preinverted matrix.
    Basis,
}

impl Kind {
    /// Returns what it is called in messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Factored => "a product of textures",
            Self::Separable => "a sum of products",
            Self::Spline => "a sum of products of splines",
            Self::Ggx => "GGX lobes on a diffuse base",
            Self::Transport => "the transport of an object",
            Self::MerlTable => "a table on the MERL grid",
            Self::Samples => "scattered samples",
            Self::BtfVq | Self::BtfLpca => "a compressed BTF",
            Self::Painted => "a painted material, which varies over a surface",
            Self::Basis => "a preinverted matrix",
        }
    }
}
