//! From a material to fitted models with their errors: what `factor` does between reading and
//! reporting.

use std::time::Instant;

use brdf_factor::{
    Coordinate, CrossValidation, FactorError, FactorParams, FactorSpec, Fit, Inversion,
    LogTransform, Plan, Preinverted, Problem, TermSolve, cross_validate, factorize,
    factorize_terms,
};
use brdf_io::{BasisFile, FitSettings, TermRecord};
use brdf_model::{
    Channels, FitErrors, PairSampling, SampleSet, ScrambledSobol, largest_albedo, log_offsets,
    measure,
};
use brdf_param::Projection;
use brdf_search::SearchError;
use rayon::prelude::*;
use serde::Serialize;

use crate::pictures::Grey;
use crate::progress::Progress;
use crate::searching::{Choice, Found, SearchPlan, SearchSamples};
use crate::subject::Subject;

/// Pairs of the held-out set of a material that can be drawn from.
pub(crate) const HELD_OUT_PAIRS: u32 = 20_000;
/// Parts that scattered rows are split into.
const FOLDS: usize = 10;

/// How much light leaves at most, of what arrives.
#[derive(Clone, Copy, Serialize)]
pub(crate) struct Albedo {
    /// Of the material; none where it has holes that only interpolation fills.
    pub(crate) reference: Option<f64>,
    /// Of the model with the most terms.
    pub(crate) model: f64,
}

/// The factors that a method asks for.
pub(crate) enum Method {
    /// All factors make one model.
    Together(Vec<FactorSpec>),
    /// Every leading part of the list is a model.
    Terms(Vec<FactorSpec>),
    /// A search finds a model for every number of terms.
    Search(SearchPlan),
    /// The matrix was inverted before.
    With(Box<BasisFile>),
}

/// Models by number of terms, their errors, and McCool's beside them.
pub(crate) struct Outcome {
    pub(crate) fits: Vec<Fit>,
    pub(crate) terms: Vec<TermRecord>,
    pub(crate) baseline: TermRecord,
    /// Linear least-squares problems that were solved for the terms, the search included.
    pub(crate) evaluations: usize,
    /// How the projections were found, if they were searched.
    pub(crate) found: Option<Found>,
    /// Of the fit and the search.
    pub(crate) seconds: f64,
    /// Rows or drawn pairs that were fitted, before they were copied.
    pub(crate) rows: usize,
    /// Largest directional albedos within the grazing limit.
    pub(crate) albedo: Albedo,
    /// Share of the domain that has scattered rows nearby; none for materials drawn from.
    pub(crate) scattered_coverage: Option<f64>,
}

impl Outcome {
    /// The fit with the most terms.
    pub(crate) fn last(&self) -> &Fit {
        // `run` makes at least one.
        &self.fits[self.fits.len() - 1]
    }
}

/// Training samples, before and after replication, and how errors on unseen ones are found.
struct Training {
    rows: SampleSet,
    fitted: SampleSet,
    held_out: HeldOut,
}

enum HeldOut {
    Drawn(SampleSet),
    Folds(CrossValidation),
}

pub(crate) fn run(
    subject: &Subject,
    channels: Channels,
    method: &Method,
    settings: &FitSettings,
    progress: &Progress,
) -> Result<Outcome, SearchError> {
    progress.step("drawing samples");
    let training = Training::new(subject, channels, settings);
    if training.fitted.is_empty() {
        let dropped = training.fitted.dropped().to_string();
        return Err(FactorError::NoSamples { dropped }.into());
    }
    progress.done(1);

    let start = Instant::now();
    let found = match method {
        Method::Search(plan) => {
            let samples = training.for_search(subject, channels, settings, plan.families.len());
            Some(plan.run(&samples, &settings.params, progress)?)
        }
        Method::Together(_) | Method::Terms(_) | Method::With(_) => None,
    };
    progress.step("fitting");
    let models = match (method, &found) {
        (Method::Together(specs), _) => vec![specs.clone()],
        (Method::Terms(specs), _) => (1..=specs.len()).map(|n| specs[..n].to_vec()).collect(),
        (Method::Search(_), Some(found)) => {
            found.outcome.terms.iter().map(|t| found.family.specs(&t.projections)).collect()
        }
        (Method::Search(_), None) => Vec::new(),
        (Method::With(basis), _) => {
            vec![basis.record.plan.factors.iter().map(|(spec, _)| spec.clone()).collect()]
        }
    };
    let fits = match method {
        Method::With(basis) => {
            let BasisFile { inverse, record } = &**basis;
            let problem = Problem::new(&training.fitted, &settings.params)?;
            let (plan, inverse) = (record.plan.clone(), inverse.clone());
            vec![Preinverted::restore(&problem, &[], plan, inverse, &record.key)?.fit(&problem)?]
        }
        _ => fit_models(&training.fitted, &models, &settings.params)?,
    };
    let seconds = start.elapsed().as_secs_f64();
    progress.done(2);

    progress.step("measuring");
    let terms: Result<Vec<TermRecord>, FactorError> = fits
        .par_iter()
        .zip(&models)
        .map(|(fit, specs)| training.record(fit, specs, &settings.params))
        .collect();
    let terms = terms?;
    progress.done(2);

    progress.step("fitting McCool's baseline");
    let reciprocal = found.as_ref().map_or(settings.reciprocal, |found| found.family.reciprocal);
    let mccool = FactorSpec::mccool(reciprocal);
    let baseline = match method {
        Method::Together(specs) if *specs == mccool => terms[0].clone(),
        _ => {
            let fit = factorize(&training.fitted, &mccool, &settings.params)?;
            training.record(&fit, &mccool, &settings.params)?
        }
    };
    progress.done(2);
    let model = &fits[fits.len() - 1].model;
    let theta_max = model.theta_max();
    let reference = Grey::unless(channels == Channels::Rgb, subject.brdf());
    let albedo = Albedo {
        reference: subject
            .samples()
            .is_none()
            .then(|| largest_albedo(reference.as_brdf(), theta_max).0),
        model: largest_albedo(model, theta_max).0,
    };
    let rows = training.rows.len();
    let scattered_coverage = subject.samples().map(|_| coverage(subject, settings));
    let searched = found.as_ref().map_or(0, |f| f.tried.iter().map(|t| t.evaluations).sum());
    let evaluations = searched + fits.len();
    Ok(Outcome {
        fits,
        terms,
        baseline,
        evaluations,
        found,
        seconds,
        rows,
        albedo,
        scattered_coverage,
    })
}

/// The inverted matrix of a material's samples, for others at the same places.
pub(crate) fn preinvert(
    subject: &Subject,
    channels: Channels,
    specs: &[FactorSpec],
    settings: &FitSettings,
    inversion: Inversion,
) -> Result<Preinverted, FactorError> {
    let training = Training::new(subject, channels, settings);
    let problem = Problem::new(&training.fitted, &settings.params)?;
    let plan = Plan::of(specs, settings.params.texture_size);
    Preinverted::new(&problem, &[], plan, inversion)
}

/// The textures of every model: each on its own, or each with the textures that the one before
/// leaves it.
fn fit_models(
    samples: &SampleSet,
    models: &[Vec<FactorSpec>],
    params: &FactorParams,
) -> Result<Vec<Fit>, FactorError> {
    match (params.terms, models.last()) {
        (TermSolve::Last(_), Some(largest)) => {
            let mut fits = factorize_terms(samples, largest, params)?;
            Ok(fits.split_off(models[0].len() - 1))
        }
        _ => models.iter().map(|specs| factorize(samples, specs, params)).collect(),
    }
}

impl Training {
    fn new(subject: &Subject, channels: Channels, settings: &FitSettings) -> Self {
        let theta_max = settings.params.theta_max;
        if let Some(rows) = subject.samples() {
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
            };
            let fitted = rows.replicated(folds.rotations, folds.reciprocal);
            return Self { rows, fitted, held_out: HeldOut::Folds(folds) };
        }
        let sampling = PairSampling { count: settings.samples, seed: settings.seed, theta_max };
        let rows = SampleSet::draw(subject.brdf(), &sampling, channels);
        let rows = fit_for(settings.params.log_map, rows);
        let fitted = rows.replicated(settings.replicate, false);
        let unseen = PairSampling {
            count: HELD_OUT_PAIRS,
            seed: ScrambledSobol::held_out_seed(settings.seed),
            theta_max,
        };
        let held_out = HeldOut::Drawn(SampleSet::draw(subject.brdf(), &unseen, channels));
        Self { rows, fitted, held_out }
    }

    /// Samples for a search: measured rows in random order, so that a part of them is fair, and a
    /// part set aside where there are several families to choose among.
    fn for_search(
        &self,
        subject: &Subject,
        channels: Channels,
        settings: &FitSettings,
        families: usize,
    ) -> SearchSamples {
        // No more copies of rows than there would be drawn pairs: planes do not need them.
        let fair = |rows: SampleSet| rows.shuffled(settings.seed).subset(settings.samples as usize);
        let fitted = match &self.held_out {
            HeldOut::Drawn(_) => self.fitted.clone(),
            HeldOut::Folds(_) => fair(self.fitted.clone()),
        };
        let choice = (families > 1).then(|| match &self.held_out {
            HeldOut::Drawn(_) => {
                let sampling = PairSampling {
                    count: HELD_OUT_PAIRS,
                    seed: ScrambledSobol::validation_seed(settings.seed),
                    theta_max: settings.params.theta_max,
                };
                let unseen = SampleSet::draw(subject.brdf(), &sampling, channels);
                Choice { fitted: fitted.clone(), unseen, is_complete: true }
            }
            HeldOut::Folds(folds) => {
                let seed = ScrambledSobol::validation_seed(settings.seed);
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

    fn record(
        &self,
        fit: &Fit,
        specs: &[FactorSpec],
        params: &FactorParams,
    ) -> Result<TermRecord, FactorError> {
        let offsets = log_offsets(&self.fitted);
        let held_out: Option<FitErrors> = match &self.held_out {
            HeldOut::Drawn(unseen) => {
                (!unseen.is_empty()).then(|| measure(unseen, &fit.model, &offsets))
            }
            HeldOut::Folds(folds) => cross_validate(&self.rows, specs, params, folds)?,
        };
        Ok(TermRecord {
            textures: fit.model.factors().len(),
            projections: projections(specs),
            // Rotated copies of a row repeat its error but for the texel grid; the rows suffice.
            training: measure(&self.rows, &fit.model, &offsets),
            held_out,
        })
    }
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

/// Share of direction pairs within the grazing limit that have a row nearby.
fn coverage(subject: &Subject, settings: &FitSettings) -> f64 {
    let sampling = PairSampling { count: 4_000, seed: 1, theta_max: settings.params.theta_max };
    let covered = sampling.pairs().filter(|pair| subject.brdf().has_data(pair)).count();
    let share = covered as f64 / f64::from(sampling.count);
    share
}
