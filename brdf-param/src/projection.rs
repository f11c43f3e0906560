//! Linear projections from four dimensions to two.
//!
//! Source: Cole 2002, chapter 2; scale, domain and reciprocal conjugate as in section 3.2.

use std::f64::consts::TAU;

use glam::{DVec2, DVec4};
#[cfg(feature = "serde")]
use serde::{Deserialize, Serialize};

use crate::{DirectionPair, HemisphereMap, KautzMcCool, ParamError, convex_hull};

/// The four-dimensional space that a projection acts on: parabolic coordinates of two directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Space {
    /// Parabolic coordinates of `wi` and `wo`.
    Standard,
    /// Parabolic coordinates of half and difference vector in the frame of the tangent
    /// ([`KautzMcCool`]).
    HalfDifference,
}

/// Parabolic coordinates of two directions, each in the unit disc: the points of a [`Space`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParabolicPair {
    /// Of `wi`, or of the half vector.
    pub first: DVec2,
    /// Of `wo`, or of the difference vector.
    pub second: DVec2,
}

impl Space {
    /// Returns the name used in files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Standard => "standard",
            Self::HalfDifference => "half-difference",
        }
    }

    /// Returns the coordinates of a pair in this space.
    ///
    /// ```
    /// use brdf_param::{DirectionPair, Space};
    ///
    /// let pair = DirectionPair::from_angles(0.4, 0.0, 1.0, 2.0);
    /// let point = Space::Standard.coordinates(&pair);
    /// assert!((point.first.length() - 0.2_f64.tan()).abs() < 1e-15);
    /// assert!((point.second.length() - 0.5_f64.tan()).abs() < 1e-15);
    /// ```
    pub fn coordinates(self, pair: &DirectionPair) -> ParabolicPair {
        match self {
            Self::Standard => ParabolicPair {
                first: HemisphereMap::Parabolic.encode(pair.wi),
                second: HemisphereMap::Parabolic.encode(pair.wo),
            },
            Self::HalfDifference => {
                let KautzMcCool { h, d } = KautzMcCool::from_pair(pair);
                ParabolicPair { first: h, second: d }
            }
        }
    }
}

/// The largest radius of each coordinate pair, in parabolic units: tan(theta/2).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DiscRadii {
    /// Of the first pair, (0, 1].
    pub first: f64,
    /// Of the second pair, (0, 1].
    pub second: f64,
}

impl DiscRadii {
    /// The radii of two whole hemispheres: 1 and 1.
    pub const UNIT: Self = Self { first: 1.0, second: 1.0 };

    /// Returns the larger of both radii, for each coordinate pair.
    pub fn max(self, other: Self) -> Self {
        Self { first: self.first.max(other.first), second: self.second.max(other.second) }
    }
}

/// The set of points that a projection is scaled for, so that their image fills [−1, 1]².
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Bound {
    /// The product of two discs of radii r₁ and r₂, which is exact. A row (a, b, c, d) reaches
    /// r₁√(a² + b²) + r₂√(c² + d²).
    Disc,
    /// The cube [−1, 1]⁴, as in Cole 2002. A row reaches ‖row‖₁. It is larger than the domain, so
    /// some texels are never used.
    Cube,
}

/// A linear projection from four dimensions to two: two orthonormal rows of four numbers.
///
/// In files it is a list of two lists.
///
/// ```
/// use brdf_param::{Bound, DirectionPair, DiscRadii, Projection, Space};
///
/// // A plane halfway between the light and the viewer.
/// let projection = Projection::from_rows([1.0, 0.0, 1.0, 0.0], [0.0, 1.0, 0.0, 1.0])?;
/// let scaled = projection.scaled(Bound::Disc, DiscRadii::UNIT);
/// let pair = DirectionPair::from_angles(0.5, 0.0, 0.5, 0.0);
/// let point = scaled.apply(Space::Standard.coordinates(&pair));
/// assert!((point.x - 0.25_f64.tan()).abs() < 1e-12 && point.y.abs() < 1e-12);
/// # Ok::<(), brdf_param::ParamError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(try_from = "[[f64; 4]; 2]", into = "[[f64; 4]; 2]"))]
pub struct Projection {
    rows: [DVec4; 2],
}

impl Projection {
    /// The projection onto the first direction: `wi`, or the half vector in half/difference space.
    pub const FIRST: Self = Self { rows: [DVec4::X, DVec4::Y] };
    /// The projection onto the second direction: `wo`, or the difference vector in half/difference
    /// space.
    pub const SECOND: Self = Self { rows: [DVec4::Z, DVec4::W] };

    /// Returns the projection onto the plane of two independent rows.
    ///
    /// The rows are made orthonormal in order (Gram–Schmidt), which moves texels but does not change
    /// what the texture can express. Rows that are orthonormal to rounding are kept as they are, so
    /// that stored projections return unchanged.
    ///
    /// # Errors
    ///
    /// [`ParamError::NotFinite`] where a number is NaN or infinite, and [`ParamError::DependentRows`]
    /// where the angle between the rows is below 1e-6 or a row is zero.
    pub fn from_rows(first: [f64; 4], second: [f64; 4]) -> Result<Self, ParamError> {
        for (row, values) in [first, second].iter().enumerate() {
            if let Some(&value) = values.iter().find(|v| !v.is_finite()) {
                return Err(ParamError::NotFinite { row, value });
            }
        }
        let rows = [DVec4::from_array(first), DVec4::from_array(second)];
        if are_orthonormal(rows) {
            return Ok(Self { rows });
        }
        let dependent = ParamError::DependentRows { first, second };
        let a = unit_row(first).ok_or(dependent.clone())?;
        let b = unit_row(second).ok_or(dependent.clone())?;
        let across = b - b.dot(a) * a;
        if across.length() < 1e-6 {
            return Err(dependent);
        }
        // Once more: one pass leaves an error of 1e-10 where the rows were nearly parallel.
        let across = across.normalize();
        Ok(Self { rows: [a, (across - across.dot(a) * a).normalize()] })
    }

    /// Returns the two orthonormal rows.
    pub fn rows(&self) -> [DVec4; 2] {
        self.rows
    }

    /// Returns the projection that gives, for a pair, what this one gives for the swapped pair.
    ///
    /// Column pairs are exchanged in standard space, the second pair negated in half/difference space.
    pub fn reciprocal_conjugate(&self, space: Space) -> Self {
        let conjugate = |row: DVec4| match space {
            Space::Standard => DVec4::new(row.z, row.w, row.x, row.y),
            Space::HalfDifference => DVec4::new(row.x, row.y, -row.z, -row.w),
        };
        Self { rows: self.rows.map(conjugate) }
    }

    /// Returns half the extent of the image of the domain along each row.
    ///
    /// [`Bound::Cube`] takes the whole cube and does not look at `radii`.
    pub fn extent(&self, bound: Bound, radii: DiscRadii) -> DVec2 {
        let row_extent = |row: DVec4| match bound {
            Bound::Disc => radii.first * row.x.hypot(row.y) + radii.second * row.z.hypot(row.w),
            Bound::Cube => row.abs().element_sum(),
        };
        DVec2::new(row_extent(self.rows[0]), row_extent(self.rows[1]))
    }

    /// Returns the projection scaled so that its image touches all four sides of [−1, 1]².
    pub fn scaled(&self, bound: Bound, radii: DiscRadii) -> ScaledProjection {
        self.scaled_by(self.extent(bound, radii))
    }

    /// Returns the projection with each row divided by the extent along it.
    pub fn scaled_by(&self, extent: DVec2) -> ScaledProjection {
        ScaledProjection { rows: [self.rows[0] / extent.x, self.rows[1] / extent.y] }
    }
}

/// A projection whose image fits the square [−1, 1]²; its rows are no longer of unit length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScaledProjection {
    rows: [DVec4; 2],
}

/// Corners of the polygon that stands for a disc: with 256 its rim is missed by 8e-5 of the radius, and that of
/// an image that is a sliver by 3.7e-3 of its half length, less than a texel of textures below 500².
const RIM_POINTS: u32 = 256;

impl ScaledProjection {
    /// Returns the two rows.
    pub fn rows(&self) -> [DVec4; 2] {
        self.rows
    }

    /// Returns the texture coordinates of a point; inside the domain they lie in [−1, 1]².
    pub fn apply(&self, point: ParabolicPair) -> DVec2 {
        let p = DVec4::new(point.first.x, point.first.y, point.second.x, point.second.y);
        DVec2::new(self.rows[0].dot(p), self.rows[1].dot(p))
    }

    /// Returns the corners of the image of the domain, a convex polygon, counter-clockwise.
    pub fn image_polygon(&self, bound: Bound, radii: DiscRadii) -> Vec<DVec2> {
        match bound {
            Bound::Cube => self.cube_image(),
            Bound::Disc => self.disc_image(radii),
        }
    }

    fn cube_image(&self) -> Vec<DVec2> {
        let corners: Vec<DVec2> = (0..16_u32)
            .map(|corner| {
                let side = |bit: u32| if corner >> bit & 1 == 1 { 1.0 } else { -1.0 };
                self.apply(ParabolicPair {
                    first: DVec2::new(side(0), side(1)),
                    second: DVec2::new(side(2), side(3)),
                })
            })
            .collect();
        convex_hull(&corners)
    }

    /// For every outward normal n, the image of the disc product reaches furthest at r₁ times the
    /// unit vector along the first half of Pᵀn and r₂ times that along the second.
    fn disc_image(&self, radii: DiscRadii) -> Vec<DVec2> {
        let support = |step: u32| {
            let n = DVec2::from_angle(TAU * f64::from(step) / f64::from(RIM_POINTS));
            let back = n.x * self.rows[0] + n.y * self.rows[1];
            self.apply(ParabolicPair {
                first: radii.first * DVec2::new(back.x, back.y).normalize_or_zero(),
                second: radii.second * DVec2::new(back.z, back.w).normalize_or_zero(),
            })
        };
        convex_hull(&(0..RIM_POINTS).map(support).collect::<Vec<_>>())
    }
}

fn are_orthonormal([a, b]: [DVec4; 2]) -> bool {
    let off = [a.length_squared() - 1.0, b.length_squared() - 1.0, a.dot(b)];
    off.iter().all(|v| v.abs() <= 1e-14)
}

impl TryFrom<[[f64; 4]; 2]> for Projection {
    type Error = ParamError;

    fn try_from([first, second]: [[f64; 4]; 2]) -> Result<Self, ParamError> {
        Self::from_rows(first, second)
    }
}

impl From<Projection> for [[f64; 4]; 2] {
    fn from(projection: Projection) -> Self {
        projection.rows.map(|row| row.to_array())
    }
}

fn unit_row(values: [f64; 4]) -> Option<DVec4> {
    // Scaled first, so that rows of 1e200 neither overflow nor vanish.
    let largest = values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    (largest > 0.0).then(|| (DVec4::from_array(values) / largest).normalize())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dependent_rows_are_refused_by_name() {
        let row = [1.0, 2.0, 3.0, 4.0];
        let error = Projection::from_rows(row, row.map(|v| -2.0 * v)).unwrap_err();
        assert!(matches!(error, ParamError::DependentRows { .. }), "{error}");
        let error = Projection::from_rows([0.0; 4], row).unwrap_err();
        assert!(matches!(error, ParamError::DependentRows { .. }), "{error}");
    }

    #[test]
    fn nearly_parallel_rows_still_give_orthonormal_ones() {
        let p = Projection::from_rows([1.0, 0.0, 0.0, 0.0], [1.0, 1e-5, 0.0, 0.0]).unwrap();
        let [a, b] = p.rows();
        assert!(a.dot(b).abs() < 1e-15 && (b.length() - 1.0).abs() < 1e-15, "{a} {b}");
    }

    #[test]
    fn the_first_projection_of_unit_discs_needs_no_scale() {
        let extent = Projection::FIRST.extent(Bound::Disc, DiscRadii::UNIT);
        assert_eq!(extent, DVec2::ONE);
        assert_eq!(Projection::FIRST.extent(Bound::Cube, DiscRadii::UNIT), DVec2::ONE);
    }
}
