//! Cross-validation: held-out errors of measured rows, where no more data can be drawn.

use brdf_model::{Brdf, FitErrors, Rgb, SampleSet, log_offsets, measure_folds};
use rayon::prelude::*;

use crate::{
    FactorError, FactorParams, FactorSpec, Fit, TermSolve, TexelFormat, factorize, factorize_terms,
};

/// The options of a cross-validation: how rows are split, and how training rows are replicated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CrossValidation {
    /// Number of parts; each is held out once.
    pub folds: usize,
    /// Number of copies of every training row by rotation about the normal.
    pub rotations: u32,
    /// Whether training rows get reciprocal twins.
    pub reciprocal: bool,
    /// Seed of the split.
    pub seed: u64,
    /// How the texels of the models are stored when they are judged.
    pub format: TexelFormat,
}

/// Returns the errors on rows that were not fitted, pooled over the folds.
///
/// Rows are split before any replication, and rows that an isotropic reciprocal material could not
/// tell apart stay together. The log offset is that of the training rows of each fold. The
/// result is `None` where there are too few rows for every fold to hold out one.
///
/// # Errors
///
/// As [`factorize`].
pub fn cross_validate(
    samples: &SampleSet,
    specs: &[FactorSpec],
    params: &FactorParams,
    validation: &CrossValidation,
) -> Result<Option<FitErrors>, FactorError> {
    let parts = samples.folds(validation.folds.max(2), validation.seed);
    if parts.iter().any(Vec::is_empty) {
        return Ok(None);
    }
    let values: Result<Vec<Vec<Rgb>>, FactorError> = parts
        .par_iter()
        .map(|held_out| {
            let rest: Vec<usize> =
                (0..samples.len()).filter(|i| held_out.binary_search(i).is_err()).collect();
            let training =
                samples.select(&rest).replicated(validation.rotations, validation.reciprocal);
            let fit = match params.terms {
                TermSolve::All => factorize(&training, specs, params)?,
                TermSolve::Last(_) => last_term(&training, specs, params)?,
            };
            let model = fit.model.stored_as(validation.format)?;
            Ok(held_out.iter().map(|&index| model.eval_unclamped(&samples.pair(index))).collect())
        })
        .collect();
    Ok(Some(measure_folds(samples, &parts, &values?, &log_offsets(samples))))
}

/// The model with all terms, each added to the ones before as [`TermSolve::Last`] says.
fn last_term(
    training: &SampleSet,
    specs: &[FactorSpec],
    params: &FactorParams,
) -> Result<Fit, FactorError> {
    factorize_terms(training, specs, params)?.pop().ok_or_else(|| FactorError::Factors {
        found: "no factors".to_owned(),
        expected: "at least one",
    })
}
