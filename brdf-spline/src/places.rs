//! The splines of either side at the places of the nodes, and what least squares over them need.

use std::ops::Range;

use crate::banded::{Banded, add, dot};
use crate::basis::{CubicBasis, Taps};
use crate::nodes::Difference;
use crate::products::Shape;
use crate::warp::difference_axis;

/// Splines over θh at places.
pub(crate) struct HalfPlaces {
    basis: CubicBasis,
    taps: Vec<Taps>,
}

impl HalfPlaces {
    pub(crate) fn new(shape: &Shape, theta_h: &[f64]) -> Self {
        let taps = theta_h.iter().map(|&theta| shape.half_taps(theta)).collect();
        Self { basis: shape.half, taps }
    }

    /// Returns the value of the spline of these coefficients at each place.
    pub(crate) fn read(&self, coefficients: &[f64]) -> impl Iterator<Item = f64> {
        self.taps.iter().map(|taps| taps.read(coefficients))
    }

    /// Returns the sums over places of a value times each spline.
    pub(crate) fn side(&self, values: &[f64]) -> Vec<f64> {
        let mut side = vec![0.0; self.basis.count];
        for (taps, value) in self.taps.iter().zip(values) {
            for (&at, weight) in taps.at.iter().zip(taps.weights) {
                side[at] += weight * value;
            }
        }
        side
    }

    /// Returns the sums over places of a weight times products of two splines.
    pub(crate) fn squares(&self, weight: impl Fn(usize) -> f64) -> Banded {
        let mut gram = Banded::zeros(self.basis.count, 4);
        for (point, taps) in self.taps.iter().enumerate() {
            let weight = weight(point);
            for (&i, a) in taps.at.iter().zip(taps.weights) {
                for (&j, b) in taps.at.iter().zip(taps.weights).filter(|(j, _)| **j <= i) {
                    gram.add(i, j, weight * a * b);
                }
            }
        }
        gram
    }
}

/// Splines over θd times harmonics of φd at places.
pub(crate) struct DifferencePlaces {
    basis: CubicBasis,
    /// Harmonics of each place.
    count: usize,
    harmonics: Vec<f64>,
    /// Places that follow each other and have the same θd, as those of a grid do.
    rings: Vec<Ring>,
    /// Places that follow each other and are the same, as those of lobes beside samples are.
    spokes: Vec<Range<usize>>,
}

struct Ring {
    taps: Taps,
    spokes: Range<usize>,
}

impl DifferencePlaces {
    pub(crate) fn new(shape: &Shape, places: &[Difference]) -> Self {
        let functions = shape.harmonics();
        let (mut rings, mut spokes): (Vec<Ring>, Vec<Range<usize>>) = (Vec::new(), Vec::new());
        let mut harmonics = Vec::new();
        let mut place = 0;
        for ring in places.chunk_by(|a, b| a.theta.total_cmp(&b.theta).is_eq()) {
            let first = spokes.len();
            for spoke in ring.chunk_by(|a, b| a.phi.total_cmp(&b.phi).is_eq()) {
                let (sin, phi) = (spoke[0].theta.sin(), spoke[0].phi);
                harmonics.extend(functions.iter().map(|function| function.value(sin, phi)));
                spokes.push(place..place + spoke.len());
                place += spoke.len();
            }
            let taps = shape.difference.taps(difference_axis(ring[0].theta));
            rings.push(Ring { taps, spokes: first..spokes.len() });
        }
        Self { basis: shape.difference, count: functions.len(), harmonics, rings, spokes }
    }

    pub(crate) fn len(&self) -> usize {
        self.spokes.last().map_or(0, |places| places.end)
    }

    fn at(&self, spoke: usize) -> &[f64] {
        &self.harmonics[spoke * self.count..(spoke + 1) * self.count]
    }

    /// Writes the value of the function of these coefficients at each place into every `stride`th number.
    #[inline(always)]
    pub(crate) fn read(&self, coefficients: &[f64], values: &mut [f64], stride: usize) {
        let mut own = vec![0.0; self.count];
        for Ring { taps, spokes } in &self.rings {
            own.fill(0.0);
            for (&j, weight) in taps.at.iter().zip(taps.weights) {
                add(weight, &coefficients[j * self.count..(j + 1) * self.count], &mut own);
            }
            for spoke in spokes.clone() {
                let value = dot(&own, self.at(spoke));
                for place in self.spokes[spoke].clone() {
                    values[place * stride] = value;
                }
            }
        }
    }

    /// Writes the sums over places of a value times each function, in the order of coefficients.
    #[inline(always)]
    pub(crate) fn side(&self, values: &[f64], side: &mut [f64]) {
        side.fill(0.0);
        let mut own = vec![0.0; self.count];
        for Ring { taps, spokes } in &self.rings {
            own.fill(0.0);
            for spoke in spokes.clone() {
                add(
                    self.spokes[spoke].clone().map(|place| values[place]).sum(),
                    self.at(spoke),
                    &mut own,
                );
            }
            for (&j, weight) in taps.at.iter().zip(taps.weights) {
                add(weight, &own, &mut side[j * self.count..(j + 1) * self.count]);
            }
        }
    }

    /// Returns the sums over places of a weight times products of two functions.
    #[inline(always)]
    pub(crate) fn squares(&self, weight: impl Fn(usize) -> f64) -> Banded {
        let count = self.count;
        let mut gram = Banded::zeros(self.basis.count * count, 4 * count);
        let mut angular = vec![0.0; count * count];
        let mut whole = Vec::with_capacity(4 * count);
        let weight = |spoke: usize| self.spokes[spoke].clone().map(&weight).sum::<f64>();
        for Ring { taps, spokes } in &self.rings {
            if spokes.len() == 1 {
                // Splines that follow each other: one row of coefficients.
                let harmonics = self.at(spokes.start);
                whole.clear();
                whole
                    .extend(taps.weights.iter().flat_map(|w| harmonics.iter().map(move |h| w * h)));
                let (weight, first) = (weight(spokes.start), taps.at[0] * count);
                for (at, value) in whole.iter().enumerate() {
                    let row = gram.row_mut(first + at, first, at + 1);
                    add(weight * value, &whole, row);
                }
                continue;
            }
            angular.fill(0.0);
            for spoke in spokes.clone() {
                let (weight, harmonics) = (weight(spoke), self.at(spoke));
                for (line, value) in angular.chunks_exact_mut(count).zip(harmonics) {
                    add(weight * value, harmonics, line);
                }
            }
            for (a, &i) in taps.at.iter().enumerate() {
                for (b, &j) in taps.at[..=a].iter().enumerate() {
                    let weight = taps.weights[a] * taps.weights[b];
                    for (m, line) in angular.chunks_exact(count).enumerate() {
                        let columns = if i == j { m + 1 } else { count };
                        let row = gram.row_mut(i * count + m, j * count, columns);
                        add(weight, line, row);
                    }
                }
            }
        }
        gram
    }
}

/// Adds the squares of second differences along a basis to a matrix.
pub(crate) fn smooth(
    gram: &mut Banded,
    basis: CubicBasis,
    weight: f64,
    at: impl Fn(usize) -> usize,
) {
    for middle in 1..basis.count - 1 {
        let stencil = [(middle - 1, 1.0), (middle, -2.0), (middle + 1, 1.0)];
        for (a, (i, x)) in stencil.into_iter().enumerate() {
            for &(j, y) in &stencil[..=a] {
                gram.add(at(i), at(j), weight * x * y);
            }
        }
    }
}
