//! What choices between models are made by.

use brdf_model::{
    Brdf, Channels, FidelityPairs, FidelityReference, FitErrors, SampleSet, ScrambledSobol,
    log_offsets, measure,
};

use crate::material::Material;

/// What models of a material that can be drawn from are compared by: [`brdf_model::Fidelity::score`] over validation
/// pairs, which are neither fitted nor held out.
pub(crate) struct Judge {
    reference: FidelityReference,
}

impl Judge {
    pub(crate) fn new(
        material: &Material<'_>,
        channels: Channels,
        seed: u64,
        theta_max: f64,
    ) -> Self {
        let pairs = FidelityPairs::new(ScrambledSobol::validation_seed(seed), theta_max);
        let reference = channels.of(material.brdf());
        Self { reference: FidelityReference::new(&pairs, &*reference) }
    }

    pub(crate) fn error(&self, model: &dyn Brdf) -> f64 {
        self.reference.measure(model).score()
    }
}

/// What models of scattered rows are compared by: the geometric mean of log and linear error, root mean squares.
/// Relative to each other, linear ones need no unit.
pub(crate) fn row_error(errors: &FitErrors) -> f64 {
    (errors.log.mean_square * errors.linear.mean_square).powf(0.25)
}

/// [`row_error`] of a model over rows that it was not fitted to.
pub(crate) fn error_on(unseen: &SampleSet, fitted: &SampleSet, model: &dyn Brdf) -> f64 {
    row_error(&measure(unseen, model, &log_offsets(fitted)))
}
