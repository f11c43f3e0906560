//! What is fitted, what is held out, and what choices are made on.

use brdf_factor::Coordinate;
use brdf_factor::{
    CrossValidation, FactorError, FactorParams, FactorSpec, FactoredBrdf, Fit, LogTransform,
    TexelFormat, cross_validate,
};
use brdf_model::{
    Channels, FitErrors, PairSampling, SampleSet, ScrambledSobol, log_offsets, measure,
};
use brdf_param::Projection;

use crate::material::Material;
use crate::record::{FitSettingsRecord, StoredErrors, TermRecord};

/// Pairs of the held-out set of a material that can be drawn from.
pub const HELD_OUT_PAIRS: u32 = 20_000;
/// Parts that scattered rows are split into.
pub(crate) const FOLDS: usize = 10;

/// Training samples, before and after replication, and how errors on unseen ones are found.
pub(crate) struct Training {
    pub(crate) rows: SampleSet,
    pub(crate) fitted: SampleSet,
    /// Of log errors: those of uniform pairs, whatever is fitted beside them.
    offsets: Vec<f64>,
    held_out: HeldOut,
}

enum HeldOut {
    Drawn(SampleSet),
    Folds(CrossValidation),
}

/// Samples to search with, and to choose a family by.
pub(crate) struct SearchSamples {
    /// All that is fitted.
    pub(crate) fitted: SampleSet,
    /// What families are compared on, and what is fitted for that: neither is held out, nor do they
    /// overlap.
    pub(crate) choice: Option<Choice>,
}

pub(crate) struct Choice {
    pub(crate) fitted: SampleSet,
    pub(crate) unseen: SampleSet,
    /// The fitted samples are all there are, so that winners need not be searched again.
    pub(crate) is_complete: bool,
}

impl Training {
    pub(crate) fn new(
        material: &Material<'_>,
        channels: Channels,
        settings: &FitSettingsRecord,
    ) -> Self {
        let theta_max = settings.params.theta_max;
        if let Some(rows) = material.samples() {
            let rows = match channels {
                Channels::Luminance => rows.to_luminance(),
                Channels::Rgb => rows.clone(),
            }
            .within(theta_max);
            let rows = fit_for(settings.params.log_map, rows);
            let folds = CrossValidation {
                folds: FOLDS,
                rotations: settings.replicate,
                // Twins would repeat the equations that shared textures already make.
                reciprocal: false,
                seed: settings.seed,
                format: TexelFormat::F32,
            };
            let fitted = rows.replicated(folds.rotations, folds.reciprocal);
            let offsets = log_offsets(&fitted);
            return Self { rows, fitted, offsets, held_out: HeldOut::Folds(folds) };
        }
        let sampling = PairSampling { count: settings.samples, seed: settings.seed, theta_max };
        let (rows, offsets) = mixed(material, channels, &sampling, settings.highlight);
        let rows = fit_for(settings.params.log_map, rows);
        let fitted = rows.replicated(settings.replicate, false);
        let seed = ScrambledSobol::held_out_seed(settings.seed);
        let held_out = HeldOut::Drawn(drawn(material, channels, seed, theta_max));
        Self { rows, fitted, offsets, held_out }
    }

    /// Samples for a search: measured rows in random order, so that a part of them is fair, and a
    /// part set aside where there are several families to choose among.
    pub(crate) fn for_search(
        &self,
        material: &Material<'_>,
        channels: Channels,
        settings: &FitSettingsRecord,
        families: usize,
    ) -> SearchSamples {
        // No more copies of rows than there would be drawn pairs: planes do not need them.
        let fair = |rows: SampleSet| rows.shuffled(settings.seed).subset(settings.samples as usize);
        let fitted = match &self.held_out {
            HeldOut::Drawn(_) => self.fitted.clone(),
            HeldOut::Folds(_) => fair(self.fitted.clone()),
        };
        let seed = ScrambledSobol::validation_seed(settings.seed);
        let choice = (families > 1).then(|| match &self.held_out {
            HeldOut::Drawn(_) => {
                let unseen = drawn(material, channels, seed, settings.params.theta_max);
                Choice { fitted: fitted.clone(), unseen, is_complete: true }
            }
            HeldOut::Folds(folds) => {
                let aside = self.rows.folds(FOLDS, seed).swap_remove(0);
                let rest: Vec<usize> =
                    (0..self.rows.len()).filter(|i| aside.binary_search(i).is_err()).collect();
                let rest = self.rows.select(&rest).replicated(folds.rotations, folds.reciprocal);
                let unseen = self.rows.select(&aside);
                Choice { fitted: fair(rest), unseen, is_complete: false }
            }
        });
        SearchSamples { fitted, choice }
    }

    /// The errors of a fit, and those of its model with texels as they are stored.
    pub(crate) fn record(
        &self,
        fit: &Fit,
        stored: &FactoredBrdf,
        specs: &[FactorSpec],
        settings: &FitSettingsRecord,
    ) -> Result<TermRecord, FactorError> {
        let held_out = |model, format| self.held_out(model, specs, &settings.params, format);
        let stored = if settings.texels.is_f32() {
            None
        } else {
            Some(Box::new(StoredErrors {
                training: measure(&self.rows, stored, &self.offsets),
                held_out: held_out(stored, settings.texels)?,
            }))
        };
        Ok(TermRecord {
            textures: fit.model.factors().len(),
            family: None,
            projections: projections(specs),
            // Rotated copies of a row repeat its error but for the texel grid; the rows suffice.
            training: measure(&self.rows, &fit.model, &self.offsets),
            held_out: held_out(&fit.model, TexelFormat::F32)?,
            stored,
        })
    }

    /// The errors of a model, or of models fitted to folds, on what was not fitted.
    fn held_out(
        &self,
        model: &FactoredBrdf,
        specs: &[FactorSpec],
        params: &FactorParams,
        format: TexelFormat,
    ) -> Result<Option<FitErrors>, FactorError> {
        match &self.held_out {
            HeldOut::Drawn(unseen) => {
                Ok((!unseen.is_empty()).then(|| measure(unseen, model, &self.offsets)))
            }
            HeldOut::Folds(folds) => {
                let folds = CrossValidation { format, ..*folds };
                cross_validate(&self.rows, specs, params, &folds)
            }
        }
    }
}

/// Pairs of which a share lies around the mirror direction, and the log offsets of the others, which are uniform.
fn mixed(
    material: &Material<'_>,
    channels: Channels,
    sampling: &PairSampling,
    highlight: f64,
) -> (SampleSet, Vec<f64>) {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a share of a count, from 0 to the count"
    )]
    let around = (highlight.clamp(0.0, 1.0) * f64::from(sampling.count)) as u32;
    let uniform = PairSampling { count: sampling.count - around, ..*sampling };
    let mut rows = SampleSet::draw(material.brdf(), &uniform, channels);
    let offsets = log_offsets(&rows);
    if around > 0 {
        // Some half vectors leave a direction beyond the limit, and are passed over.
        let more = PairSampling { count: around.saturating_mul(4), ..*sampling };
        let known = more.highlight_pairs().filter(|pair| material.brdf().has_data(pair));
        for pair in known.take(around as usize) {
            rows.push_clamped(&pair, material.brdf().eval_unclamped(&pair));
        }
    }
    (rows, offsets)
}

/// [`HELD_OUT_PAIRS`] pairs of a scramble.
pub(crate) fn drawn(
    material: &Material<'_>,
    channels: Channels,
    seed: u64,
    theta_max: f64,
) -> SampleSet {
    let sampling = PairSampling { count: HELD_OUT_PAIRS, seed, theta_max };
    SampleSet::draw(material.brdf(), &sampling, channels)
}

/// The projection of each factor that has one.
fn projections(specs: &[FactorSpec]) -> Vec<Projection> {
    let first = specs.iter().filter_map(|spec| spec.coordinates.first());
    first
        .filter_map(|coordinate| match coordinate {
            Coordinate::Projected { projection, .. } => Some(*projection),
            _ => None,
        })
        .collect()
}

/// The rows that a log map can take: dropped before they are copied, so that rows are counted and
/// not copies, and so that training errors are of what was fitted.
fn fit_for(log_map: LogTransform, rows: SampleSet) -> SampleSet {
    match log_map {
        LogTransform::Log => rows.positive(),
        LogTransform::Offset | LogTransform::Highlight => rows,
    }
}
