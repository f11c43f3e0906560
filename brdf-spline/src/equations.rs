//! What least squares for one side come to, given the other: sums over nodes, and a matrix for each term.

use crate::banded::{Factored, dot};
use crate::places::{DifferencePlaces, HalfPlaces};

/// Sums over one side's places, for each place of the other side.
pub(crate) struct Sums {
    pub(crate) terms: usize,
    /// Of weights times the products of all pairs of terms.
    pub(crate) products: Vec<f64>,
    /// Of weights times terms times what is to be fitted, for each colour.
    pub(crate) targets: Vec<Vec<f64>>,
}

/// What the coefficients of one side are solved from.
pub(crate) struct Equations {
    pub(crate) sums: Sums,
    /// The factored matrix of each term; none where a term is 0.
    pub(crate) systems: Vec<Option<Factored>>,
}

impl Sums {
    pub(crate) fn product(&self, place: usize, a: usize, b: usize) -> f64 {
        self.products[(place * self.terms + a) * self.terms + b]
    }

    /// Writes what terms other than one leave to be fitted at each place, times weights.
    #[inline(always)]
    fn rest(&self, targets: &[f64], term: usize, values: &[f64], rest: &mut [f64]) {
        let terms = self.terms;
        for (place, rest) in rest.iter_mut().enumerate() {
            let values = &values[place * terms..(place + 1) * terms];
            let at = place * terms + term;
            let products = &self.products[at * terms..(at + 1) * terms];
            *rest = targets[at] - (dot(products, values) - products[term] * values[term]);
        }
    }
}

impl Equations {
    /// Returns the coefficients over θd and φd of one term and colour that are best beside the others.
    #[inline(always)]
    pub(crate) fn difference_of(
        &self,
        places: &DifferencePlaces,
        targets: &[f64],
        term: usize,
        values: &[f64],
    ) -> Option<Vec<f64>> {
        let system = self.systems[term].as_ref()?;
        let mut rest = vec![0.0; places.len()];
        self.sums.rest(targets, term, values, &mut rest);
        let mut side = vec![0.0; system.size()];
        places.side(&rest, &mut side);
        system.solve(&mut side);
        Some(side)
    }

    /// Returns the spline over θh of one term that is best beside the others.
    pub(crate) fn half_of(
        &self,
        places: &HalfPlaces,
        term: usize,
        values: &[f64],
    ) -> Option<Vec<f64>> {
        let system = self.systems[term].as_ref()?;
        let mut rest = vec![0.0; values.len() / self.sums.terms];
        self.sums.rest(&self.sums.targets[0], term, values, &mut rest);
        let mut side = places.side(&rest);
        system.solve(&mut side);
        Some(side)
    }
}
