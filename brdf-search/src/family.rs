//! Families: the models that a search compares.

use brdf_factor::{Coordinate, FactorSpec, Problem};
use brdf_param::{Projection, Space};

use crate::SearchError;

/// The largest number of terms of a search.
pub const MAX_TERMS: usize = 8;

/// The models that a search compares: projections of one space, beside factors that are fixed.
///
/// ```
/// use brdf_factor::{Coordinate, FactorSpec};
/// use brdf_param::{Projection, Space};
/// use brdf_search::Family;
///
/// let fixed = vec![FactorSpec::single(Coordinate::H)];
/// let family = Family { fixed, ..Family::new(Space::Standard, true) };
/// assert_eq!(family.specs(&[Projection::FIRST]).len(), 2);
/// assert!(family.spec(Projection::FIRST).is_reciprocal());
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Family {
    /// Space of the projections.
    pub space: Space,
    /// Whether every projection shares its texture with its reciprocal conjugate.
    pub reciprocal: bool,
    /// Factors of given coordinates, linear or not, that every model has, such as the half vector in
    /// standard space, or radial maps. Their textures are solved for with the others.
    pub fixed: Vec<FactorSpec>,
}

impl Family {
    /// Returns the family of projections of a space, without fixed factors.
    pub fn new(space: Space, reciprocal: bool) -> Self {
        Self { space, reciprocal, fixed: Vec::new() }
    }

    /// Returns the factor of a projection.
    pub fn spec(&self, projection: Projection) -> FactorSpec {
        let coordinate = Coordinate::Projected { space: self.space, projection };
        if self.reciprocal {
            FactorSpec::reciprocal(coordinate)
        } else {
            FactorSpec::single(coordinate)
        }
    }

    /// Returns the factors of a model: the fixed ones, then one for each projection.
    pub fn specs(&self, projections: &[Projection]) -> Vec<FactorSpec> {
        let searched = projections.iter().map(|&projection| self.spec(projection));
        self.fixed.iter().cloned().chain(searched).collect()
    }

    /// Checks that models of up to `terms` projections can be fitted to a problem.
    pub(crate) fn check(
        &self,
        problem: &Problem,
        terms: usize,
        size: usize,
    ) -> Result<(), SearchError> {
        if !(1..=MAX_TERMS).contains(&terms) {
            return Err(SearchError::Option {
                option: "the number of terms",
                value: terms.to_string(),
                expected: "1 to 8",
            });
        }
        if self.reciprocal
            && let Some(factor) = self.fixed.iter().position(|spec| !spec.is_reciprocal())
        {
            return Err(SearchError::NotReciprocal { factor });
        }
        let (samples, unknowns) = (problem.len(), terms * size * size);
        // A disc or octagon fills at least half of its square.
        if problem.params().smoothing <= 0.0 && samples < unknowns / 2 {
            return Err(SearchError::Underdetermined { unknowns, samples });
        }
        Ok(())
    }
}
