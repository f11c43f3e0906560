//! Everything that one model is judged by.

use brdf_image::ImageErrors;
use brdf_model::{ErrorMeasures, PerceptualErrors};
use serde::{Deserialize, Serialize};

/// A model's figures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ModelMeasures {
    /// The model, as it was given.
    pub model: String,
    /// What it takes: the textures of a model, the whole file of a measurement, nothing for a formula.
    pub bytes: usize,
    /// Pairs that the model has no data for; they are left out of its errors.
    pub without_data: usize,
    /// Log residuals for which a + f̂ was not positive and f̂ = 0 stood in.
    pub without_logarithm: usize,
    /// Of ln(a + f).
    pub log: ErrorMeasures,
    /// Of f, sr⁻¹.
    pub linear: ErrorMeasures,
    /// Measures that follow the eye.
    #[serde(flatten)]
    pub perceptual: PerceptualErrors,
    /// sr⁻¹; null where the reference cannot be evaluated everywhere.
    pub cosine_rms: Option<f64>,
    /// The same over the reference's own cosine-weighted RMS.
    pub cosine_rms_relative: Option<f64>,
    /// Weighted with both cosines, sr⁻¹.
    pub cosine_rms_both: Option<f64>,
    /// Over pairs within 80° of the normal, sr⁻¹.
    pub cosine_rms_within_80: Option<f64>,
    /// Pairs of the cosine-weighted RMS for which the reference or the model has no data.
    pub cosine_rms_without_data: Option<usize>,
    /// Milliseconds for a million evaluations in batches on one thread.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ms_per_million: Option<f64>,
    /// On spheres; the light of each is named.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pictures: Vec<PictureMeasures>,
}

/// Measures on spheres under one light.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PictureMeasures {
    /// Name of the light.
    pub light: String,
    /// Differences of the pictures.
    #[serde(flatten)]
    pub errors: ImageErrors,
}

/// A measure by name, for tables and distributions; larger is worse but where said.
#[derive(Clone, Debug, PartialEq)]
pub struct Measure {
    /// Its name, as JSON has it; of pictures with the light in parentheses.
    pub name: String,
    /// Whether larger values are better.
    pub larger_is_better: bool,
    /// Its value; none where it has none, as the PSNR of equal pictures.
    pub value: Option<f64>,
}

impl ModelMeasures {
    /// Returns every measure, in the order and by the names of the JSON.
    pub fn all(&self) -> Vec<Measure> {
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
        for PictureMeasures { light, errors } in &self.pictures {
            add(&format!("psnr_db ({light})"), errors.psnr_db);
            add(&format!("ssim ({light})"), Some(errors.ssim));
            add(&format!("flip ({light})"), Some(errors.flip));
            add(&format!("delta_e_itp ({light})"), Some(errors.delta_e_itp));
        }
        all.retain(|m| m.value.is_some() || m.name.starts_with("psnr_db"));
        all
    }
}
