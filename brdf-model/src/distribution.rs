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
    /// Returns the distribution of weights, 0 and above; none if their sum is not positive.
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

    /// Returns a cell and how far into it, [0, 1], for a number in [0, 1).
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

/// Rows of piecewise linear densities by their integrals from the first node up to each, counted in nodes; the last
/// of a row is the whole. What is drawn along one axis of a table that is linear between its nodes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LinearDistributions {
    nodes: usize,
    sums: Vec<f32>,
}

impl LinearDistributions {
    /// Returns the integrals of `rows` rows of densities whose values at the nodes are `value(row, node)`.
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

/// Returns the part of an integral below which a number in [0, 1) lies; always less than the whole.
#[inline]
#[expect(clippy::cast_possible_truncation, reason = "masses are f32")]
pub fn share_of(u: f64, total: f32) -> f32 {
    (u as f32).min(1.0 - f32::EPSILON) * total
}

/// Returns the node below the place where an integral reaches a value, and what is missing there. Counted without
/// branches, which could not be foreseen.
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

/// Returns the part of the way between two nodes where the integral of the line between their values reaches
/// `wanted`, [0, 1].
#[inline]
pub fn linear_part([low, high]: [f32; 2], wanted: f32) -> f32 {
    // ½ (high − low) t² + low t = wanted, in a form that loses no digits.
    let root = (low * low + 2.0 * (high - low) * wanted).max(0.0).sqrt();
    let t = if low + root > 0.0 { 2.0 * wanted / (low + root) } else { 0.5 };
    t.clamp(0.0, 1.0)
}
