//! Models judged by one reference.

use std::time::Instant;

use brdf_image::{Film, ToneMap, image_errors};
use brdf_job::Job;
use brdf_model::{
    Brdf, Channels, CosineRms, DirectionBatch, Dropped, PairSampling, RgbBatch, SampleSet,
    cosine_rms, log_offsets, measure, perceptual_errors,
};
use brdf_render::{
    DirectionalLight, Environment, EnvironmentError, Light, SphereView, render_sphere,
};
use serde::{Deserialize, Serialize};

use crate::error::FitError;
use crate::material::Material;
use crate::measures::{ModelMeasures, PictureMeasures};

/// A model to judge.
#[derive(Clone)]
pub struct Candidate<'a> {
    /// What the user calls it.
    pub label: String,
    /// The model.
    pub brdf: &'a dyn Brdf,
    /// Bytes that it takes.
    pub bytes: usize,
}

impl std::fmt::Debug for Candidate<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Candidate").field("label", &self.label).finish_non_exhaustive()
    }
}

/// How models are judged.
#[derive(Clone, Debug, PartialEq)]
pub struct CompareSettings {
    /// Pairs to draw; a scattered reference gives its own rows.
    pub samples: u32,
    /// Which scramble of the sequence; fits take 1.
    pub seed: u64,
    /// Largest angle between a direction and the normal, radians.
    pub theta_max: f64,
    /// Channels to compare; none for those that the reference has.
    pub channels: Option<Channels>,
    /// Lights under which spheres are compared, by name; none for measures on pairs alone.
    pub lights: Vec<(String, Light)>,
    /// Whether evaluations are timed.
    pub timed: bool,
}

impl Default for CompareSettings {
    fn default() -> Self {
        Self {
            samples: 45_000,
            seed: 2,
            theta_max: 80_f64.to_radians(),
            channels: None,
            lights: Vec::new(),
            timed: false,
        }
    }
}

/// Returns the lights that measures on spheres are usually taken under: two built-in environments, which mean the
/// same on every machine, and one directional light. Others may stand for the environments.
///
/// # Errors
///
/// [`EnvironmentError`] never, but its constructor checks its texels.
pub fn metric_lights(
    environments: Option<Vec<(String, Environment)>>,
) -> Result<Vec<(String, Light)>, EnvironmentError> {
    let environments = match environments {
        Some(given) => given,
        None => vec![
            ("sky".to_owned(), Environment::sky()?),
            ("studio".to_owned(), Environment::studio()?),
        ],
    };
    let mut lights: Vec<(String, Light)> = environments
        .into_iter()
        .map(|(name, environment)| (name, Light::Environment(environment)))
        .collect();
    lights.push(("point".to_owned(), Light::Directional(DirectionalLight::default())));
    Ok(lights)
}

/// Models beside their reference.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Comparison {
    /// The reference, as it was given.
    pub reference: String,
    /// Pairs that were compared.
    pub samples: usize,
    /// Pairs left out, by reason.
    pub dropped: Dropped,
    /// Samples of the reference with a negative channel that was set to 0.
    pub clamped: usize,
    /// Which scramble of the sequence.
    pub seed: u64,
    /// One for each model, in order.
    pub results: Vec<ModelMeasures>,
}

/// Light samples a pixel: both pictures have the same noise, which mostly cancels.
const VIEW: SphereView = SphereView { size: 256, samples: 30 };
/// Evaluations are timed this often; the shortest counts.
const TIMINGS: u32 = 3;

/// Judges models by a reference, on pairs and, if there are lights, on spheres.
///
/// # Errors
///
/// [`FitError::NothingToCompare`] for a reference without usable samples; [`FitError::Stopped`].
pub fn compare(
    reference: &Material<'_>,
    candidates: &[Candidate<'_>],
    settings: &CompareSettings,
    job: &Job<'_>,
) -> Result<Comparison, FitError> {
    let channels = settings.channels.unwrap_or(reference.channels());
    let sampling = PairSampling {
        count: settings.samples,
        seed: settings.seed,
        theta_max: settings.theta_max,
    };
    let samples = reference.draw(&sampling, channels);
    if samples.is_empty() {
        return Err(FitError::NothingToCompare {
            name: reference.name().to_owned(),
            dropped: samples.dropped().to_string(),
        });
    }
    job.begin("rendering the reference", candidates.len() as u64 + 1);
    let evaluator = Evaluator::new(reference, &samples, channels, settings);
    job.advance(1);
    let results = candidates.iter().map(|candidate| {
        job.check()?;
        job.rename(format!("comparing {}", candidate.label));
        let row = evaluator.judge(candidate);
        job.advance(1);
        Ok(row)
    });
    Ok(Comparison {
        results: results.collect::<Result<_, FitError>>()?,
        reference: reference.name().to_owned(),
        samples: samples.len(),
        dropped: samples.dropped(),
        clamped: samples.clamped(),
        seed: settings.seed,
    })
}

/// A reference, and what is needed to judge models by it.
struct Evaluator<'a> {
    reference: &'a Material<'a>,
    samples: &'a SampleSet,
    offsets: Vec<f64>,
    channels: Channels,
    settings: &'a CompareSettings,
    scenes: Vec<Scene<'a>>,
}

/// The reference under one light.
struct Scene<'a> {
    name: &'a str,
    light: &'a Light,
    film: Film,
    exposure: f64,
}

impl<'a> Evaluator<'a> {
    fn new(
        reference: &'a Material<'a>,
        samples: &'a SampleSet,
        channels: Channels,
        settings: &'a CompareSettings,
    ) -> Self {
        let scenes = settings.lights.iter().map(|(name, light)| {
            let film = render_sphere(channels.of(reference.brdf()).as_ref(), light, &VIEW);
            let exposure = ToneMap::exposed_for(&film).exposure;
            Scene { name, light, film, exposure }
        });
        Self {
            scenes: scenes.collect(),
            reference,
            samples,
            offsets: log_offsets(samples),
            channels,
            settings,
        }
    }

    fn judge(&self, candidate: &Candidate<'_>) -> ModelMeasures {
        let model = candidate.brdf;
        let shared = self.samples.with_data_in(model);
        let errors = measure(&shared, model, &self.offsets);
        let rms: Option<CosineRms> =
            self.reference.samples().is_none().then(|| {
                cosine_rms(self.reference.brdf(), model, self.channels, self.settings.seed)
            });
        let shown = self.channels.of(model);
        let pictures = self.scenes.iter().map(|scene| PictureMeasures {
            light: scene.name.to_owned(),
            errors: image_errors(
                &scene.film,
                &render_sphere(shown.as_ref(), scene.light, &VIEW),
                scene.exposure,
            ),
        });
        ModelMeasures {
            model: candidate.label.clone(),
            bytes: candidate.bytes,
            without_data: self.samples.len() - shared.len(),
            without_logarithm: errors.without_logarithm,
            log: errors.log,
            linear: errors.linear,
            perceptual: perceptual_errors(&shared, model),
            cosine_rms: rms.map(|r| r.absolute),
            cosine_rms_relative: rms.map(|r| r.relative),
            cosine_rms_both: rms.map(|r| r.both_cosines),
            cosine_rms_within_80: rms.map(|r| r.within_80),
            cosine_rms_without_data: rms.map(|r| r.without_data),
            pictures: pictures.collect(),
            ms_per_million: self.settings.timed.then(|| self.time(model)),
        }
    }

    /// Milliseconds for a million evaluations.
    fn time(&self, model: &dyn Brdf) -> f64 {
        let pairs: Vec<_> = self.samples.pairs().collect();
        let batch: DirectionBatch = pairs.iter().collect();
        let mut values = RgbBatch::default();
        let shortest = (0..TIMINGS)
            .map(|_| {
                let start = Instant::now();
                model.eval_batch(batch.as_slices(), &mut values);
                start.elapsed().as_secs_f64()
            })
            .fold(f64::INFINITY, f64::min);
        1e9 * shortest / batch.len() as f64
    }
}
