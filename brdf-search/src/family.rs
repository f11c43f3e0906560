//! Which models a search looks among.

use brdf_factor::{Coordinate, FactorSpec, Problem};
use brdf_param::{Projection, Space};

use crate::SearchError;

/// Most terms of a search.
pub const MAX_TERMS: usize = 8;

/// The models of a search: projections of one space, and factors that stand beside them.
#[derive(Clone, Debug, PartialEq)]
pub struct Family {
    /// Space of the projections.
    pub space: Space,
    /// Whether every projection shares its texture with its reciprocal conjugate.
    pub reciprocal: bool,
    /// Factors of given coordinates, linear or not, that every model has: `h` in standard space, say,
    /// or radial maps. Their textures are solved for with the others.
    pub fixed: Vec<FactorSpec>,
}

impl Family {
    /// Projections alone.
    pub fn new(space: Space, reciprocal: bool) -> Self {
        Self { space, reciprocal, fixed: Vec::new() }
    }

    /// The factor of a projection.
    pub fn spec(&self, projection: Projection) -> FactorSpec {
        let coordinate = Coordinate::Projected { space: self.space, projection };
        if self.reciprocal {
            FactorSpec::reciprocal(coordinate)
        } else {
            FactorSpec::single(coordinate)
        }
    }

    /// The factors of a model: the fixed ones, then one for each projection.
    pub fn specs(&self, projections: &[Projection]) -> Vec<FactorSpec> {
        let searched = projections.iter().map(|&projection| self.spec(projection));
        self.fixed.iter().cloned().chain(searched).collect()
    }

    /// Whether models of up to `terms` projections can be fitted to a problem.
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
