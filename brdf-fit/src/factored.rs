//! Products of textures: searched, over fixed coordinates, or with a matrix inverted before.

use std::time::Instant;

use brdf_factor::{
    Coordinate, FactorError, FactorParams, FactorSpec, FactoredBrdf, Fit, LogTransform,
    Preinverted, Problem, TermSolve, TexelFormat, Weight, Zeros, factorize,
};
use brdf_job::Job;
use brdf_model::{
    Channels, Fidelity, FidelityPairs, PairSampling, SampleSet, ScrambledSobol, largest_albedo,
    summarize,
};
use brdf_param::{Bound, Projection, Space};
use rayon::prelude::*;

use crate::basis::Basis;
use crate::error::FitError;
use crate::isotropic::IsotropicSettings;
use crate::material::Material;
use crate::method::Method;
use crate::note::FitNote;
use crate::record::{Albedo, FactoredRecord, FitSettingsRecord, TermRecord};
use crate::search::{Found, SearchSettings, fit_models};
use crate::training::Training;
use crate::tried::{FamilyRecord, SearchReport};

/// Which factors a product has.
#[derive(Clone, Debug)]
pub enum FactoredMethod {
    /// A search finds projections, for every number of terms.
    Search(SearchSettings),
    /// p(wi) q(h) p(wo).
    McCool,
    /// p(|wi⊥|) q(|h⊥|) p(|wo⊥|), one-dimensional, of isotropic materials.
    Radial,
    /// One texture for each of these; every leading part of the list is a model.
    Projections {
        /// What they project.
        space: Space,
        /// In order.
        projections: Vec<Projection>,
    },
    /// Over pairs of angles, of isotropic materials.
    Isotropic(IsotropicSettings),
    /// Over these coordinates, which say themselves whether light and viewer share textures.
    Coordinates(Vec<FactorSpec>),
    /// Those of a matrix that was inverted before, of samples at the same places.
    Preinverted(Box<Basis>),
}

impl FactoredMethod {
    /// Returns the name, as records have it.
    pub fn name(&self) -> Method {
        match self {
            Self::Search(_) => Method::Search,
            Self::McCool => Method::McCool,
            Self::Radial => Method::Radial,
            Self::Projections { .. } => Method::Projections,
            Self::Isotropic(_) => Method::Isotropic,
            Self::Coordinates(_) => Method::Coordinates,
            Self::Preinverted(_) => Method::Preinverted,
        }
    }

    /// Returns the factors of a model that is one, for a method that has them.
    pub(crate) fn fixed_specs(&self, reciprocal: bool) -> Option<Vec<FactorSpec>> {
        match self {
            Self::McCool => Some(FactorSpec::mccool(reciprocal)),
            Self::Radial => Some(FactorSpec::radial(reciprocal)),
            Self::Coordinates(specs) => Some(specs.clone()),
            _ => None,
        }
    }
}

/// Whether light and viewer share textures, so that exchanging them changes nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reciprocity {
    /// They do.
    #[default]
    On,
    /// They do not.
    Off,
    /// A search tries both; for each number of textures the lower error on validation pairs wins.
    Auto,
}

impl Reciprocity {
    fn candidates(self) -> &'static [bool] {
        match self {
            Self::On => &[true],
            Self::Off => &[false],
            Self::Auto => &[true, false],
        }
    }
}

/// How a product of textures is fitted.
#[derive(Clone, Debug)]
pub struct FactoredSettings {
    /// Which factors.
    pub method: FactoredMethod,
    /// Texels along each side of a texture, 2 to 1024; none for 24 after a search, else 32.
    pub texture_size: Option<usize>,
    /// How texels are stored.
    pub texels: TexelFormat,
    /// What is fitted into the square of a texture.
    pub bound: Bound,
    /// Weight μ of each texel's Laplacian, relative to the samples.
    pub smoothing: f64,
    /// Which logarithm is fitted.
    pub log_transform: LogTransform,
    /// a of ln(a + f) over the mean of each channel, above 0.
    pub offset: f64,
    /// How a sample's squared log error is weighted.
    pub weight: Weight,
    /// Whether light and viewer share textures.
    pub reciprocity: Reciprocity,
    /// Whether models are held at the largest fitted value of each channel.
    pub clamp: bool,
    /// What values of 0 ask for.
    pub zeros: Zeros,
    /// Direction pairs to draw; scattered rows come as they are.
    pub samples: u32,
    /// Share of the pairs that is drawn around the mirror direction, [0, 1): half vectors within 25° of the normal, denser
    /// towards it. The others are uniform on two parabolic discs. All count alike.
    pub highlight: f64,
    /// Which scramble of the sample sequence.
    pub seed: u64,
    /// Copies of each sample, turned about the normal in equal steps: what isotropic materials are known to do. None
    /// for 32 of scattered rows lit from one azimuth, else 1.
    pub replicate: Option<u32>,
    /// Largest angle between a direction and the normal, radians.
    pub theta_max: f64,
    /// Channels to fit; none for those that the material has.
    pub channels: Option<Channels>,
}

impl Default for FactoredSettings {
    /// A search in both spaces: up to five reciprocal textures of 24².
    fn default() -> Self {
        Self::of(FactoredMethod::Search(SearchSettings::default()))
    }
}

/// Share of the pairs at the highlight that textures over angles are fitted to.
const HIGHLIGHT_SHARE: f64 = 0.28;

impl FactoredSettings {
    /// Returns the usual settings of a method.
    pub fn of(method: FactoredMethod) -> Self {
        let (is_isotropic, samples) = match &method {
            FactoredMethod::Isotropic(angles) => (true, angles.samples(TexelFormat::F32)),
            _ => (false, 45_000),
        };
        Self {
            method,
            texture_size: None,
            texels: TexelFormat::F32,
            bound: Bound::Disc,
            smoothing: 1e-4,
            log_transform: LogTransform::Offset,
            // Channels that a file clips to 0 are cliffs in a logarithm; they stain a picture less this way.
            offset: if is_isotropic { 1e-3 } else { FactorParams::default().offset },
            weight: if is_isotropic { Weight::Fidelity } else { Weight::Log },
            reciprocity: Reciprocity::On,
            clamp: true,
            zeros: if is_isotropic { Zeros::Below } else { Zeros::Exact },
            samples,
            highlight: if is_isotropic { HIGHLIGHT_SHARE } else { 0.0 },
            seed: 1,
            replicate: None,
            theta_max: 80_f64.to_radians(),
            channels: None,
        }
    }

    /// Returns the settings for texels stored so. Where a size in bytes makes that more texels, they are fitted to more
    /// pairs.
    #[must_use]
    pub fn storing(self, texels: TexelFormat) -> Self {
        let samples = match &self.method {
            FactoredMethod::Isotropic(angles) => angles.samples(texels),
            _ => self.samples,
        };
        Self { texels, samples, ..self }
    }

    /// Returns what a fit of a material by these settings records.
    pub(crate) fn record(&self, material: &Material<'_>) -> FitSettingsRecord {
        if let FactoredMethod::Preinverted(basis) = &self.method {
            return FitSettingsRecord { texels: self.texels, ..basis.record.settings.clone() };
        }
        let is_lit_from_one_azimuth = SampleSet::has_one_light_azimuth;
        let replicate = match (self.replicate, &self.method) {
            (Some(copies), _) => copies,
            (None, FactoredMethod::Radial | FactoredMethod::Isotropic(_)) => 1,
            (None, _) if material.samples().is_some_and(is_lit_from_one_azimuth) => 32,
            (None, _) => 1,
        };
        let search = match &self.method {
            FactoredMethod::Search(search) => Some(search),
            _ => None,
        };
        // Textures over angles have sizes of their own; McCool's beside them get as many bytes.
        let usual_size = match &self.method {
            FactoredMethod::Isotropic(angles) => mccool_size(angles.bytes),
            FactoredMethod::Search(_) => 24,
            _ => 32,
        };
        FitSettingsRecord {
            params: FactorParams {
                texture_size: self.texture_size.unwrap_or(usual_size),
                bound: self.bound,
                smoothing: self.smoothing,
                log_map: self.log_transform,
                offset: self.offset,
                weight: self.weight,
                terms: search.map_or(TermSolve::All, SearchSettings::term_solve),
                clamp: self.clamp,
                zeros: self.zeros,
                theta_max: self.theta_max,
                solver: None,
            },
            reciprocal: self.reciprocity != Reciprocity::Off,
            samples: self.samples,
            highlight: self.highlight,
            seed: self.seed,
            replicate,
            texels: self.texels,
            search: search.map(SearchSettings::record),
        }
    }
}

/// Texels along a side of McCool's two textures of three channels, in so many bytes.
pub(crate) fn mccool_size(bytes: usize) -> usize {
    const TEXTURES: usize = 2;
    const TEXEL_BYTES: usize = 12;
    (bytes / (TEXEL_BYTES * TEXTURES)).isqrt().clamp(2, 64)
}

/// A factored model and how it was made: what a model file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct FactoredModel {
    /// The model.
    pub model: FactoredBrdf,
    /// The best models of fewer textures, smallest first, with the same transforms and grazing limit.
    pub smaller: Vec<FactoredBrdf>,
    /// How it was made.
    pub record: FactoredRecord,
}

impl FactoredModel {
    /// Returns the model of `textures` textures in place of the largest, with those below it;
    /// `None` where there is none.
    pub fn keep(mut self, textures: usize) -> Option<Self> {
        let count = |model: &FactoredBrdf| model.factors().len();
        if count(&self.model) != textures {
            let at = self.smaller.iter().position(|model| count(model) == textures)?;
            self.smaller.truncate(at + 1);
            self.model = self.smaller.pop()?;
        }
        self.record.terms.retain(|term| term.textures <= textures);
        // Smaller models may be of another family.
        if let Some(family) = self.record.terms.last().and_then(|term| term.family) {
            self.record.space = family.space;
            self.record.settings.reciprocal = family.reciprocal;
        }
        Some(self)
    }

    /// Returns the projections of the model's factors and the space that all of them are in; none unless there is
    /// one, and one space.
    pub fn projections(&self) -> Option<(Space, Vec<Projection>)> {
        let found: Vec<(Space, Projection)> = self
            .model
            .factors()
            .iter()
            .filter_map(|factor| match factor.coordinates()[0] {
                Coordinate::Projected { space, projection } => Some((space, projection)),
                _ => None,
            })
            .collect();
        let &(space, _) = found.first()?;
        let is_one = found.iter().all(|(other, _)| *other == space);
        is_one.then(|| (space, found.into_iter().map(|(_, projection)| projection).collect()))
    }
}

/// Models by number of terms, their errors, and McCool's beside them.
#[derive(Clone, Debug)]
pub struct FactoredFit {
    /// The fits, the one with the most terms last; at least one. Their texels are those that are stored.
    pub fits: Vec<Fit>,
    /// Errors of each.
    pub terms: Vec<TermRecord>,
    /// Errors of McCool's two textures on the same samples.
    pub baseline: TermRecord,
    /// Linear least-squares problems that were solved for the terms, the search included.
    pub evaluations: usize,
    /// How the projections were found, if they were searched.
    pub search: Option<SearchReport>,
    /// Of the fit and the search.
    pub seconds: f64,
    /// Rows or drawn pairs that were fitted, before they were copied.
    pub rows: usize,
    /// Largest directional albedos within the grazing limit.
    pub albedo: Albedo,
    /// Of the model with the most terms, over held-out pairs away from the highlight and in it; none for scattered rows.
    pub fidelity: Option<Fidelity>,
    /// The same as it was fitted, before its texels were rounded; none where they are stored as f32.
    pub fitted_fidelity: Option<Box<Fidelity>>,
    /// How the model was made.
    pub method: Method,
    /// Name of the material.
    pub name: String,
    /// Channels that were fitted.
    pub channels: Channels,
    /// The settings that were used.
    pub settings: FitSettingsRecord,
    /// What a reader should know.
    pub notes: Vec<FitNote>,
}

impl FactoredFit {
    /// Returns the fit with the most terms.
    pub fn last(&self) -> &Fit {
        // A fit has at least one model.
        &self.fits[self.fits.len() - 1]
    }

    /// Returns the space of the model's projections; standard where it has none.
    pub fn space(&self) -> Space {
        let factors = self.last().model.factors().iter();
        factors
            .flat_map(|factor| factor.coordinates())
            .find_map(|coordinate| match coordinate {
                Coordinate::Projected { space, .. } => Some(*space),
                _ => None,
            })
            .unwrap_or(Space::Standard)
    }

    /// Returns the models and how they were made, for a file.
    pub fn model(&self) -> FactoredModel {
        let fit = self.last();
        let smaller = &self.fits[..self.fits.len() - 1];
        FactoredModel {
            model: fit.model.clone(),
            smaller: smaller.iter().map(|fit| fit.model.clone()).collect(),
            record: FactoredRecord {
                method: self.method,
                input: self.name.clone(),
                space: self.space(),
                settings: self.settings.clone(),
                terms: self.terms.clone(),
                samples_used: fit.samples_used,
                dropped: fit.dropped,
            },
        }
    }
}

/// Fits a product of textures; see [`fit`](crate::fit) for what is held out.
///
/// A search that is stopped goes on with the best projections found so far. Its time ends at the job's deadline; the
/// textures are solved for after that.
///
/// # Errors
///
/// [`FitError`]; [`FitError::Stopped`] if the job is stopped before there is anything to fit.
pub fn fit_factored(
    material: &Material<'_>,
    settings: &FactoredSettings,
    job: &Job<'_>,
) -> Result<FactoredFit, FitError> {
    let reciprocal = settings.reciprocity.candidates();
    let can_choose =
        matches!(settings.method, FactoredMethod::Search(_) | FactoredMethod::Isotropic(_));
    if !can_choose && reciprocal.len() > 1 {
        return Err(FitError::Setting {
            setting: "reciprocity",
            value: "auto",
            expected: "on or off; a search or textures over angles can choose",
        });
    }
    let channels = settings.channels.unwrap_or(material.channels());
    let mut record = settings.record(material);
    let searching = match settings.method {
        FactoredMethod::Search(_) => 40.0,
        FactoredMethod::Isotropic(_) => 20.0,
        _ => 0.0,
    };
    let [drawing, searching, fitting, measuring, baseline_job] =
        job.split([1.0, searching, 4.0, 4.0, 3.0]);
    drawing.begin("drawing samples", 1);
    let training = Training::new(material, channels, &record);
    if training.fitted.is_empty() {
        let dropped = training.fitted.dropped().to_string();
        return Err(FactorError::NoSamples { dropped }.into());
    }
    drawing.advance(1);
    let start = Instant::now();
    let found = match &settings.method {
        FactoredMethod::Search(search) => {
            let families = search.families(reciprocal);
            let samples = training.for_search(material, channels, &record, families.len());
            Some(search.run(&families, &samples, &record.params, record.seed, &searching)?)
        }
        _ => None,
    };
    let mut tried = Vec::new();
    let specs = match &settings.method {
        FactoredMethod::Isotropic(angles) => {
            let (specs, is_reciprocal, others) =
                angles.choose(material, &training, channels, reciprocal, &record, &searching)?;
            record.reciprocal = is_reciprocal;
            tried = others;
            vec![specs]
        }
        FactoredMethod::Coordinates(specs) => {
            record.reciprocal = specs.iter().all(FactorSpec::is_reciprocal);
            vec![specs.clone()]
        }
        method => specs_of(method, reciprocal[0], found.as_ref()),
    };
    fitting.begin("fitting", 1);
    let mut fits = match &settings.method {
        FactoredMethod::Preinverted(basis) => {
            let problem = Problem::new(&training.fitted, &record.params)?;
            let (plan, inverse) = (basis.record.plan.clone(), basis.inverse.clone());
            let inverted = Preinverted::restore(&problem, &[], plan, inverse, &basis.record.key)?;
            vec![inverted.fit(&problem)?]
        }
        _ => fit_models(&training.fitted, &specs, &record.params)?,
    };
    let seconds = start.elapsed().as_secs_f64();
    fitting.advance(1);

    measuring.begin("measuring", fits.len() as u64);
    let family = |index: usize| match (&settings.method, &found) {
        (FactoredMethod::Projections { space, .. }, _) => {
            Some(FamilyRecord { space: *space, reciprocal: reciprocal[0] })
        }
        (_, found) => found.as_ref().map(|found| found.models[index].family),
    };
    let stored = fits.iter().map(|fit| fit.model.stored_as(record.texels));
    let stored: Vec<FactoredBrdf> = stored.collect::<Result<_, _>>()?;
    let terms: Vec<TermRecord> = fits
        .par_iter()
        .zip(&stored)
        .zip(&specs)
        .enumerate()
        .map(|(index, ((fit, stored), specs))| {
            let term = training.record(fit, stored, specs, &record)?;
            measuring.advance(1);
            Ok(TermRecord { family: family(index), ..term })
        })
        .collect::<Result<_, FactorError>>()?;
    baseline_job.begin("fitting McCool's baseline", 1);
    if let Some(largest) = found.as_ref().and_then(|found| found.models.last()) {
        record.reciprocal = largest.family.reciprocal;
    }
    let mccool = FactorSpec::mccool(record.reciprocal);
    let baseline = match &settings.method {
        FactoredMethod::McCool => terms[0].clone(),
        _ => {
            let fit = factorize(&training.fitted, &mccool, &record.params)?;
            let as_fitted = FitSettingsRecord { texels: TexelFormat::F32, ..record.clone() };
            training.record(&fit, &fit.model, &mccool, &as_fitted)?
        }
    };
    baseline_job.advance(1);
    let fidelity = |model: &FactoredBrdf| {
        material.samples().is_none().then(|| {
            let seed = ScrambledSobol::held_out_seed(record.seed);
            let pairs = FidelityPairs::new(seed, record.params.theta_max);
            pairs.measure(&*channels.of(material.brdf()), model)
        })
    };
    let is_rounded = !record.texels.is_f32();
    let fitted_fidelity =
        fits.last().filter(|_| is_rounded).and_then(|fit| fidelity(&fit.model)).map(Box::new);
    fits.iter_mut().zip(stored).for_each(|(fit, stored)| fit.model = stored);
    let model = &fits[fits.len() - 1].model;
    let albedo = Albedo {
        reference: material
            .samples()
            .is_none()
            .then(|| largest_albedo(channels.of(material.brdf()).as_ref(), model.theta_max()).0),
        model: largest_albedo(model, model.theta_max()).0,
    };
    let fidelity = fidelity(model);
    let searched = found.as_ref().map_or(0, |f| f.tried.iter().map(|t| t.evaluations).sum());
    let asked = record.search.as_ref().map_or(0, |search| search.terms);
    let mut fit = FactoredFit {
        evaluations: searched + fits.len(),
        search: found.as_ref().map(|found| SearchReport {
            terms: asked,
            stopped: found.stopped.map(|cause| cause.name().to_owned()),
            tried: found.tried.clone(),
        }),
        fits,
        terms,
        baseline,
        seconds,
        rows: training.rows.len(),
        albedo,
        fidelity,
        fitted_fidelity,
        method: settings.method.name(),
        name: material.name().to_owned(),
        channels,
        settings: record,
        notes: Vec::new(),
    };
    fit.notes = notes(&fit, material, found.as_ref());
    if !tried.is_empty() {
        fit.notes.push(FitNote::ChosenAngles { tried, on_rows: material.samples().is_some() });
    }
    let zeros = fit.last().zeros;
    if fit.settings.params.zeros == Zeros::Below && zeros > 0 {
        fit.notes.push(FitNote::Zeros { values: zeros });
    }
    if is_made_of_angles(fit.last()) {
        fit.notes.extend(crate::compact::taken_isotropic(material));
    }
    Ok(fit)
}

/// All coordinates are angles that a turn about the normal does not change.
fn is_made_of_angles(fit: &Fit) -> bool {
    let mut coordinates = fit.model.factors().iter().flat_map(|factor| factor.coordinates());
    coordinates.all(|coordinate| matches!(coordinate, Coordinate::Isotropic { .. }))
}

/// The factors of each model.
fn specs_of(
    method: &FactoredMethod,
    reciprocal: bool,
    found: Option<&Found>,
) -> Vec<Vec<FactorSpec>> {
    match (method, found) {
        (FactoredMethod::Search(_), Some(found)) => {
            found.models.iter().map(|model| model.specs.clone()).collect()
        }
        (FactoredMethod::Search(_), None) => Vec::new(),
        (FactoredMethod::Projections { space, projections }, _) => {
            let specs = FactorSpec::projections(*space, projections, reciprocal);
            (1..=specs.len()).map(|n| specs[..n].to_vec()).collect()
        }
        (FactoredMethod::Preinverted(basis), _) => {
            vec![basis.record.plan.factors.iter().map(|(spec, _)| spec.clone()).collect()]
        }
        (fixed, _) => fixed.fixed_specs(reciprocal).into_iter().collect(),
    }
}

/// Fewer directions of light than this leave most of the light's texture to smoothing.
const FEW_INCIDENCES: usize = 8;
/// Rows near less than this share of the domain leave most of the fit to smoothing.
const SPARSE: f64 = 0.5;

fn notes(fit: &FactoredFit, material: &Material<'_>, found: Option<&Found>) -> Vec<FitNote> {
    let mut notes = Vec::new();
    let clamped = fit.last().clamped;
    if clamped > 0 {
        notes.push(FitNote::Clamped { samples: clamped, in_colour: fit.channels == Channels::Rgb });
    }
    let copies = fit.settings.replicate;
    match material.samples() {
        Some(rows) => scattered_notes(rows, fit, material, &mut notes),
        None if copies > 1 => notes.push(FitNote::Rotated { copies, drawn: true }),
        None => {}
    }
    if let (Some(found), Some(search)) = (found, &fit.settings.search) {
        search_notes(found, search.terms, material.samples().is_some(), &mut notes);
    }
    let (rows, texels) = (fit.rows, fit.last().unknowns);
    if rows < texels {
        notes.push(FitNote::FewRows { rows, texels });
    }
    if fit.terms.iter().any(|term| term.held_out.is_none()) {
        notes.push(FitNote::NothingHeldOut);
    }
    let Albedo { reference, model } = fit.albedo;
    if model > 1.0 {
        notes.push(FitNote::GainsEnergy { model, reference });
    } else if let Some(reference) = reference
        && !(0.8..=1.25).contains(&(model / reference))
    {
        notes.push(FitNote::AlbedoOff { model, reference, factored: true });
    }
    notes
}

/// What scattered rows were turned into, and what they cannot tell.
fn scattered_notes(
    rows: &SampleSet,
    fit: &FactoredFit,
    material: &Material<'_>,
    notes: &mut Vec<FitNote>,
) {
    let copies = fit.settings.replicate;
    notes.push(if copies > 1 {
        FitNote::Rotated { copies, drawn: false }
    } else if rows.has_one_light_azimuth() {
        FitNote::AsMeasured
    } else {
        FitNote::NotTakenIsotropic
    });
    if fit.settings.reciprocal {
        notes.push(FitNote::SharedTextures);
    }
    if fit.terms.iter().all(|term| term.held_out.is_some()) {
        notes.push(FitNote::Folds);
    }
    let incidences = summarize(rows).incidences;
    if incidences < FEW_INCIDENCES {
        notes.push(FitNote::FewIncidences { incidences });
    }
    let coverage = coverage(material, fit.settings.params.theta_max);
    if coverage < SPARSE {
        notes.push(FitNote::Sparse { coverage });
    }
}

/// How the projections came about, where that bears on the figures.
fn search_notes(found: &Found, asked: usize, scattered: bool, notes: &mut Vec<FitNote>) {
    if let Some(cause) = found.stopped {
        notes.push(FitNote::SearchStopped { cause, found: found.models.len(), asked });
    }
    let compared = found.tried.iter().filter(|this| !this.validation.is_empty());
    let tried: Vec<(FamilyRecord, Vec<f64>)> =
        compared.map(|this| (this.family, this.validation.clone())).collect();
    if !tried.is_empty() {
        notes.push(FitNote::Chosen { tried, on_rows: scattered });
    }
    if scattered {
        notes.push(FitNote::SearchedWithAllRows);
    }
}

/// Share of direction pairs within the grazing limit that have a row nearby.
fn coverage(material: &Material<'_>, theta_max: f64) -> f64 {
    let sampling = PairSampling { count: 4_000, seed: 1, theta_max };
    let covered = sampling.pairs().filter(|pair| material.brdf().has_data(pair)).count();
    covered as f64 / f64::from(sampling.count)
}
