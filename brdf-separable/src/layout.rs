//! Which point of the hemisphere stands on which side of a matrix.

use brdf_param::{DirectionPair, Parametrization};
use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::{HemisphereGrid, SeparableError};

/// The two sides of a sum of products: charts over the two points that a parametrization makes of a
/// pair.
///
/// Where the first chart holds polar angles alone, the material is taken to be isotropic: pairs are
/// turned so that the first point has azimuth 0, and the second chart holds the other two
/// coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Layout {
    /// What makes two points of a pair.
    pub parametrization: Parametrization,
    /// Of the first point (wi, or the half vector): rows of the matrix.
    pub first: HemisphereGrid,
    /// Of the second point (wo, or the difference or back vector): columns.
    pub second: HemisphereGrid,
}

impl Layout {
    /// A layout.
    pub fn new(
        parametrization: Parametrization,
        first: HemisphereGrid,
        second: HemisphereGrid,
    ) -> Self {
        Self { parametrization, first, second }
    }

    /// Whether the parts fit together.
    ///
    /// # Errors
    ///
    /// [`SeparableError::Resolution`]; [`SeparableError::Layout`] if the second chart holds polar
    /// angles alone.
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

    /// The first chart holds polar angles alone.
    pub fn is_isotropic(&self) -> bool {
        self.first.is_radial()
    }

    /// Both sides are the same, so that a reciprocal BRDF makes a symmetric matrix.
    pub fn is_symmetric(&self) -> bool {
        self.parametrization == Parametrization::Standard && self.first == self.second
    }

    /// The two points of a pair.
    pub fn locate(&self, pair: &DirectionPair) -> [DVec3; 2] {
        if self.is_isotropic() {
            self.parametrization.isotropic_hemispheres(pair)
        } else {
            self.parametrization.hemispheres(pair)
        }
    }

    /// The pair of two points, or `None` where one of its directions would lie below the horizon.
    pub fn pair(&self, points: [DVec3; 2]) -> Option<DirectionPair> {
        if self.is_isotropic() {
            self.parametrization.from_isotropic_hemispheres(points)
        } else {
            self.parametrization.from_hemispheres(points)
        }
    }
}
