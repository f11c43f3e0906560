//! Any method, by its settings.

use brdf_job::Job;

use crate::auto::{AutoSettings, fit_auto};
use crate::compact::{CompactSettings, fit_compact};
use crate::error::FitError;
use crate::factored::{FactoredSettings, fit_factored};
use crate::fitted::Fit;
use crate::material::Material;
use crate::separable::{SeparableSettings, fit_separable};

/// How a material is fitted.
#[derive(Clone, Debug)]
pub enum FitSettings {
    /// By the method that suits it best.
    Auto(AutoSettings),
    /// As a product of textures.
    Factored(FactoredSettings),
    /// As a sum of products.
    Separable(SeparableSettings),
    /// As a compact model of an isotropic material.
    Compact(CompactSettings),
}

impl Default for FitSettings {
    /// The best model of 8 KiB.
    fn default() -> Self {
        Self::Auto(AutoSettings::default())
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
/// Compact models are fitted to nodes and pairs of their own. Errors at the highlight are those of a
/// [`Fidelity`](brdf_model::Fidelity) over pairs of the held-out scramble; choices between methods, axes and offsets are
/// made on the third.
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
        FitSettings::Auto(settings) => fit_auto(material, settings, job),
        FitSettings::Factored(settings) => {
            Ok(Fit::Factored(Box::new(fit_factored(material, settings, job)?)))
        }
        FitSettings::Separable(settings) => {
            Ok(Fit::Separable(Box::new(fit_separable(material, settings, job)?)))
        }
        FitSettings::Compact(settings) => {
            Ok(Fit::Compact(Box::new(fit_compact(material, settings, job)?)))
        }
    }
}
