//! How much a residual of logarithms counts at each node: as much as the measures of a fit say.

use brdf_model::MeasuredValue;
use rayon::prelude::*;

use crate::nodes::{Node, Nodes};

/// Weights of nodes never exceed this many times their median, relative to their share of pairs.
const CAP: f64 = 30.0;
/// Measures: displays, cube roots, energy, logarithms.
const MEASURES: usize = 4;
/// Nodes whose sums are taken together: fixed, so that results do not depend on the number of threads.
const BLOCK: usize = 4096;

/// Values of a node under the measures, and what they change with y = ln(a + f).
pub(crate) struct Weights {
    offsets: [f64; 3],
    wanted: Vec<[[f64; MEASURES]; 3]>,
    /// Squared slopes, means over channels.
    slopes: Vec<[f64; MEASURES]>,
}

/// A value at a node, for the measures of [`brdf_model::FidelityErrors`].
fn at(node: &Node, value: f64, offset: f64) -> MeasuredValue {
    MeasuredValue { value, cosine: node.cosine, offset }
}

impl Weights {
    pub(crate) fn new(nodes: &Nodes, offsets: [f64; 3]) -> Self {
        let channels = nodes.channels;
        let of = |node: &Node| {
            let (mut wanted, mut squares) = ([[0.0; MEASURES]; 3], [0.0; MEASURES]);
            for c in 0..channels {
                let value = at(node, node.value[c], offsets[c]);
                wanted[c] = value.measures();
                for (sum, slope) in squares.iter_mut().zip(value.slopes()) {
                    *sum += slope * slope / channels as f64;
                }
            }
            (wanted, squares)
        };
        let (wanted, slopes) = nodes.nodes.par_iter().map(of).unzip();
        Self { offsets, wanted, slopes }
    }

    /// Returns weights for a first fit: squared slopes of the measures, each brought to the same mean.
    pub(crate) fn first(&self, nodes: &Nodes) -> Vec<f64> {
        /// Energy depends on the brightest nodes alone.
        const PARTS: [f64; MEASURES] = [1.0, 1.0, 0.3, 1.0];
        let known = || nodes.nodes.iter().zip(&self.slopes).filter(|(node, _)| node.is_known());
        let count = known().count().max(1) as f64;
        let sums = known().fold([0.0; MEASURES], |sum, (_, squares)| {
            std::array::from_fn(|m| sum[m] + squares[m])
        });
        let factors = std::array::from_fn(|m| PARTS[m] * count / sums[m].max(f64::MIN_POSITIVE));
        self.weights(nodes, [factors; 2])
    }

    /// Returns weights whose least squares lower the geometric mean of the measures over both sets of pairs: each
    /// measure's squares over their present mean. `predicted` are the present y of every node.
    pub(crate) fn next(&self, nodes: &Nodes, predicted: &[[f64; 3]]) -> Vec<f64> {
        let errors: Vec<[[f64; MEASURES]; 2]> = nodes
            .nodes
            .par_chunks(BLOCK)
            .zip(predicted.par_chunks(BLOCK))
            .zip(self.wanted.par_chunks(BLOCK))
            .map(|((nodes, predicted), wanted)| {
                let mut sums = [[0.0; MEASURES]; 2];
                for ((node, y), wanted) in nodes.iter().zip(predicted).zip(wanted) {
                    self.add_squares(node, y, wanted, &mut sums);
                }
                sums
            })
            .collect();
        let factors = [0, 1].map(|set| {
            std::array::from_fn(|m| {
                let mean: f64 = errors.iter().map(|sums| sums[set][m]).sum();
                1.0 / mean.max(1e-12)
            })
        });
        self.weights(nodes, factors)
    }

    fn add_squares(
        &self,
        node: &Node,
        y: &[f64; 3],
        wanted: &[[f64; MEASURES]; 3],
        sums: &mut [[f64; MEASURES]; 2],
    ) {
        if !node.is_known() {
            return;
        }
        for ((y, wanted), offset) in y.iter().zip(wanted).zip(self.offsets) {
            let found = at(node, y.exp() - offset, offset).measures();
            for m in 0..MEASURES {
                let square = (found[m] - wanted[m]) * (found[m] - wanted[m]);
                for (sums, share) in sums.iter_mut().zip(node.shares) {
                    sums[m] += share * square;
                }
            }
        }
    }

    /// Weights in which the squares of a measure count by a factor for each set of pairs.
    fn weights(&self, nodes: &Nodes, factors: [[f64; MEASURES]; 2]) -> Vec<f64> {
        let mut weights = vec![0.0; nodes.nodes.len()];
        for (set, factors) in factors.iter().enumerate() {
            let of = |squares: &[f64; MEASURES]| -> f64 {
                squares.iter().zip(factors).map(|(square, factor)| square * factor).sum()
            };
            let mut known: Vec<f64> = nodes
                .nodes
                .iter()
                .zip(&self.slopes)
                .filter(|(node, _)| node.is_known())
                .map(|(_, squares)| of(squares))
                .collect();
            let middle = known.len() / 2;
            let cap = match known.len() {
                0 => continue,
                _ => CAP * *known.select_nth_unstable_by(middle, f64::total_cmp).1,
            };
            let nodes = nodes.nodes.iter().zip(&self.slopes);
            for (weight, (node, squares)) in weights.iter_mut().zip(nodes) {
                *weight += of(squares).min(cap) * node.shares[set];
            }
        }
        // Terms and their coefficients have the scale of y whatever the errors are.
        let total: f64 = weights.iter().sum();
        weights.iter_mut().for_each(|weight| *weight /= total.max(f64::MIN_POSITIVE));
        weights
    }
}
