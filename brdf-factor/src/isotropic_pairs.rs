//! Lists of factors for isotropic materials.

use serde::{Deserialize, Serialize};

use crate::{Angle, Axis, Coordinate, FactorSpec, Grid, Spacing};

/// A choice of pairs of angles, each of which gets a texture.
///
/// Every choice has (θh, θd) and (θi, θo). What φd changes goes into one or two textures more.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum IsotropicPairs {
    /// (θh, φd): three textures. Mirrored pairs are the same.
    Polar,
    /// (θh, θd cos φd) and (θh, θd sin φd): four textures. Mirrored pairs are the same.
    Cartesian,
    /// (θh, φd mod π) and (θd cos φd, θd sin φd): four textures that tell mirrored pairs apart.
    Oriented,
}

/// Columns and rows of each texture, of which proportions alone matter.
type Sizes<const N: usize> = [[usize; 2]; N];

const POLAR: Sizes<3> = [[40, 28], [40, 24], [28, 28]];
const CARTESIAN: Sizes<4> = [[36, 20], [40, 18], [40, 18], [26, 26]];
const ORIENTED: Sizes<4> = [[36, 24], [36, 20], [24, 24], [26, 26]];

impl IsotropicPairs {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Polar, Self::Cartesian, Self::Oriented];

    /// Returns the name, as records have it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Polar => "polar",
            Self::Cartesian => "cartesian",
            Self::Oriented => "oriented",
        }
    }

    /// Returns the number of textures.
    pub fn textures(self) -> usize {
        match self {
            Self::Polar => POLAR.len(),
            Self::Cartesian => CARTESIAN.len(),
            Self::Oriented => ORIENTED.len(),
        }
    }

    /// Returns the factors, with at most `texels` texels in all and this spacing along θh. If `reciprocal`, exchanging
    /// light and viewer changes nothing.
    ///
    /// Too few texels give textures of two texels a side.
    ///
    /// ```
    /// use brdf_factor::{FactorSpec, IsotropicPairs, Spacing};
    ///
    /// let specs = IsotropicPairs::Polar.specs(Spacing::Linear, 2_880, true);
    /// let texels: usize = specs.iter().map(|spec| spec.grid(1).texels()).sum();
    /// assert!(specs.len() == 3 && (2_700..=2_880).contains(&texels));
    /// assert!(specs.iter().all(FactorSpec::is_reciprocal));
    /// ```
    pub fn specs(self, spacing: Spacing, texels: usize, reciprocal: bool) -> Vec<FactorSpec> {
        let half = |other| [Axis { angle: Angle::ThetaH, spacing }, Axis::linear(other)];
        let both = |x, y| [Axis::linear(x), Axis::linear(y)];
        let polar = both(Angle::ThetaI, Angle::ThetaO);
        let only = |folded, plain| if reciprocal { folded } else { plain };
        let with_sizes = |axes: &[[Axis; 2]], sizes: &[[usize; 2]]| {
            let coordinates =
                axes.iter().map(|&axes| Coordinate::Isotropic { axes, swapped: false });
            let specs = coordinates.map(|coordinate| {
                if reciprocal {
                    FactorSpec::reciprocal(coordinate)
                } else {
                    FactorSpec::single(coordinate)
                }
            });
            specs.zip(scaled(sizes, texels)).map(|(spec, grid)| spec.with_grid(grid)).collect()
        };
        match self {
            Self::Polar => {
                let azimuth = only(Angle::PhiDFolded, Angle::PhiD);
                with_sizes(&[half(Angle::ThetaD), half(azimuth), polar], &POLAR)
            }
            Self::Cartesian => {
                let [x, y] =
                    [only(Angle::DifferenceXFolded, Angle::DifferenceX), Angle::DifferenceYFolded];
                with_sizes(&[half(Angle::ThetaD), half(x), half(y), polar], &CARTESIAN)
            }
            Self::Oriented => {
                let azimuth = half(Angle::PhiDModPi);
                let difference = both(Angle::DifferenceX, Angle::DifferenceY);
                with_sizes(&[half(Angle::ThetaD), azimuth, polar, difference], &ORIENTED)
            }
        }
    }
}

/// The largest grids of these proportions with at most so many texels in all.
fn scaled(sizes: &[[usize; 2]], texels: usize) -> impl Iterator<Item = Grid> {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a positive number of texels"
    )]
    let side = |side: usize, scale: f64| {
        let scaled = (scale * side as f64).round() as usize;
        scaled.clamp(*Grid::SIZES.start(), *Grid::SIZES.end())
    };
    let grid = move |[columns, rows]: [usize; 2], scale: f64| Grid {
        columns: side(columns, scale),
        rows: side(rows, scale),
    };
    let all = |scale: f64| sizes.iter().map(|&size| grid(size, scale).texels()).sum::<usize>();
    // Sizes grow with the scale, so that halving finds the largest that is not too large.
    let (mut low, mut high) = (0.0, *Grid::SIZES.end() as f64);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if all(middle) <= texels { low = middle } else { high = middle }
    }
    sizes.iter().map(move |&size| grid(size, low))
}
