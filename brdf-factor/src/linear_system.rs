//! The least-squares problem behind a set of factors: log f = Σ_j A_j x_j, with smoothing.
//!
//! Source: Cole 2002, section 3.2.

use brdf_model::SampleSet;

use crate::factored::Factor;
use crate::sparse_rows::SparseRows;

/// How strongly textures are smoothed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Smoothing {
    /// μ ≥ 0. The Laplacian of each masked texel is weighted by λ² = μ Σw / (texels of the factor).
    pub mu: f64,
}

/// Every texel is also pulled towards zero, with this share of the mean weight per texel: enough
/// to settle what the samples leave open (constants moving between factors), too little to show.
const RIDGE: f64 = 1e-7;

/// The unknowns of one factor.
#[derive(Clone, Debug)]
struct Block {
    /// For each texel, its unknown, if it has one.
    unknown_of: Vec<Option<usize>>,
}

/// min ‖A x − y‖²: weighted sample rows, then smoothing rows, then the ridge.
#[derive(Clone, Debug)]
pub struct LinearSystem {
    rows: SparseRows,
    sample_count: usize,
    weight_roots: Vec<f64>,
    blocks: Vec<Block>,
    /// Texel and factor of every unknown.
    texel_of: Vec<(usize, usize)>,
    /// Unknowns that no sample touches.
    untouched: Vec<usize>,
}

impl LinearSystem {
    /// The system of `factors` over `samples` with one weight ≥ 0 per sample.
    pub fn new(
        samples: &SampleSet,
        factors: &[&Factor],
        weights: &[f64],
        smoothing: Smoothing,
    ) -> Self {
        let (blocks, texel_of) = number_unknowns(factors);
        let weight_roots: Vec<f64> = weights.iter().map(|w| w.sqrt()).collect();
        let mut rows = SparseRows::new(texel_of.len());
        let taps = factors.iter().map(|f| f.coordinates().len() * f.grid().taps_per_point());
        let (count, per_sample) = (samples.len(), taps.sum::<usize>());
        rows.reserve(count + 2 * texel_of.len(), count * per_sample + 6 * texel_of.len());
        let mut touched = vec![false; texel_of.len()];
        for (pair, &root) in samples.pairs().zip(&weight_roots) {
            for (factor, block) in factors.iter().zip(&blocks) {
                factor.for_each_tap(&pair, |texel, weight| {
                    // The mask holds every texel around a point of the image, so all are found.
                    if let Some(unknown) = block.unknown_of[texel] {
                        rows.push(unknown, weight);
                        touched[unknown] |= weight > 0.0 && root > 0.0;
                    }
                });
            }
            rows.scale_open_row(root);
            rows.end_row();
        }
        let total_weight: f64 = weights.iter().sum();
        for (factor, block) in factors.iter().zip(&blocks) {
            push_smoothing(&mut rows, factor, block, smoothing.mu * total_weight);
        }
        let untouched = (0..texel_of.len()).filter(|&u| !touched[u]).collect();
        Self { rows, sample_count: samples.len(), weight_roots, blocks, texel_of, untouched }
            .with_ridge(factors, total_weight)
    }

    fn with_ridge(mut self, factors: &[&Factor], total_weight: f64) -> Self {
        for unknown in 0..self.texel_of.len() {
            let (factor, _) = self.texel_of[unknown];
            let strength = RIDGE * total_weight / texel_count(factors[factor]);
            self.rows.push(unknown, strength.sqrt());
            self.rows.end_row();
        }
        self
    }

    /// The matrix A.
    pub fn matrix(&self) -> &SparseRows {
        &self.rows
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.texel_of.len()
    }

    /// Texels that only smoothing holds, as (factor, texel).
    pub fn untouched_texels(&self) -> impl ExactSizeIterator<Item = (usize, usize)> + '_ {
        self.untouched.iter().map(|&unknown| self.texel_of[unknown])
    }

    /// The right-hand side y for one value per sample: weighted, and zero under smoothing.
    ///
    /// # Panics
    ///
    /// If there is not one target per sample.
    pub fn right_hand_side(&self, targets: &[f64]) -> Vec<f64> {
        assert_eq!(targets.len(), self.sample_count, "one target per sample");
        let mut rhs: Vec<f64> =
            targets.iter().zip(&self.weight_roots).map(|(y, root)| y * root).collect();
        rhs.resize(self.rows.row_count(), 0.0);
        rhs
    }

    /// What a solution gives for every sample.
    pub(crate) fn predict(&self, solution: &[f64]) -> Vec<f64> {
        let weighted = self.rows.rows().zip(&self.weight_roots);
        weighted
            .map(|(row, &root)| {
                let value: f64 = row.iter().map(|&(c, entry)| entry * solution[c as usize]).sum();
                // A sample of weight 0 left no trace in the system.
                if root > 0.0 { value / root } else { 0.0 }
            })
            .collect()
    }

    /// The texels of one factor from a solution; texels outside the mask are `None`.
    pub(crate) fn texels_of<'a>(
        &'a self,
        factor: usize,
        solution: &'a [f64],
    ) -> impl Iterator<Item = Option<f64>> + 'a {
        self.blocks[factor].unknown_of.iter().map(|unknown| unknown.map(|u| solution[u]))
    }
}

#[expect(clippy::cast_precision_loss, reason = "textures have at most a million texels")]
fn texel_count(factor: &Factor) -> f64 {
    factor.grid().texels() as f64
}

fn number_unknowns(factors: &[&Factor]) -> (Vec<Block>, Vec<(usize, usize)>) {
    let mut texel_of = Vec::new();
    let blocks = factors
        .iter()
        .enumerate()
        .map(|(index, factor)| {
            let number = |(texel, masked): (usize, bool)| {
                masked.then(|| {
                    texel_of.push((index, texel));
                    texel_of.len() - 1
                })
            };
            Block { unknown_of: factor.mask().into_iter().enumerate().map(number).collect() }
        })
        .collect();
    (blocks, texel_of)
}

/// For each masked texel, Σ over its masked neighbours of (neighbour − texel).
fn push_smoothing(rows: &mut SparseRows, factor: &Factor, block: &Block, weight: f64) {
    let strength = (weight / texel_count(factor)).sqrt();
    if strength <= 0.0 {
        return;
    }
    for (texel, unknown) in block.unknown_of.iter().enumerate() {
        let Some(unknown) = *unknown else { continue };
        let mut own = 0.0;
        for neighbour in factor.grid().neighbours(texel) {
            if let Some(other) = block.unknown_of[neighbour] {
                rows.push(other, strength);
                own -= strength;
            }
        }
        rows.push(unknown, own);
        rows.end_row();
    }
}
