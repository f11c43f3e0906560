//! Sums of products read from two linear tables: what renderers and shaders do.

use crate::harmonics::Symmetry;
use crate::products::{Products, Shape};
use crate::warp::{HalfAxis, difference_angle, difference_axis};

/// Nodes along the axis of θh.
const HALF_NODES: usize = 512;
/// Nodes for each spline along the axis of θd.
const NODES_PER_SPLINE: usize = 3;
/// Nodes for each quarter of a turn of the harmonic of largest order.
const NODES_PER_QUARTER: usize = 3;
/// θh below which the azimuth of the difference vector means less and less, radians. At θh = 0 it means nothing:
/// without this the value in the mirror direction would depend on rounding.
pub(crate) const FADE: f64 = 1e-5;

/// The two tables of a model.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tables {
    pub(crate) axis: HalfAxis,
    pub(crate) symmetry: Symmetry,
    /// Terms, filled up with zeros to a multiple of four.
    pub(crate) terms: usize,
    pub(crate) channels: usize,
    /// g of each term, node by node over θh.
    pub(crate) half: Vec<f32>,
    /// Nodes over θd and over φd; one column more holds means over φd.
    pub(crate) size: [usize; 2],
    /// The other side: node by node, φd running fastest; all terms of a channel together.
    pub(crate) difference: Vec<f32>,
}

/// A place between nodes: the lower node, and how far it is to the next, [0, 1].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    node: usize,
    rest: f64,
}

impl Place {
    pub(crate) fn on(axis: f64, nodes: usize) -> Self {
        let scaled = axis.clamp(0.0, 1.0) * (nodes - 1) as f64;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "from 0 to the number of nodes"
        )]
        let node = (scaled as usize).min(nodes - 2);
        Self { node, rest: scaled - node as f64 }
    }
}

/// Rows over θd and columns over φd of a shape's table, without the column of means.
pub(crate) fn table_size(shape: &Shape) -> [usize; 2] {
    let quarters = shape.order * shape.symmetry.quarters();
    [NODES_PER_SPLINE * shape.difference.count, (NODES_PER_QUARTER * quarters).max(8) + 1]
}

impl Tables {
    #[expect(clippy::cast_possible_truncation, reason = "tables are f32")]
    pub(crate) fn new(products: &Products) -> Self {
        let shape = &products.shape;
        let terms = shape.terms.next_multiple_of(4);
        let period = shape.symmetry.period();
        let [rows, columns] = table_size(shape);

        let mut half = vec![0.0; HALF_NODES * terms];
        for (node, values) in half.chunks_exact_mut(terms).enumerate() {
            let taps = shape.half.taps(node as f64 / (HALF_NODES - 1) as f64);
            for (term, value) in values[..shape.terms].iter_mut().enumerate() {
                *value = taps.read(products.half_of(term)) as f32;
            }
        }
        let harmonics = shape.harmonics();
        let stride = shape.channels * terms;
        let mut difference = vec![0.0; rows * (columns + 1) * stride];
        for (node, values) in difference.chunks_exact_mut(stride).enumerate() {
            let (row, column) = (node / (columns + 1), node % (columns + 1));
            let theta = difference_angle(row as f64 / (rows - 1) as f64);
            let phi = period * column as f64 / (columns - 1) as f64;
            let mut place = shape.difference_row(&harmonics, theta, phi);
            if column == columns {
                // The mean over a turn is what the harmonic of order 0 has.
                place.harmonics[1..].fill(0.0);
            }
            for term in 0..shape.terms {
                let read = place.read(products.difference_of(term));
                for channel in 0..shape.channels {
                    values[channel * terms + term] = read[channel] as f32;
                }
            }
        }
        Self {
            axis: shape.axis,
            symmetry: shape.symmetry,
            terms,
            channels: shape.channels,
            half,
            size: [rows, columns],
            difference,
        }
    }

    /// Returns y of each channel.
    pub(crate) fn read(&self, theta_h: f64, theta_d: f64, phi_d: f64) -> [f64; 3] {
        let [rows, columns] = self.size;
        let half = Place::on(self.axis.place(theta_h), HALF_NODES);
        let row = Place::on(difference_axis(theta_d), rows);
        let column = Place::on(self.symmetry.fold(phi_d) / self.symmetry.period(), columns);
        let known = (theta_h / FADE).min(1.0);
        let weights = [
            (row.node, column.node, (1.0 - row.rest) * (1.0 - column.rest) * known),
            (row.node, column.node + 1, (1.0 - row.rest) * column.rest * known),
            (row.node + 1, column.node, row.rest * (1.0 - column.rest) * known),
            (row.node + 1, column.node + 1, row.rest * column.rest * known),
            (row.node, columns, (1.0 - row.rest) * (1.0 - known)),
            (row.node + 1, columns, row.rest * (1.0 - known)),
        ];
        let stride = self.channels * self.terms;
        let g = |node: usize, term: usize| f64::from(self.half[node * self.terms + term]);
        let mut sums = [0.0; 3];
        for term in 0..self.terms {
            let g = (1.0 - half.rest) * g(half.node, term) + half.rest * g(half.node + 1, term);
            for (channel, sum) in sums[..self.channels].iter_mut().enumerate() {
                let read = weights.iter().map(|&(row, column, weight)| {
                    let node = row * (columns + 1) + column;
                    let at = node * stride + channel * self.terms + term;
                    weight * f64::from(self.difference[at])
                });
                *sum += g * read.sum::<f64>();
            }
        }
        sums
    }

    pub(crate) fn bytes(&self) -> usize {
        4 * (self.half.len() + self.difference.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::CubicBasis;

    /// Tables are the products that they were made of, but for what a straight line misses.
    #[test]
    fn tables_follow_the_splines() {
        for symmetry in Symmetry::ALL {
            let shape = Shape {
                terms: 3,
                half: CubicBasis { count: 12, is_even: true },
                axis: HalfAxis { alpha: 0.02 },
                difference: CubicBasis { count: 7, is_even: false },
                symmetry,
                order: 4,
                channels: 3,
            };
            let wave = |i: usize| (i as f64 * 0.7).sin();
            let length = shape.terms * shape.difference_len();
            let products = Products {
                half: (0..36).map(wave).collect(),
                difference: (0..length).map(|i| [wave(i + 1), wave(i + 2), wave(i + 3)]).collect(),
                shape,
            };
            let tables = Tables::new(&products);
            for step in 1..500_u32 {
                let t = f64::from(step);
                let (theta_h, theta_d) =
                    ((0.1 * t).sin().abs() * 1.5, (0.37 * t).cos().abs() * 1.5);
                let phi_d = 3.1 * (0.77 * t).sin();
                let (read, exact) =
                    (tables.read(theta_h, theta_d, phi_d), products.eval(theta_h, theta_d, phi_d));
                for c in 0..3 {
                    let off = (read[c] - exact[c]).abs();
                    assert!(off < 0.1, "{symmetry:?}: {read:?} against {exact:?} at {step}");
                }
            }
        }
    }
}
