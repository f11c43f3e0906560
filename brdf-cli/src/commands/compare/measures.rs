//! Everything that one model is judged by.

use std::time::Instant;

use brdf_image::{Film, ImageErrors, ToneMap, image_errors};
use brdf_model::{
    Channels, CosineRms, DirectionBatch, ErrorMeasures, PerceptualErrors, RgbBatch, SampleSet,
    cosine_rms, measure, perceptual_errors,
};
use brdf_render::{Light, SphereView, render_sphere};
use serde::Serialize;

use crate::pictures::Grey;
use crate::subject::Subject;

/// A model's figures.
#[derive(Clone, Serialize)]
pub(super) struct Row {
    pub(super) model: String,
    pub(super) bytes: usize,
    /// Pairs that the model has no data for; they are left out of its errors.
    pub(super) without_data: usize,
    /// Log residuals for which a + f̂ was not positive and f̂ = 0 stood in.
    pub(super) without_logarithm: usize,
    pub(super) log: ErrorMeasures,
    pub(super) linear: ErrorMeasures,
    #[serde(flatten)]
    pub(super) perceptual: PerceptualErrors,
    /// sr⁻¹; null where the reference cannot be evaluated everywhere.
    pub(super) cosine_rms: Option<f64>,
    /// The same over the reference's own cosine-weighted RMS.
    pub(super) cosine_rms_relative: Option<f64>,
    /// Weighted with both cosines, sr⁻¹.
    pub(super) cosine_rms_both: Option<f64>,
    /// Over pairs within 80° of the normal, sr⁻¹.
    pub(super) cosine_rms_within_80: Option<f64>,
    /// Pairs of the cosine-weighted RMS for which the reference or the model has no data.
    cosine_rms_without_data: Option<usize>,
    /// Milliseconds for a million evaluations in batches on one thread.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) ms_per_million: Option<f64>,
    /// On spheres; the light of each is named.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) pictures: Vec<PictureRow>,
}

/// Measures on spheres under one light.
#[derive(Clone, Serialize)]
pub(super) struct PictureRow {
    pub(super) light: String,
    #[serde(flatten)]
    pub(super) errors: ImageErrors,
}

/// A reference, and what is needed to judge models by it.
pub(super) struct Evaluator<'a> {
    reference: &'a Subject,
    samples: &'a SampleSet,
    offsets: &'a [f64],
    channels: Channels,
    seed: u64,
    scenes: Vec<Scene>,
    timed: bool,
}

/// The reference under one light.
struct Scene {
    name: String,
    light: Light,
    film: Film,
    exposure: f64,
}

/// Light samples a pixel: both pictures have the same noise, which mostly cancels.
const VIEW: SphereView = SphereView { size: 256, samples: 30 };
/// Evaluations are timed this often; the shortest counts.
const TIMINGS: u32 = 3;

impl<'a> Evaluator<'a> {
    pub(super) fn new(
        reference: &'a Subject,
        samples: &'a SampleSet,
        offsets: &'a [f64],
        channels: Channels,
        seed: u64,
    ) -> Self {
        Self { reference, samples, offsets, channels, seed, scenes: Vec::new(), timed: false }
    }

    /// Adds measures on spheres under these lights, and times.
    pub(super) fn with_pictures(mut self, lights: Vec<(String, Light)>) -> Self {
        self.timed = true;
        self.scenes = lights
            .into_iter()
            .map(|(name, light)| {
                let film = self.render(self.reference, &light);
                let exposure = ToneMap::exposed_for(&film).exposure;
                Scene { name, light, film, exposure }
            })
            .collect();
        self
    }

    fn render(&self, subject: &Subject, light: &Light) -> Film {
        let in_colour = self.channels == Channels::Rgb;
        render_sphere(Grey::unless(in_colour, subject.brdf()).as_brdf(), light, &VIEW)
    }

    pub(super) fn judge(&self, model: &Subject) -> Row {
        let shared = self.samples.with_data_in(model.brdf());
        let errors = measure(&shared, model.brdf(), self.offsets);
        let rms: Option<CosineRms> = self
            .reference
            .samples()
            .is_none()
            .then(|| cosine_rms(self.reference.brdf(), model.brdf(), self.channels, self.seed));
        let pictures = self
            .scenes
            .iter()
            .map(|scene| PictureRow {
                light: scene.name.clone(),
                errors: image_errors(
                    &scene.film,
                    &self.render(model, &scene.light),
                    scene.exposure,
                ),
            })
            .collect();
        Row {
            model: model.argument.clone(),
            bytes: model.bytes(),
            without_data: self.samples.len() - shared.len(),
            without_logarithm: errors.without_logarithm,
            log: errors.log,
            linear: errors.linear,
            perceptual: perceptual_errors(&shared, model.brdf()),
            cosine_rms: rms.map(|r| r.absolute),
            cosine_rms_relative: rms.map(|r| r.relative),
            cosine_rms_both: rms.map(|r| r.both_cosines),
            cosine_rms_within_80: rms.map(|r| r.within_80),
            cosine_rms_without_data: rms.map(|r| r.without_data),
            ms_per_million: self.timed.then(|| self.time(model)),
            pictures,
        }
    }

    /// Milliseconds for a million evaluations.
    fn time(&self, model: &Subject) -> f64 {
        let pairs: Vec<_> = self.samples.pairs().collect();
        let batch: DirectionBatch = pairs.iter().collect();
        let mut values = RgbBatch::default();
        let shortest = (0..TIMINGS)
            .map(|_| {
                let start = Instant::now();
                model.brdf().eval_batch(&batch, &mut values);
                start.elapsed().as_secs_f64()
            })
            .fold(f64::INFINITY, f64::min);
        let count = batch.len() as f64;
        1e9 * shortest / count
    }
}

/// A measure by name, for tables and distributions; larger is worse but where said.
pub(super) struct Measure {
    pub(super) name: String,
    /// For pictures: which light.
    pub(super) larger_is_better: bool,
    pub(super) value: Option<f64>,
}

impl Row {
    /// Every measure, in the order and by the names of the JSON.
    pub(super) fn measures(&self) -> Vec<Measure> {
        let mut all = Vec::new();
        let mut add = |name: &str, value: Option<f64>| {
            let larger_is_better = name.starts_with("psnr_db") || name.starts_with("ssim");
            all.push(Measure { name: name.to_owned(), larger_is_better, value });
        };
        add("bytes", Some(self.bytes as f64));
        add("ms_per_million", self.ms_per_million);
        for (kind, errors) in [("log", &self.log), ("linear", &self.linear)] {
            add(&format!("{kind}.mean_abs"), Some(errors.mean_abs));
            add(&format!("{kind}.mean_square"), Some(errors.mean_square));
            add(&format!("{kind}.max"), Some(errors.max));
        }
        add("log_cosine_rms", Some(self.perceptual.log_cosine_rms));
        add("cube_root_rms", Some(self.perceptual.cube_root_rms));
        add("log_relative_rms", Some(self.perceptual.log_relative_rms));
        add("cosine_rms", self.cosine_rms);
        add("cosine_rms_relative", self.cosine_rms_relative);
        add("cosine_rms_both", self.cosine_rms_both);
        add("cosine_rms_within_80", self.cosine_rms_within_80);
        for PictureRow { light, errors } in &self.pictures {
            add(&format!("psnr_db ({light})"), errors.psnr_db);
            add(&format!("ssim ({light})"), Some(errors.ssim));
            add(&format!("flip ({light})"), Some(errors.flip));
            add(&format!("delta_e_itp ({light})"), Some(errors.delta_e_itp));
        }
        all.retain(|m| m.value.is_some() || m.name.starts_with("psnr_db"));
        all
    }
}
