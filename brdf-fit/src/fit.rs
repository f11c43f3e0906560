//! Any method, by its settings.

use brdf_job::Job;
use brdf_model::{Brdf, FitErrors};

use crate::compact::{CompactFit, CompactSettings, fit_compact};
use crate::error::FitError;
use crate::factored::{FactoredFit, FactoredSettings, fit_factored};
use crate::material::Material;
use crate::method::Method;
use crate::note::FitNote;
use crate::separable::{SeparableFit, SeparableSettings, fit_separable};

/// How a material is fitted.
#[derive(Clone, Debug)]
pub enum FitSettings {
    /// As a product of textures.
    Factored(FactoredSettings),
    /// As a sum of products.
    Separable(SeparableSettings),
    /// As a compact model of an isotropic material.
    Compact(CompactSettings),
}

impl Default for FitSettings {
    /// The search of [`FactoredSettings::default`].
    fn default() -> Self {
        Self::Factored(FactoredSettings::default())
    }
}

/// A fitted material.
#[derive(Clone, Debug)]
pub enum Fit {
    /// A product of textures.
    Factored(FactoredFit),
    /// A sum of products.
    Separable(SeparableFit),
    /// A compact model.
    Compact(CompactFit),
}

impl Fit {
    /// Returns the model with the most terms.
    pub fn brdf(&self) -> &dyn Brdf {
        match self {
            Self::Factored(fit) => &fit.last().model,
            Self::Separable(fit) => &fit.model.model,
            Self::Compact(fit) => fit.model.model.brdf(),
        }
    }

    /// Returns how the model was made.
    pub fn method(&self) -> Method {
        match self {
            Self::Factored(fit) => fit.method,
            Self::Separable(fit) => fit.model.record.method,
            Self::Compact(fit) => fit.model.record.method,
        }
    }

    /// Returns the errors of the model on samples that were not fitted; none where there are none.
    pub fn held_out(&self) -> Option<&FitErrors> {
        match self {
            Self::Factored(fit) => fit.terms.last()?.held_out.as_ref(),
            Self::Separable(fit) => fit.model.record.terms.last()?.held_out.as_ref(),
            Self::Compact(fit) => fit.model.record.held_out.as_ref(),
        }
    }

    /// Returns the errors of the model on what was fitted; a sum of products is fitted to a matrix instead, whose
    /// errors stand in its record, and splines to nodes of their own.
    pub fn training(&self) -> Option<&FitErrors> {
        match self {
            Self::Factored(fit) => Some(&fit.terms.last()?.training),
            Self::Separable(_) => None,
            Self::Compact(fit) => fit.training.as_ref(),
        }
    }

    /// Returns the bytes of the model: its textures, stream or parameters.
    pub fn bytes(&self) -> usize {
        match self {
            Self::Factored(fit) => fit.last().model.payload_bytes(),
            Self::Separable(fit) => fit.model.model.payload_bytes(),
            Self::Compact(fit) => fit.model.model.payload_bytes(),
        }
    }

    /// Returns what a reader of the numbers should know.
    pub fn notes(&self) -> &[FitNote] {
        match self {
            Self::Factored(fit) => &fit.notes,
            Self::Separable(fit) => &fit.notes,
            Self::Compact(fit) => &fit.notes,
        }
    }
}

/// Fits a material.
///
/// # Protocol
///
/// A material that can be evaluated is drawn from: pairs uniform on two parabolic discs within the grazing limit, from
/// a scrambled Sobol sequence. Errors on [`HELD_OUT_PAIRS`](crate::HELD_OUT_PAIRS) pairs of another scramble are the
/// held-out errors, everywhere. Where families of projections are searched, the one with the lowest error on a third
/// scramble wins, which is neither fitted nor held out.
///
/// Scattered samples are fitted as they are, with turned copies if they are lit from one azimuth. Ten folds, split
/// before rows are copied, give the held-out error. For a choice between families a tenth is set aside; the winner is
/// searched again with all rows.
///
/// The same material, settings and seed give the same model on any number of threads, unless the job is stopped.
///
/// # Errors
///
/// [`FitError`].
pub fn fit(
    material: &Material<'_>,
    settings: &FitSettings,
    job: &Job<'_>,
) -> Result<Fit, FitError> {
    match settings {
        FitSettings::Factored(settings) => {
            Ok(Fit::Factored(fit_factored(material, settings, job)?))
        }
        FitSettings::Separable(settings) => {
            Ok(Fit::Separable(fit_separable(material, settings, job)?))
        }
        FitSettings::Compact(settings) => Ok(Fit::Compact(fit_compact(material, settings, job)?)),
    }
}
