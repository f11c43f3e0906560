//! A table over the three coordinates of an isotropic BRDF, and the best function of two of them.

use std::f64::consts::PI;

use brdf_model::Brdf;
use brdf_param::{DirectionPair, Parametrization};
use brdf_separable::{KrylovParams, SeparableError, top_singular_triplets};
use faer::Mat;

use crate::slice::{pair_at, share_of};

/// The isotropic coordinates of a pair, each in [0, 1]: shares of both radial ranges, and the
/// azimuth between the points in half turns, folded to [0, 1] by bilateral symmetry.
pub(crate) fn unit_coordinates(parametrization: Parametrization, pair: &DirectionPair) -> [f64; 3] {
    let [first, second] = parametrization.isotropic_hemispheres(pair);
    let azimuth = brdf_param::azimuth(second).abs() / PI;
    [share_of(parametrization, first), share_of(parametrization, second), azimuth].map(unit)
}

fn unit(value: f64) -> f64 {
    value.clamp(0.0, 1.0)
}

/// Values at n³ cell centres of the unit cube, read trilinearly; the outermost centres hold to the
/// rim.
pub(crate) struct Grid {
    size: usize,
    values: Vec<f64>,
}

impl Grid {
    /// Tabulates a value of each pair. Cells that belong to no pair, or of which the material knows
    /// nothing, take the value of the nearest cell along the second coordinate that does.
    pub(crate) fn tabulate(
        brdf: &dyn Brdf,
        parametrization: Parametrization,
        size: usize,
        value: impl Fn(&DirectionPair) -> f64,
    ) -> Self {
        let mut values = vec![0.0; size * size * size];
        for azimuth in 0..size {
            for first in 0..size {
                let mut inner = None;
                let mut waiting = Vec::new();
                for second in 0..size {
                    let [u, v, w] = [first, second, azimuth].map(|i| centre(i, size));
                    let cell = (azimuth * size + second) * size + first;
                    let known = pair_at(parametrization, [u, v], PI * w)
                        .filter(|pair| pair.wi.z > 0.0 && pair.wo.z > 0.0 && brdf.has_data(pair))
                        .map(|pair| value(&pair));
                    if let Some(known) = known {
                        waiting.drain(..).for_each(|cell: usize| values[cell] = known);
                    }
                    match known.or(inner) {
                        Some(value) => {
                            values[cell] = value;
                            inner = Some(value);
                        }
                        None => waiting.push(cell),
                    }
                }
            }
        }
        Self { size, values }
    }

    /// The best sum of `rank` products of a function of the first coordinate and one of the other
    /// two, cell by cell; the grid itself where it has no more to give.
    ///
    /// # Errors
    ///
    /// Those of [`top_singular_triplets`].
    pub(crate) fn truncated(&self, rank: usize) -> Result<Self, SeparableError> {
        let size = self.size;
        let matrix =
            Mat::from_fn(size, size * size, |first, rest| self.values[rest * size + first]);
        let params =
            KrylovParams { rank: rank.min(size), pair_gap: 0.0, ..KrylovParams::default() };
        let pairs = top_singular_triplets(matrix.as_ref(), &params)?;
        let values = (0..self.values.len())
            .map(|cell| {
                let (first, rest) = (cell % size, cell / size);
                let term = |(k, value): (usize, &f64)| {
                    value * pairs.left[(first, k)] * pairs.right[(rest, k)]
                };
                pairs.values.iter().enumerate().map(term).sum()
            })
            .collect();
        Ok(Self { size, values })
    }

    /// The value at unit coordinates.
    pub(crate) fn read(&self, at: [f64; 3]) -> f64 {
        let [u, v, w] = at.map(|share| span(share, self.size));
        let mut sum = 0.0;
        for (k, weight_w) in w {
            for (j, weight_v) in v {
                for (i, weight_u) in u {
                    let cell = (k * self.size + j) * self.size + i;
                    sum += weight_u * weight_v * weight_w * self.values[cell];
                }
            }
        }
        sum
    }
}

fn centre(index: usize, size: usize) -> f64 {
    (index as f64 + 0.5) / size as f64
}

/// The two cell centres around a share of an axis, with their weights.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "positions are clamped to the grid"
)]
fn span(share: f64, size: usize) -> [(usize, f64); 2] {
    let position = (share * size as f64 - 0.5).clamp(0.0, (size - 1) as f64);
    let first = (position as usize).min(size - 2);
    let part = position - first as f64;
    [(first, 1.0 - part), (first + 1, part)]
}

/// Means of values over the bins of two coordinates: the best function of them in the least-squares
/// sense, as fine as the bins.
pub(crate) struct Means {
    bins: usize,
    sums: Vec<(f64, f64)>,
    overall: f64,
}

impl Means {
    pub(crate) fn of(points: &[[f64; 2]], values: &[f64], bins: usize) -> Self {
        let mut sums = vec![(0.0, 0.0); bins * bins];
        for (point, value) in points.iter().zip(values) {
            let sum = &mut sums[bin(*point, bins)];
            sum.0 += value;
            sum.1 += 1.0;
        }
        let overall = values.iter().sum::<f64>() / values.len().max(1) as f64;
        Self { bins, sums, overall }
    }

    pub(crate) fn at(&self, point: [f64; 2]) -> f64 {
        let (sum, count) = self.sums[bin(point, self.bins)];
        if count > 0.0 { sum / count } else { self.overall }
    }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "shares lie in [0, 1]")]
fn bin(point: [f64; 2], bins: usize) -> usize {
    let [i, j] = point.map(|share| ((share * bins as f64) as usize).min(bins - 1));
    j * bins + i
}
