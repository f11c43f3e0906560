//! The method that suits a material, by trying those that may.

use brdf_factor::{Spacing, TexelFormat};
use brdf_job::Job;
use brdf_model::{ANISOTROPIC, anisotropy};
use brdf_spline::SPLINE_BYTES;
use rayon::prelude::*;

use crate::compact::{CompactMethod, CompactSettings, fit_compact};
use crate::error::FitError;
use crate::factored::{FactoredMethod, FactoredSettings, Reciprocity, fit_factored, mccool_size};
use crate::fitted::Fit;
use crate::isotropic::IsotropicSettings;
use crate::judge::Judge;
use crate::material::Material;
use crate::note::FitNote;
use crate::record::TriedModel;

/// Sizes that are tried until one reaches an error.
const SIZES: [usize; 6] = [500, 1_000, 2_700, 8_192, 16_384, 33_000];

/// What a model may cost, or what it has to reach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Aim {
    /// The best model of at most so many bytes.
    Bytes(usize),
    /// The smallest model whose error is at most this: [`Fidelity::score`](brdf_model::Fidelity::score), or for scattered
    /// samples [`FidelityErrors::score`](brdf_model::FidelityErrors::score) over folds.
    Error(f64),
}

impl Default for Aim {
    fn default() -> Self {
        Self::Bytes(8 << 10)
    }
}

/// How a method is chosen.
#[derive(Clone, Debug, Default)]
pub struct AutoSettings {
    /// What the model may cost, or has to reach.
    pub aim: Aim,
    /// How an anisotropic material is searched; the grazing limit, seed and channels of these are those of all methods.
    pub search: FactoredSettings,
}

/// Fits a material by the methods that may suit it and returns the best, with a [`FitNote::ChosenMethod`].
///
/// An isotropic material gets splines, one or two GGX lobes, McCool's textures or (unless it is scattered samples) those
/// over pairs of angles: whichever has the lowest [`Fidelity::score`](brdf_model::Fidelity::score) over validation pairs,
/// which are neither fitted nor held out. Scattered samples are judged by
/// [`FidelityErrors::score`](brdf_model::FidelityErrors::score) over ten folds. An anisotropic material is searched for
/// projections, since the others would lose what turns with it.
///
/// # Errors
///
/// [`FitError`].
pub fn fit_auto(
    material: &Material<'_>,
    settings: &AutoSettings,
    job: &Job<'_>,
) -> Result<Fit, FitError> {
    let change = anisotropy(material.brdf());
    if material.samples().is_none() && change > ANISOTROPIC {
        let mut found = Fit::Factored(Box::new(fit_factored(material, &settings.search, job)?));
        found.add_note(FitNote::SearchedAsAnisotropic { change });
        return Ok(found);
    }
    let common = &settings.search;
    let channels = common.channels.unwrap_or(material.channels());
    // Scattered rows have folds instead.
    let is_drawn = material.samples().is_none();
    let judge = is_drawn.then(|| Judge::new(material, channels, common.seed, common.theta_max));
    let steps: Vec<Vec<Candidate>> = match settings.aim {
        Aim::Bytes(bytes) => vec![candidates(settings, bytes, is_drawn)],
        Aim::Error(_) => SIZES.iter().map(|&bytes| candidates(settings, bytes, is_drawn)).collect(),
    };
    let mut tried: Vec<TriedModel> = Vec::new();
    let mut best: Option<(f64, Fit)> = None;
    for (step, job) in steps.iter().zip(job.split_into(&vec![1.0; steps.len()])) {
        // Side by side, as most of them keep one thread busy; what is chosen does not depend on it.
        let jobs = job.split_into(&vec![1.0; step.len()]);
        let error_of = |found: &Fit| match &judge {
            Some(judge) => judge.error(found.brdf()),
            None => {
                let errors = found.held_out().or_else(|| found.training());
                errors.map_or(f64::INFINITY, |errors| errors.fidelity.score())
            }
        };
        let found: Vec<Result<(f64, Fit), FitError>> = step
            .par_iter()
            .zip(jobs.into_par_iter())
            .map(|(candidate, job)| {
                let found = candidate.fit(material, &job)?;
                Ok((error_of(&found), found))
            })
            .collect();
        for found in found {
            let (error, found) = match found {
                Ok(found) => found,
                // A method that cannot take the material is no candidate, unless there is no other.
                Err(FitError::Stopped(stopped)) => return Err(stopped.into()),
                Err(error) if step.len() == 1 => return Err(error),
                Err(_) => continue,
            };
            let model = TriedModel { method: found.method(), bytes: found.bytes(), error };
            if !tried.contains(&model) {
                tried.push(model);
            }
            if best.as_ref().is_none_or(|(least, _)| error < *least) {
                best = Some((error, found));
            }
        }
        if let (Aim::Error(limit), Some((error, _))) = (settings.aim, &best)
            && *error <= limit
        {
            break;
        }
    }
    let Some((error, mut found)) = best else {
        // Every candidate failed: say why the first did.
        return candidates(settings, SIZES[3], is_drawn)[0].fit(material, job);
    };
    if let Aim::Error(limit) = settings.aim
        && error > limit
    {
        found.add_note(FitNote::ErrorNotReached { asked: limit, found: error });
    }
    found.add_note(FitNote::ChosenMethod { tried, on_rows: material.samples().is_some() });
    Ok(found)
}

/// A model that may be the best.
enum Candidate {
    Compact(CompactSettings),
    Factored(Box<FactoredSettings>),
}

impl Candidate {
    fn fit(&self, material: &Material<'_>, job: &Job<'_>) -> Result<Fit, FitError> {
        Ok(match self {
            Self::Compact(settings) => {
                Fit::Compact(Box::new(fit_compact(material, settings, job)?))
            }
            Self::Factored(settings) => {
                Fit::Factored(Box::new(fit_factored(material, settings, job)?))
            }
        })
    }
}

/// What is tried for an isotropic material and so many bytes; `is_drawn` unless rows are all there is.
fn candidates(settings: &AutoSettings, bytes: usize, is_drawn: bool) -> Vec<Candidate> {
    let common = &settings.search;
    let compact = |method| {
        Candidate::Compact(CompactSettings {
            method,
            theta_max: common.theta_max,
            seed: common.seed,
            channels: common.channels,
        })
    };
    let bytes = bytes.clamp(*SPLINE_BYTES.start(), *SPLINE_BYTES.end());
    let textures = |method, texture_size, texels, reciprocity| {
        Candidate::Factored(Box::new(FactoredSettings {
            texture_size,
            theta_max: common.theta_max,
            seed: common.seed,
            channels: common.channels,
            reciprocity,
            ..FactoredSettings::of(method).storing(texels)
        }))
    };
    // Half precision: twice the texels in the same bytes, and no error of its own. One spacing that suits most: choosing
    // takes time, and splines are better nearly always.
    let spacing = Some(Spacing::Power { exponent: 0.75 });
    let angles = IsotropicSettings { pairs: None, spacing, bytes };
    let mut all = vec![
        compact(CompactMethod::Spline { bytes }),
        compact(CompactMethod::Ggx { lobes: 1 }),
        compact(CompactMethod::Ggx { lobes: 2 }),
        textures(
            FactoredMethod::McCool,
            Some(mccool_size(bytes)),
            TexelFormat::F32,
            Reciprocity::On,
        ),
    ];
    // Between rows textures know nothing of a highlight, and ten folds of them take longer than all else.
    if is_drawn {
        let angles = FactoredMethod::Isotropic(angles);
        all.push(textures(angles, None, TexelFormat::F16, Reciprocity::Auto));
    }
    all
}
