//! Compact models of isotropic materials: all that there is to store is one short stream or a handful of numbers.

use std::time::Instant;

use brdf_job::Job;
use brdf_model::{
    ANISOTROPIC, Brdf, Channels, Dropped, Fidelity, FidelityPairs, FitErrors, GgxLobes,
    PairSampling, Rgb, SampleSet, ScrambledSobol, anisotropy, largest_albedo, log_offsets, measure,
    measure_folds,
};
use brdf_spline::{
    SplineBrdf, SplineSettings, SplineTrial, Symmetry, fit_spline_samples, fit_splines,
};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::error::FitError;
use crate::lobes::LobeProblem;
use crate::material::Material;
use crate::method::Method;
use crate::note::FitNote;
use crate::record::Albedo;
use crate::training::{FOLDS, drawn};

/// Pairs that lobes are fitted to, of each of two kinds.
const LOBE_PAIRS: u32 = 1500;
/// Rows of scattered samples that lobes are fitted to at most.
const LOBE_ROWS: usize = 6000;

/// Which compact model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CompactMethod {
    /// A sum of products of splines in at most so many bytes.
    Spline {
        /// Most bytes of the stream.
        bytes: usize,
    },
    /// A diffuse base, GGX lobes and sheen.
    Ggx {
        /// Number of lobes.
        lobes: usize,
    },
}

impl CompactMethod {
    /// Returns the name, as records have it.
    pub fn name(self) -> Method {
        match self {
            Self::Spline { .. } => Method::Spline,
            Self::Ggx { .. } => Method::Ggx,
        }
    }
}

/// How a compact model is fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompactSettings {
    /// Which model.
    pub method: CompactMethod,
    /// Largest angle to the normal of the pairs that errors are taken over, radians.
    pub theta_max: f64,
    /// Which scrambles of the sample sequence.
    pub seed: u64,
    /// Channels to fit; none for those that the material has.
    pub channels: Option<Channels>,
}

impl CompactSettings {
    /// Returns the usual settings of a method.
    pub fn of(method: CompactMethod) -> Self {
        Self { method, theta_max: 80_f64.to_radians(), seed: 1, channels: None }
    }
}

/// A compact model.
#[derive(Clone, Debug, PartialEq)]
pub enum CompactBrdf {
    /// A sum of products of splines.
    Spline(Box<SplineBrdf>),
    /// GGX lobes.
    Ggx(GgxLobes),
}

impl CompactBrdf {
    /// Returns the model as a function.
    pub fn brdf(&self) -> &dyn Brdf {
        match self {
            Self::Spline(model) => model.as_ref(),
            Self::Ggx(model) => model,
        }
    }

    /// Returns the channels of the model.
    pub fn channels(&self) -> Channels {
        match self {
            Self::Spline(model) => model.channels(),
            Self::Ggx(_) => Channels::Rgb,
        }
    }

    /// Returns the bytes that say all there is to know of the model: a stream, or parameters as f32.
    pub fn payload_bytes(&self) -> usize {
        match self {
            Self::Spline(model) => model.as_bytes().len(),
            Self::Ggx(model) => 4 * model.parameters(),
        }
    }
}

/// How a compact model was made and how good it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CompactRecord {
    /// `spline` or `ggx`.
    pub method: Method,
    /// What was fitted: a preset, or the name of a file without its folder.
    pub input: String,
    /// Options.
    pub settings: CompactSettingsRecord,
    /// What the model is made of.
    pub makeup: Makeup,
    /// Samples that were fitted.
    pub samples_used: usize,
    /// Samples left out.
    pub dropped: Dropped,
    /// Over pairs, or folds of rows, that were not fitted; none where there were too few.
    pub held_out: Option<FitErrors>,
    /// Over pairs that were neither fitted nor used for choices, away from the highlight and in it; none for scattered
    /// samples.
    pub fidelity: Option<Fidelity>,
}

/// Options that decide a compact model.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CompactSettingsRecord {
    /// Most bytes, of splines.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bytes: Option<usize>,
    /// Number of lobes, of GGX lobes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lobes: Option<usize>,
    /// Grazing limit of errors, radians.
    pub theta_max: f64,
    /// Which scrambles.
    pub seed: u64,
}

/// What a compact model is made of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Makeup {
    /// A sum of products of splines.
    Splines {
        /// Products.
        terms: usize,
        /// Splines over θh and over θd, harmonics of φd.
        functions: [usize; 3],
        /// Which exchanges leave the model unchanged.
        symmetry: Symmetry,
        /// Angle up to which splines over θh are evenly spaced, radians.
        alpha: f64,
        /// a of ln(a + f) for each channel, sr⁻¹.
        offsets: Vec<f64>,
        /// Smallest and largest value of each channel, sr⁻¹.
        ranges: Vec<[f64; 2]>,
        /// Lobes that the products change; none where the products are the model.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        base: Option<GgxLobes>,
    },
    /// GGX lobes on a diffuse base.
    Lobes(GgxLobes),
}

/// A compact model and how it was made: what a model file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct CompactModel {
    /// The model.
    pub model: CompactBrdf,
    /// How it was made.
    pub record: CompactRecord,
}

/// A compact model with its errors.
#[derive(Clone, Debug)]
pub struct CompactFit {
    /// The model, its errors and settings.
    pub model: CompactModel,
    /// Over what was fitted, where that were scattered samples.
    pub training: Option<FitErrors>,
    /// Axes and offsets of splines that were tried.
    pub trials: Vec<SplineTrial>,
    /// Values of channels that are 0 in what was fitted.
    pub zeros: usize,
    /// Largest directional albedos.
    pub albedo: Albedo,
    /// Of fitting, without measuring errors.
    pub seconds: f64,
    /// What a reader should know.
    pub notes: Vec<FitNote>,
}

/// A model before it is judged.
struct Fitted {
    model: CompactBrdf,
    samples: usize,
    /// Of splines.
    chosen: Option<SplineTrial>,
    trials: Vec<SplineTrial>,
    zeros: usize,
    not_finite: usize,
}

/// What there is to say of an isotropic model of a material that is not.
pub(crate) fn taken_isotropic(material: &Material<'_>) -> Option<FitNote> {
    let change = anisotropy(material.brdf());
    let is_told = material.samples().is_none() && change > ANISOTROPIC;
    is_told.then_some(FitNote::TakenIsotropic { change })
}

/// Fits a compact model; see [`fit`](crate::fit) for what is held out. An anisotropic material is taken to be what it is
/// at one azimuth of the half vector, and a note says so.
///
/// # Errors
///
/// [`FitError::Spline`]; [`FitError::Stopped`].
pub fn fit_compact(
    material: &Material<'_>,
    settings: &CompactSettings,
    job: &Job<'_>,
) -> Result<CompactFit, FitError> {
    let channels = settings.channels.unwrap_or(material.channels());
    let [fitting, judging] = job.split([3.0, 2.0]);
    let start = Instant::now();
    let rows = material.samples().map(|rows| {
        let rows = if channels == Channels::Luminance { rows.to_luminance() } else { rows.clone() };
        rows.within(settings.theta_max)
    });
    let fitted = match &rows {
        Some(rows) => fit_rows(rows, settings, None, &fitting)?,
        None => fit_function(material, channels, settings, &fitting)?,
    };
    let seconds = start.elapsed().as_secs_f64();
    let model = fitted.model.brdf();

    judging.begin("measuring", FOLDS as u64);
    let (mut fidelity, mut training) = (None, None);
    let mut dropped = rows.as_ref().map(SampleSet::dropped).unwrap_or_default();
    dropped.not_finite += fitted.not_finite;
    let reference = channels.of(material.brdf());
    let held_out = match &rows {
        Some(rows) => {
            training = Some(measure(rows, model, &log_offsets(rows)));
            over_folds(rows, settings, &fitted, &judging)?
        }
        None => {
            let seed = ScrambledSobol::held_out_seed(settings.seed);
            let unseen = drawn(material, channels, seed, settings.theta_max);
            let pairs = FidelityPairs::new(seed, settings.theta_max);
            fidelity = Some(pairs.measure(&*reference, model));
            (!unseen.is_empty()).then(|| measure(&unseen, model, &log_offsets(&unseen)))
        }
    };
    judging.check()?;
    let albedo = Albedo {
        reference: rows.is_none().then(|| largest_albedo(&*reference, settings.theta_max).0),
        model: largest_albedo(model, settings.theta_max).0,
    };
    let mut notes = Vec::new();
    if rows.is_some() && held_out.is_some() {
        notes.push(FitNote::Folds);
    }
    notes.extend(taken_isotropic(material));
    if fitted.zeros > 0 {
        notes.push(FitNote::Zeros { values: fitted.zeros });
    }
    if albedo.model > 1.0
        && albedo.reference.is_none_or(|reference| albedo.model > 1.02 * reference)
    {
        notes.push(FitNote::GainsEnergy { model: albedo.model, reference: albedo.reference });
    }
    let record = CompactRecord {
        method: settings.method.name(),
        input: material.name().to_owned(),
        settings: settings.record(),
        makeup: makeup(&fitted.model),
        samples_used: fitted.samples,
        dropped,
        held_out,
        fidelity,
    };
    Ok(CompactFit {
        model: CompactModel { model: fitted.model, record },
        training,
        trials: fitted.trials,
        zeros: fitted.zeros,
        albedo,
        seconds,
        notes,
    })
}

impl CompactSettings {
    fn record(&self) -> CompactSettingsRecord {
        let (bytes, lobes) = match self.method {
            CompactMethod::Spline { bytes } => (Some(bytes), None),
            CompactMethod::Ggx { lobes } => (None, Some(lobes)),
        };
        CompactSettingsRecord { bytes, lobes, theta_max: self.theta_max, seed: self.seed }
    }
}

fn makeup(model: &CompactBrdf) -> Makeup {
    match model {
        CompactBrdf::Spline(model) => Makeup::Splines {
            terms: model.terms(),
            functions: model.functions(),
            symmetry: model.symmetry(),
            alpha: model.alpha(),
            offsets: model.offsets(),
            ranges: model.ranges(),
            base: model.base().cloned(),
        },
        CompactBrdf::Ggx(model) => Makeup::Lobes(model.clone()),
    }
}

fn fit_function(
    material: &Material<'_>,
    channels: Channels,
    settings: &CompactSettings,
    job: &Job<'_>,
) -> Result<Fitted, FitError> {
    match settings.method {
        CompactMethod::Spline { bytes } => {
            let seed = settings.seed;
            let spline = SplineSettings { bytes, channels, seed, ..SplineSettings::default() };
            Ok(splines(fit_splines(material.brdf(), &spline, job)?))
        }
        CompactMethod::Ggx { lobes } => {
            let sampling = PairSampling {
                count: LOBE_PAIRS,
                seed: settings.seed,
                theta_max: settings.theta_max,
            };
            let reference = channels.of(material.brdf());
            let uniform = SampleSet::draw(&*reference, &sampling, Channels::Rgb);
            let mut mirror = SampleSet::new(Channels::Rgb);
            for pair in sampling.highlight_pairs().filter(|pair| reference.has_data(pair)) {
                mirror.push_clamped(&pair, reference.eval_unclamped(&pair));
            }
            let samples = uniform.len() + mirror.len();
            let model = LobeProblem::new(&uniform, &mirror).solve(lobes, job)?;
            Ok(lobes_of(model, samples))
        }
    }
}

fn fit_rows(
    rows: &SampleSet,
    settings: &CompactSettings,
    earlier: Option<&Fitted>,
    job: &Job<'_>,
) -> Result<Fitted, FitError> {
    match settings.method {
        CompactMethod::Spline { bytes } => {
            let channels = rows.channels();
            let axis = earlier.and_then(|fit| fit.chosen);
            let seed = settings.seed;
            let spline =
                SplineSettings { bytes, channels, seed, axis, ..SplineSettings::default() };
            let base = |rows: &SampleSet, lobes: usize| {
                let few = rows.subset(LOBE_ROWS);
                let nothing = SampleSet::new(rows.channels());
                LobeProblem::new(&few, &nothing).solve(lobes, &Job::new())
            };
            Ok(splines(fit_spline_samples(rows, Some(&base), &spline, job)?))
        }
        CompactMethod::Ggx { lobes } => {
            let few = rows.subset(LOBE_ROWS);
            let nothing = SampleSet::new(rows.channels());
            let problem = LobeProblem::new(&few, &nothing);
            let model = match earlier.map(|fit| &fit.model) {
                Some(CompactBrdf::Ggx(start)) => problem.solve_near(start, job),
                _ => problem.solve(lobes, job)?,
            };
            Ok(lobes_of(model, few.len()))
        }
    }
}

fn splines(fit: brdf_spline::SplineFit) -> Fitted {
    Fitted {
        model: CompactBrdf::Spline(Box::new(fit.model)),
        samples: fit.nodes,
        chosen: Some(fit.chosen),
        trials: fit.trials,
        zeros: fit.zeros,
        not_finite: fit.not_finite,
    }
}

fn lobes_of(model: GgxLobes, samples: usize) -> Fitted {
    let model = CompactBrdf::Ggx(model);
    Fitted { model, samples, chosen: None, trials: Vec::new(), zeros: 0, not_finite: 0 }
}

/// Errors of rows under models that were fitted without their fold. Axes of splines, and where lobes start, are those of
/// the fit of all rows.
fn over_folds(
    rows: &SampleSet,
    settings: &CompactSettings,
    whole: &Fitted,
    job: &Job<'_>,
) -> Result<Option<FitErrors>, FitError> {
    if rows.len() < 2 * FOLDS {
        return Ok(None);
    }
    let of_fold = |fold: &Vec<usize>| {
        job.check()?;
        let kept: Vec<usize> =
            (0..rows.len()).filter(|index| fold.binary_search(index).is_err()).collect();
        let fitted = fit_rows(&rows.select(&kept), settings, Some(whole), &Job::new())?;
        job.advance(1);
        let model = fitted.model.brdf();
        Ok(fold.iter().map(|&index| model.eval_unclamped(&rows.pair(index))).collect())
    };
    let folds = rows.folds(FOLDS, settings.seed);
    let values: Vec<Vec<Rgb>> = folds.par_iter().map(of_fold).collect::<Result<_, FitError>>()?;
    Ok(Some(measure_folds(rows, &folds, &values, &log_offsets(rows))))
}
