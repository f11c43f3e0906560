//! Coordinates: the place at which a factor reads its texture for a pair of directions.

use std::cell::OnceCell;

use brdf_param::{
    Bound, DirectionPair, DiscRadii, HemisphereMap, KautzMcCool, Projection, ScaledProjection,
    Space,
};
use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::Grid;
use crate::isotropic::{Angles, Axis, joined_texels};

/// A map from direction pairs to texture coordinates, before they are scaled.
///
/// ```
/// use brdf_factor::Coordinate;
///
/// assert_eq!(Coordinate::H.dimensions(), 2);
/// assert_eq!(Coordinate::RadialWi.dimensions(), 1);
/// assert_eq!(Coordinate::Wi.reciprocal_conjugate(), Coordinate::Wo);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Coordinate {
    /// Parabolic coordinates of the direction to the light.
    Wi,
    /// Parabolic coordinates of the direction to the viewer.
    Wo,
    /// Parabolic coordinates of the half vector.
    H,
    /// Parabolic coordinates of the difference vector in the frame of the tangent.
    D,
    /// |wi⊥|, the length of the tangent-plane part of the direction to the light, [0, 1];
    /// one-dimensional.
    RadialWi,
    /// |wo⊥|, the length of the tangent-plane part of the direction to the viewer, [0, 1];
    /// one-dimensional.
    RadialWo,
    /// |h⊥|, the length of the tangent-plane part of the unit half vector, [0, 1]; one-dimensional.
    RadialH,
    /// A linear projection of the parabolic coordinates of a space.
    Projected {
        /// The space that is projected.
        space: Space,
        /// The plane that it is projected onto.
        projection: Projection,
    },
    /// Two angles that a turn about the normal does not change.
    Isotropic {
        /// Across the columns, and across the rows of the texture.
        axes: [Axis; 2],
        /// Whether they are those of the swapped pair.
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        swapped: bool,
    },
}

/// What a two-dimensional coordinate amounts to: a projection in a space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Plane {
    pub(crate) space: Space,
    pub(crate) projection: Projection,
    /// Fixed coordinates fill a disc; projections an image of four dimensions.
    pub(crate) fixed: Option<HalfOfSpace>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum HalfOfSpace {
    First,
    Second,
}

/// The radial coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Radial {
    Wi,
    Wo,
    H,
}

/// Either kind of coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Reading {
    Planar(Plane),
    Radial(Radial),
    Isotropic { axes: [Axis; 2], swapped: bool },
}

impl Coordinate {
    /// Returns the number of dimensions: 1 for radial coordinates, else 2.
    pub fn dimensions(&self) -> usize {
        match self {
            Self::RadialWi | Self::RadialWo | Self::RadialH => 1,
            _ => 2,
        }
    }

    /// Returns the coordinate that gives, for a pair, what this one gives for the swapped pair.
    pub fn reciprocal_conjugate(&self) -> Self {
        let space = Space::HalfDifference;
        let minus_d =
            Self::Projected { space, projection: Projection::SECOND.reciprocal_conjugate(space) };
        match *self {
            Self::Wi => Self::Wo,
            Self::Wo => Self::Wi,
            Self::RadialWi => Self::RadialWo,
            Self::RadialWo => Self::RadialWi,
            Self::H => Self::H,
            Self::RadialH => Self::RadialH,
            Self::D => minus_d,
            // So that the conjugate of a conjugate is the coordinate itself.
            _ if *self == minus_d => Self::D,
            Self::Projected { space, projection } => {
                Self::Projected { space, projection: projection.reciprocal_conjugate(space) }
            }
            Self::Isotropic { axes, swapped } => {
                let is_own = axes.iter().all(|axis| axis.angle.is_reciprocal());
                Self::Isotropic { axes, swapped: swapped == is_own }
            }
        }
    }

    /// The projection that is d as the coordinate that has a name; others as they are.
    fn as_named(&self) -> Self {
        let space = Space::HalfDifference;
        let d = Self::Projected { space, projection: Projection::SECOND };
        if *self == d { Self::D } else { *self }
    }

    pub(crate) fn reading(&self) -> Reading {
        let fixed = |space, projection, half| {
            Reading::Planar(Plane { space, projection, fixed: Some(half) })
        };
        match *self {
            Self::Wi => fixed(Space::Standard, Projection::FIRST, HalfOfSpace::First),
            Self::Wo => fixed(Space::Standard, Projection::SECOND, HalfOfSpace::Second),
            Self::H => fixed(Space::HalfDifference, Projection::FIRST, HalfOfSpace::First),
            Self::D => fixed(Space::HalfDifference, Projection::SECOND, HalfOfSpace::Second),
            Self::RadialWi => Reading::Radial(Radial::Wi),
            Self::RadialWo => Reading::Radial(Radial::Wo),
            Self::RadialH => Reading::Radial(Radial::H),
            Self::Projected { space, projection } => {
                Reading::Planar(Plane { space, projection, fixed: None })
            }
            Self::Isotropic { axes, swapped } => Reading::Isotropic { axes, swapped },
        }
    }

    /// The largest radius that pairs give a radial coordinate.
    pub(crate) fn largest_radii(&self, pairs: impl Iterator<Item = DirectionPair>) -> DiscRadii {
        match self.reading() {
            Reading::Planar(_) => DiscRadii::UNIT,
            Reading::Radial(radial) => {
                let radius = pairs.map(|pair| radial.value(&pair)).fold(0.0, f64::max);
                DiscRadii { first: radius, second: radius }
            }
            Reading::Isotropic { .. } => DiscRadii::UNIT,
        }
    }

    /// The largest angles that pairs, or the same swapped, give an isotropic coordinate; so it shares a scale with its
    /// conjugate.
    pub(crate) fn largest_angles(axes: &[Axis; 2], angles: &[Angles]) -> DiscRadii {
        let none = DiscRadii { first: 0.0, second: 0.0 };
        angles.iter().flat_map(|&at| [at, at.swapped()]).fold(none, |largest, at| {
            let [first, second] = axes.map(|axis| at.get(axis.angle).abs());
            largest.max(DiscRadii { first, second })
        })
    }

    /// Half the extent of the coordinate's image, by which it is divided; largest angles of an isotropic one.
    pub(crate) fn extent(&self, bound: Bound, radii: DiscRadii) -> DVec2 {
        match self.reading() {
            Reading::Planar(Plane { fixed: None, projection, .. }) => {
                projection.extent(bound, radii)
            }
            Reading::Isotropic { axes: [x, y], .. } => DVec2::new(
                x.angle.range().unwrap_or(radii.first),
                y.angle.range().unwrap_or(radii.second),
            ),
            // One disc: its radius, or 1 for the loose bound.
            _ => DVec2::splat(match bound {
                Bound::Disc => radii.first,
                Bound::Cube => 1.0,
            }),
        }
    }

    /// The outline of the scaled image of a planar coordinate; empty for others, which use all texels.
    pub(crate) fn image(&self, bound: Bound, radii: DiscRadii, extent: DVec2) -> Vec<DVec2> {
        match self.reading() {
            Reading::Radial(_) | Reading::Isotropic { .. } => Vec::new(),
            Reading::Planar(Plane { fixed: None, projection, .. }) => {
                projection.scaled_by(extent).image_polygon(bound, radii)
            }
            Reading::Planar(Plane { projection, .. }) => {
                let radius = match bound {
                    Bound::Disc => radii.first,
                    Bound::Cube => 1.0,
                };
                let disc = DiscRadii { first: radius, second: radius };
                projection.scaled_by(extent).image_polygon(Bound::Disc, disc)
            }
        }
    }

    /// Texture coordinates of a pair: ([0, 1], 0) for radial coordinates, else [−1, 1]².
    pub(crate) fn locate(&self, place: &PairPlace<'_>, extent: DVec2) -> DVec2 {
        let pair = place.pair;
        match self.reading() {
            Reading::Radial(radial) => DVec2::new(radial.value(pair) / extent.x, 0.0),
            Reading::Planar(Plane { fixed: None, space, projection }) => {
                let scaled: ScaledProjection = projection.scaled_by(extent);
                scaled.apply(space.coordinates(pair))
            }
            Reading::Planar(plane @ Plane { fixed: Some(half), .. }) => {
                plane.half_point(half, pair) / extent
            }
            Reading::Isotropic { axes, swapped } => {
                locate_angles(&axes, swapped, place.angles(), extent)
            }
        }
    }

    /// The texels of a grid that stand for one place, group by group.
    pub(crate) fn joined_texels(&self, grid: Grid) -> Vec<Vec<usize>> {
        match self {
            Self::Isotropic { axes, .. } => joined_texels(axes, grid),
            _ => Vec::new(),
        }
    }
}

/// A pair whose angles are found once, by the first coordinate that needs them.
pub(crate) struct PairPlace<'a> {
    pub(crate) pair: &'a DirectionPair,
    angles: OnceCell<Angles>,
}

impl<'a> PairPlace<'a> {
    pub(crate) fn new(pair: &'a DirectionPair) -> Self {
        Self { pair, angles: OnceCell::new() }
    }

    fn angles(&self) -> Angles {
        *self.angles.get_or_init(|| Angles::from_pair(self.pair))
    }
}

/// Texture coordinates of an isotropic coordinate, [−1, 1]².
pub(crate) fn locate_angles(
    [x, y]: &[Axis; 2],
    swapped: bool,
    angles: Angles,
    extent: DVec2,
) -> DVec2 {
    let angles = if swapped { angles.swapped() } else { angles };
    DVec2::new(x.locate(&angles, extent.x), y.locate(&angles, extent.y))
}

impl Plane {
    /// The radii that matter to this plane, of those of its space.
    pub(crate) fn radii(&self, space: DiscRadii) -> DiscRadii {
        let both = |radius| DiscRadii { first: radius, second: radius };
        match self.fixed {
            None => space,
            Some(HalfOfSpace::First) => both(space.first),
            Some(HalfOfSpace::Second) => both(space.second),
        }
    }

    /// One half of the coordinates in this plane's space, without computing the other.
    fn half_point(&self, half: HalfOfSpace, pair: &DirectionPair) -> DVec2 {
        match (self.space, half) {
            (Space::Standard, HalfOfSpace::First) => HemisphereMap::Parabolic.encode(pair.wi),
            (Space::Standard, HalfOfSpace::Second) => HemisphereMap::Parabolic.encode(pair.wo),
            (Space::HalfDifference, HalfOfSpace::First) => {
                HemisphereMap::Parabolic.encode(pair.half())
            }
            (Space::HalfDifference, HalfOfSpace::Second) => KautzMcCool::from_pair(pair).d,
        }
    }
}

impl Radial {
    fn value(self, pair: &DirectionPair) -> f64 {
        match self {
            Self::Wi => pair.wi.truncate().length(),
            Self::Wo => pair.wo.truncate().length(),
            Self::H => pair.half().truncate().length(),
        }
    }
}

/// A factor to be fitted, given by the coordinates that share its texture.
///
/// The logarithm of a factor is the sum of its texture's values at all its coordinates.
///
/// ```
/// use brdf_factor::{Coordinate, FactorSpec};
///
/// // One texture is read at wi and at wo, another at the half vector.
/// let specs = FactorSpec::mccool(true);
/// assert_eq!(specs.len(), 2);
/// assert!(specs.contains(&FactorSpec::reciprocal(Coordinate::Wi)));
/// assert!(specs.iter().all(FactorSpec::is_reciprocal));
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FactorSpec {
    /// The coordinates: at least one, all of the same number of dimensions.
    pub coordinates: Vec<Coordinate>,
    /// The grid of its texture; none for one of the size that the options of the fit say, as many texels along
    /// both sides.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub grid: Option<Grid>,
}

impl FactorSpec {
    /// Returns a factor with one coordinate.
    pub fn single(coordinate: Coordinate) -> Self {
        Self::sharing(vec![coordinate])
    }

    /// Returns a factor whose coordinate shares its texture with its reciprocal conjugate.
    ///
    /// Such a factor does not change when light and viewer are exchanged. A coordinate that is its own
    /// conjugate stays alone.
    pub fn reciprocal(coordinate: Coordinate) -> Self {
        let conjugate = coordinate.reciprocal_conjugate();
        if conjugate == coordinate {
            Self::single(coordinate)
        } else {
            Self::sharing(vec![coordinate, conjugate])
        }
    }

    fn sharing(coordinates: Vec<Coordinate>) -> Self {
        Self { coordinates, grid: None }
    }

    /// Returns the factor with this grid.
    #[must_use]
    pub fn with_grid(self, grid: Grid) -> Self {
        Self { grid: Some(grid), ..self }
    }

    /// Returns the factor's grid, which has `size` texels along a side where the factor does not say.
    pub fn grid(&self, size: usize) -> Grid {
        self.grid.unwrap_or_else(|| match self.coordinates.first().map(Coordinate::dimensions) {
            Some(1) => Grid::line(size),
            _ => Grid::square(size),
        })
    }

    /// Returns whether the factor stays the same when light and viewer are exchanged: the coordinates
    /// include the conjugate of each.
    pub fn is_reciprocal(&self) -> bool {
        let has = |wanted: Coordinate| {
            self.coordinates.iter().any(|coordinate| coordinate.as_named() == wanted.as_named())
        };
        self.coordinates.iter().all(|coordinate| has(coordinate.reciprocal_conjugate()))
    }

    fn new(coordinate: Coordinate, reciprocal: bool) -> Self {
        if reciprocal { Self::reciprocal(coordinate) } else { Self::single(coordinate) }
    }

    /// Returns the factors of McCool's p(wi) · q(h) · p(wo): two textures if `reciprocal`, else three.
    ///
    /// Source: McCool, Ang and Ahmad 2001.
    pub fn mccool(reciprocal: bool) -> Vec<Self> {
        Self::around_half([Coordinate::Wi, Coordinate::H, Coordinate::Wo], reciprocal)
    }

    /// Returns the radial factors p(|wi⊥|) · q(|h⊥|) · p(|wo⊥|) of an isotropic material: two textures if
    /// `reciprocal`, else three.
    ///
    /// Source: Jaroszkiewicz and McCool 2003.
    pub fn radial(reciprocal: bool) -> Vec<Self> {
        let coordinates = [Coordinate::RadialWi, Coordinate::RadialH, Coordinate::RadialWo];
        Self::around_half(coordinates, reciprocal)
    }

    fn around_half([light, half, viewer]: [Coordinate; 3], reciprocal: bool) -> Vec<Self> {
        if reciprocal {
            vec![Self::sharing(vec![light, viewer]), Self::single(half)]
        } else {
            vec![Self::single(light), Self::single(half), Self::single(viewer)]
        }
    }

    /// Returns one factor for each projection of a space, made reciprocal if asked for.
    pub fn projections(space: Space, projections: &[Projection], reciprocal: bool) -> Vec<Self> {
        projections
            .iter()
            .map(|&projection| Self::new(Coordinate::Projected { space, projection }, reciprocal))
            .collect()
    }
}
