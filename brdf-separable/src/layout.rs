//! Layouts: the two points of the hemisphere that make the rows and the columns of a matrix.

use brdf_param::{DirectionPair, Parametrization};
use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::{HemisphereGrid, SeparableError};

/// The two sides of a sum of products: grids over the two points into which a parametrization turns a
/// pair of directions.
///
/// Where the first grid holds polar angles alone, the material is taken to be isotropic: pairs are
/// turned so that the first point has azimuth 0, and the second grid holds the other two coordinates.
///
/// ```
/// use brdf_param::{DirectionPair, HemisphereMap, Parametrization};
/// use brdf_separable::{HemisphereGrid, Layout};
///
/// let radius = HemisphereGrid::Radius { map: HemisphereMap::Parabolic, resolution: 32 };
/// let plane = HemisphereGrid::Plane { map: HemisphereMap::Parabolic, resolution: 32 };
/// let layout = Layout::new(Parametrization::HalfDifference, radius, plane);
/// assert!(layout.check().is_ok() && layout.is_isotropic() && !layout.is_symmetric());
/// let [half, _] = layout.locate(&DirectionPair::from_angles(0.2, 1.0, 0.7, 2.0));
/// assert!(half.y.abs() < 1e-12, "the half vector has azimuth 0");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Layout {
    /// Parametrization that turns a pair into two points.
    pub parametrization: Parametrization,
    /// Grid of the first point (wi, or the half vector): the rows of the matrix.
    pub first: HemisphereGrid,
    /// Grid of the second point (wo, or the difference or back vector): the columns of the matrix.
    pub second: HemisphereGrid,
}

impl Layout {
    /// Returns the layout of two grids under a parametrization.
    pub fn new(
        parametrization: Parametrization,
        first: HemisphereGrid,
        second: HemisphereGrid,
    ) -> Self {
        Self { parametrization, first, second }
    }

    /// Checks that the parts fit together.
    ///
    /// # Errors
    ///
    /// [`SeparableError::Resolution`] as [`HemisphereGrid::check`] says; [`SeparableError::Layout`] if the
    /// second grid holds polar angles alone.
    pub fn check(&self) -> Result<(), SeparableError> {
        self.first.check()?;
        self.second.check()?;
        if self.second.is_radial() {
            return Err(SeparableError::Layout {
                found: "a second chart of polar angles alone",
                expected: "a two-dimensional second chart",
            });
        }
        Ok(())
    }

    /// Returns whether the first grid holds polar angles alone.
    pub fn is_isotropic(&self) -> bool {
        self.first.is_radial()
    }

    /// Returns whether both sides are the same, so that a reciprocal BRDF makes a symmetric matrix.
    pub fn is_symmetric(&self) -> bool {
        self.parametrization == Parametrization::Standard && self.first == self.second
    }

    /// Returns the two points of a pair.
    pub fn locate(&self, pair: &DirectionPair) -> [DVec3; 2] {
        if self.is_isotropic() {
            self.parametrization.isotropic_hemispheres(pair)
        } else {
            self.parametrization.hemispheres(pair)
        }
    }

    /// Returns the pair at two points, or `None` where one of its directions would lie below the horizon.
    pub fn pair(&self, points: [DVec3; 2]) -> Option<DirectionPair> {
        if self.is_isotropic() {
            self.parametrization.from_isotropic_hemispheres(points)
        } else {
            self.parametrization.from_hemispheres(points)
        }
    }
}
