//! How much a residual of logarithms counts at each node: as much as the measures of a fit say.

use crate::nodes::{Node, Nodes};

/// Weights of nodes never exceed this many times their median, relative to their share of pairs.
const CAP: f64 = 30.0;
/// Measures: displays, cube roots, energy, logarithms.
const MEASURES: usize = 4;

/// Values of a node under the four measures of [`brdf_model::FidelityErrors`].
fn measures(node: &Node, value: f64, offset: f64) -> [f64; MEASURES] {
    let lit = node.cosine * value.max(0.0);
    [lit.ln_1p(), lit.cbrt(), node.cosine.sqrt() * value, (offset + value).max(f64::MIN_POSITIVE).ln()]
}

/// Derivatives of the measures by y = ln(a + f).
fn slopes(node: &Node, offset: f64, value: f64) -> [f64; MEASURES] {
    let (a, c) = (offset + value, node.cosine);
    [c * a / (1.0 + c * value), (c * a).cbrt() / 3.0, c.sqrt() * a, 1.0]
}

/// Returns weights for a first fit: squared slopes of the measures, each brought to the same mean.
pub(crate) fn first_weights(nodes: &Nodes, offsets: [f64; 3]) -> Vec<f64> {
    /// Energy depends on the brightest nodes alone.
    const SHARES: [f64; MEASURES] = [1.0, 1.0, 0.3, 1.0];
    let squares = squared_slopes(nodes, offsets);
    let count = squares.len().max(1) as f64;
    let means: [f64; MEASURES] = std::array::from_fn(|m| {
        squares.iter().map(|square| square[m]).sum::<f64>() / count
    });
    let values: Vec<f64> = squares
        .iter()
        .map(|square| (0..MEASURES).map(|m| SHARES[m] * square[m] / means[m].max(1e-300)).sum())
        .collect();
    let shares = nodes.nodes.iter().map(|node| node.shares[1] + node.shares[0]);
    capped(values).into_iter().zip(shares).map(|(value, share)| value * share).collect()
}

/// Returns weights whose least squares lower the geometric mean of the measures over both sets of pairs:
/// each measure's squares over their present mean. `predicted` are the present y of every node.
pub(crate) fn next_weights(nodes: &Nodes, offsets: [f64; 3], predicted: &[[f64; 3]]) -> Vec<f64> {
    let squares = squared_slopes(nodes, offsets);
    let mut means = [[1e-12; MEASURES]; 2];
    for (node, y) in nodes.nodes.iter().zip(predicted) {
        for c in 0..nodes.channels {
            let value = y[c].exp() - offsets[c];
            let found = measures(node, value, offsets[c]);
            let wanted = measures(node, node.value[c], offsets[c]);
            for m in 0..MEASURES {
                let square = (found[m] - wanted[m]) * (found[m] - wanted[m]);
                for set in 0..2 {
                    means[set][m] += node.shares[set] * square;
                }
            }
        }
    }
    let weights = [0, 1].map(|set| {
        let own = squares.iter().map(|square| {
            (0..MEASURES).map(|m| square[m] / means[set][m]).sum::<f64>()
        });
        capped(own.collect())
    });
    let both = weights[0].iter().zip(&weights[1]).zip(&nodes.nodes);
    both.map(|((a, b), node)| a * node.shares[0] + b * node.shares[1]).collect()
}

/// Squared slopes, means over channels.
fn squared_slopes(nodes: &Nodes, offsets: [f64; 3]) -> Vec<[f64; MEASURES]> {
    let channels = nodes.channels;
    nodes
        .nodes
        .iter()
        .map(|node| {
            let mut sum = [0.0; MEASURES];
            for (&value, offset) in node.value[..channels].iter().zip(offsets) {
                for (sum, slope) in sum.iter_mut().zip(slopes(node, offset, value)) {
                    *sum += slope * slope / channels as f64;
                }
            }
            sum
        })
        .collect()
}

fn capped(mut values: Vec<f64>) -> Vec<f64> {
    let mut sorted = values.clone();
    sorted.sort_by(f64::total_cmp);
    let median = sorted.get(sorted.len() / 2).copied().unwrap_or(1.0);
    for value in &mut values {
        *value = value.min(CAP * median);
    }
    values
}
