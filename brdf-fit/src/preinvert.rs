//! Matrices that are inverted once and used for other values at the same places.

use brdf_factor::{Inverse, Inversion, Plan, Preinverted, Problem, TexelFormat, Zeros};
use brdf_job::Job;

use crate::basis::Basis;
use crate::error::FitError;
use crate::factored::FactoredSettings;
use crate::factored::Reciprocity;
use crate::material::Material;
use crate::record::{BasisRecord, FitSettingsRecord};
use crate::training::Training;

/// Returns the inverted matrix of a material's samples, for others at the same places.
///
/// # Errors
///
/// [`FitError::Setting`] for a method whose factors are not fixed, and for [`Zeros::Below`], which follows the prediction;
/// [`FitError::Factor`]; [`FitError::Stopped`].
pub fn preinvert(
    material: &Material<'_>,
    settings: &FactoredSettings,
    inversion: Inversion,
    job: &Job<'_>,
) -> Result<Basis, FitError> {
    let reciprocal = settings.reciprocity != Reciprocity::Off;
    let Some(specs) = settings.method.fixed_specs(reciprocal) else {
        return Err(FitError::Setting {
            setting: "the method",
            value: settings.method.name().name(),
            expected: "mccool or radial, whose factors are fixed",
        });
    };
    if settings.zeros == Zeros::Below {
        return Err(FitError::Setting {
            setting: "zeros",
            value: "below",
            expected: "exact: two solves give the texels, and none follows the prediction",
        });
    }
    job.begin("inverting", 1);
    job.check()?;
    let channels = settings.channels.unwrap_or(material.channels());
    let record = settings.record(material);
    let training = Training::new(material, channels, &record);
    let problem = Problem::new(&training.fitted, &record.params)?;
    let plan = Plan::of(&specs, record.params.texture_size);
    let inverted = Preinverted::new(&problem, &[], plan, inversion)?;
    job.advance(1);
    let record = BasisRecord {
        method: settings.method.name(),
        plan: inverted.plan().clone(),
        // Every model that is made by it says for itself.
        settings: FitSettingsRecord { texels: TexelFormat::F32, ..record },
        key: inverted.key().to_owned(),
        unknowns: inverted.unknowns(),
        components: match inverted.inverse() {
            Inverse::Cholesky(_) => None,
            Inverse::Svd(basis) => Some(basis.components()),
        },
    };
    Ok(Basis { inverse: inverted.inverse().clone(), record })
}
