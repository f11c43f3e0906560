//! Sums of products of splines, by their coefficients.

use crate::basis::{CubicBasis, Taps};
use crate::harmonics::{Harmonic, Symmetry};
use crate::warp::{HalfAxis, difference_axis};

/// What a sum of products is made of.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Shape {
    /// Products.
    pub(crate) terms: usize,
    /// Splines over θh.
    pub(crate) half: CubicBasis,
    pub(crate) axis: HalfAxis,
    /// Splines over θd.
    pub(crate) difference: CubicBasis,
    pub(crate) symmetry: Symmetry,
    /// Largest order of a harmonic of φd.
    pub(crate) order: usize,
    /// 1 or 3.
    pub(crate) channels: usize,
}

/// y_c = Σ_k g_k(θh) Σ_jm C_kjmc B_j(θd) sinᵐθd cos mφd, without what turns y into a value.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Products {
    pub(crate) shape: Shape,
    /// Coefficients of g, the splines of a term together.
    pub(crate) half: Vec<f64>,
    /// Coefficients C\[term\]\[spline\]\[harmonic\]\[channel\].
    pub(crate) difference: Vec<[f64; 3]>,
}

/// The functions of θd and φd that are not 0 at a place.
#[derive(Clone, Debug)]
pub(crate) struct DifferenceRow {
    pub(crate) taps: Taps,
    /// One for each harmonic.
    pub(crate) harmonics: Vec<f64>,
}

impl Shape {
    pub(crate) fn harmonics(&self) -> Vec<Harmonic> {
        self.symmetry.harmonics(self.order)
    }

    /// Coefficients of a term's function of θd and φd, for each channel.
    pub(crate) fn difference_len(&self) -> usize {
        self.difference.count * self.harmonics().len()
    }

    pub(crate) fn half_taps(&self, theta_h: f64) -> Taps {
        self.half.taps(self.axis.place(theta_h))
    }

    pub(crate) fn difference_row(
        &self,
        harmonics: &[Harmonic],
        theta_d: f64,
        phi_d: f64,
    ) -> DifferenceRow {
        let sin = theta_d.sin();
        DifferenceRow {
            taps: self.difference.taps(difference_axis(theta_d)),
            harmonics: harmonics.iter().map(|harmonic| harmonic.value(sin, phi_d)).collect(),
        }
    }
}

impl DifferenceRow {
    /// The value of one term for each channel.
    pub(crate) fn read(&self, coefficients: &[[f64; 3]]) -> [f64; 3] {
        let count = self.harmonics.len();
        let mut sum = [0.0; 3];
        for (&at, weight) in self.taps.at.iter().zip(self.taps.weights) {
            let own = &coefficients[at * count..(at + 1) * count];
            for (value, coefficient) in self.harmonics.iter().zip(own) {
                for (sum, coefficient) in sum.iter_mut().zip(coefficient) {
                    *sum += weight * value * coefficient;
                }
            }
        }
        sum
    }
}

impl Products {
    /// The splines over θh of a term.
    pub(crate) fn half_of(&self, term: usize) -> &[f64] {
        let count = self.shape.half.count;
        &self.half[term * count..(term + 1) * count]
    }

    /// The coefficients over θd and φd of a term.
    pub(crate) fn difference_of(&self, term: usize) -> &[[f64; 3]] {
        let count = self.shape.difference_len();
        &self.difference[term * count..(term + 1) * count]
    }

    /// Returns y of each channel: the slow form that tables are held to.
    #[cfg(test)]
    pub(crate) fn eval(&self, theta_h: f64, theta_d: f64, phi_d: f64) -> [f64; 3] {
        self.eval_with(&self.shape.harmonics(), theta_h, theta_d, phi_d)
    }

    /// Returns y of each channel, given the harmonics of the shape.
    pub(crate) fn eval_with(
        &self,
        harmonics: &[Harmonic],
        theta_h: f64,
        theta_d: f64,
        phi_d: f64,
    ) -> [f64; 3] {
        let taps = self.shape.half_taps(theta_h);
        let row = self.shape.difference_row(harmonics, theta_d, phi_d);
        (0..self.shape.terms).fold([0.0; 3], |sum, term| {
            let half = taps.read(self.half_of(term));
            let difference = row.read(self.difference_of(term));
            std::array::from_fn(|c| sum[c] + half * difference[c])
        })
    }
}
