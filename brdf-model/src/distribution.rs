//! Distributions by running sums: drawing from a table in proportion to its values.

/// A piecewise constant distribution over cells, by the running sum of their weights.
///
/// ```
/// use brdf_model::Distribution1D;
///
/// let weights = Distribution1D::new([1.0, 0.0, 3.0]).expect("one is positive");
/// let (cell, across) = weights.sample(0.625);
/// assert_eq!(cell, 2);
/// assert!((across - 0.5).abs() < 1e-12 && (weights.share(2) - 0.75).abs() < 1e-12);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Distribution1D {
    /// Running sum, normalized.
    cumulative: Vec<f64>,
    total: f64,
}

impl Distribution1D {
    /// Returns the distribution of these weights, each 0 or more, or `None` if their sum is not positive.
    pub fn new(weights: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut total = 0.0;
        let mut cumulative: Vec<f64> = weights
            .into_iter()
            .map(|weight| {
                total += weight;
                total
            })
            .collect();
        if !(total > 0.0 && total.is_finite()) {
            return None;
        }
        cumulative.iter_mut().for_each(|sum| *sum /= total);
        Some(Self { cumulative, total })
    }

    /// Returns the sum of all weights.
    pub fn total(&self) -> f64 {
        self.total
    }

    /// Returns the cell that a number in [0, 1) falls into, and how far into the cell, [0, 1].
    pub fn sample(&self, u: f64) -> (usize, f64) {
        let last = self.cumulative.len() - 1;
        let index = self.cumulative.partition_point(|&sum| sum <= u).min(last);
        let before = self.before(index);
        let width = self.cumulative[index] - before;
        (index, if width > 0.0 { ((u - before) / width).clamp(0.0, 1.0) } else { 0.5 })
    }

    /// Returns the probability of a cell.
    ///
    /// # Panics
    ///
    /// If there is no such cell.
    pub fn share(&self, index: usize) -> f64 {
        self.cumulative[index] - self.before(index)
    }

    fn before(&self, index: usize) -> f64 {
        if index == 0 { 0.0 } else { self.cumulative[index - 1] }
    }
}

/// Rows of piecewise linear densities, each stored as its running integral.
///
/// Nodes are one apart. An entry is the integral from the first node to its own, so the last entry of
/// a row is the integral of the whole row. With these, places are drawn along one axis of a table that
/// is linear between its nodes.
///
/// ```
/// use brdf_model::{LinearDistributions, linear_part, linear_segment, share_of};
///
/// let ramp = [0.0_f32, 1.0, 2.0];
/// let rows = LinearDistributions::new(3, 1, |_, node| ramp[node]);
/// assert_eq!(rows.row(0), [0.0, 0.5, 2.0]);
/// // The place below which a quarter of the density lies: halfway along the ramp.
/// let (node, missing) = linear_segment(rows.row(0), share_of(0.25, rows.total(0)));
/// let place = node as f32 + linear_part([ramp[node], ramp[node + 1]], missing);
/// assert!((place - 1.0).abs() < 1e-6);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LinearDistributions {
    nodes: usize,
    sums: Vec<f32>,
}

impl LinearDistributions {
    /// Returns the integrals of `rows` rows of `nodes` nodes, whose densities are `value(row, node)`.
    pub fn new(nodes: usize, rows: usize, value: impl Fn(usize, usize) -> f32) -> Self {
        let mut sums = Vec::with_capacity(rows * nodes);
        for row in 0..rows {
            let (mut sum, mut low) = (0.0, value(row, 0));
            sums.push(sum);
            for at in 1..nodes {
                let high = value(row, at);
                sum += 0.5 * (low + high);
                sums.push(sum);
                low = high;
            }
        }
        Self { nodes, sums }
    }

    /// Returns the integrals of a row, one for each node.
    ///
    /// # Panics
    ///
    /// If there is no such row.
    #[inline]
    pub fn row(&self, row: usize) -> &[f32] {
        &self.sums[row * self.nodes..][..self.nodes]
    }

    /// Returns the integral of a whole row.
    ///
    /// # Panics
    ///
    /// If there is no such row.
    #[inline]
    pub fn total(&self, row: usize) -> f32 {
        self.row(row)[self.nodes - 1]
    }
}

/// Returns the share `u`, in [0, 1), of an integral `total`; the result is always less than `total`.
#[inline]
#[expect(clippy::cast_possible_truncation, reason = "masses are f32")]
pub fn share_of(u: f64, total: f32) -> f32 {
    (u as f32).min(1.0 - f32::EPSILON) * total
}

/// Returns the last node at which a running integral is at most `wanted`, and how much is then missing
/// to `wanted`.
///
/// The node is counted without branches, which a processor could not predict.
///
/// # Panics
///
/// With fewer than two nodes.
#[inline]
pub fn linear_segment(below: &[f32], wanted: f32) -> (usize, f32) {
    let inner = &below[1..below.len() - 1];
    let at = inner.iter().map(|sum| usize::from(*sum <= wanted)).sum();
    (at, wanted - below[at])
}

/// Returns the part of the way between two nodes, [0, 1], at which the integral of the line from `low` to
/// `high` reaches `wanted`.
#[inline]
pub fn linear_part([low, high]: [f32; 2], wanted: f32) -> f32 {
    // ½ (high − low) t² + low t = wanted, in a form that loses no digits.
    let root = (low * low + 2.0 * (high - low) * wanted).max(0.0).sqrt();
    let t = if low + root > 0.0 { 2.0 * wanted / (low + root) } else { 0.5 };
    t.clamp(0.0, 1.0)
}
