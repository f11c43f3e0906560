//! The errors of a model's leading terms, for every number of them.

use brdf_model::{Brdf, cosine_rms_pairs};

use crate::SeparableBrdf;

/// The cosine-weighted RMS errors of a model cut after a term, in sr⁻¹, as in [`brdf_model::cosine_rms`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RankCosineRms {
    /// Error over whole hemispheres.
    pub absolute: f64,
    /// Error over pairs with both directions within 80° of the normal.
    pub within_80: f64,
}

/// Returns the errors of the first 1, 2, … terms of a model over the pairs of a seed, in one pass.
///
/// Errors are over RGB, with f̂ clamped at 0. The reference must have data everywhere.
///
/// Source: Wang, Tran and Luebke 2004, figure 4.
pub fn cosine_rms_by_rank(
    reference: &dyn Brdf,
    model: &SeparableBrdf,
    seed: u64,
) -> Vec<RankCosineRms> {
    let limit = 80_f64.to_radians().cos();
    let mut sums = vec![RankCosineRms::default(); model.rank()];
    let (mut all, mut near) = (0.0_f64, 0.0_f64);
    for pair in cosine_rms_pairs(seed) {
        let exact = reference.eval(&pair);
        let is_near = pair.wi.z.min(pair.wo.z) >= limit;
        model.partial_sums(&pair, |rank, value| {
            let miss = exact - value.map(|v| v.max(0.0));
            let square = miss.channels().iter().map(|v| v * v).sum::<f64>() / 3.0;
            let sum = &mut sums[rank - 1];
            sum.absolute += pair.wi.z * square;
            sum.within_80 += if is_near { pair.wi.z * square } else { 0.0 };
        });
        all += 1.0;
        near += f64::from(u8::from(is_near));
    }
    sums.into_iter()
        .map(|sum| RankCosineRms {
            absolute: (sum.absolute / all).sqrt(),
            within_80: (sum.within_80 / near.max(1.0)).sqrt(),
        })
        .collect()
}
