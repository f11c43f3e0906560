//! What choices between models are made by.

use brdf_model::{
    Brdf, Channels, FidelityPairs, FidelityReference, SampleSet, ScrambledSobol, log_offsets,
    measure,
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

/// What models of scattered rows are compared by, over rows that they were not fitted to:
/// [`brdf_model::FidelityErrors::score`].
pub(crate) fn error_on(unseen: &SampleSet, fitted: &SampleSet, model: &dyn Brdf) -> f64 {
    measure(unseen, model, &log_offsets(fitted)).fidelity.score()
}
