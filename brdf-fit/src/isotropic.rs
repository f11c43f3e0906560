//! Which pairs of angles an isotropic material gets textures over, and how their texels are spaced.

use brdf_factor::{FactorError, FactorParams, FactorSpec, IsotropicPairs, Spacing, factorize};
use brdf_job::Job;
use brdf_model::Channels;
use serde::{Deserialize, Serialize};

use crate::error::FitError;
use crate::judge::{Judge, error_on};
use crate::material::Material;
use crate::record::FitSettingsRecord;
use crate::training::Training;

/// Bytes of a texel of one channel.
const VALUE_BYTES: usize = 4;

/// Textures over pairs of angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IsotropicSettings {
    /// Which pairs; none for those that suit best.
    pub pairs: Option<IsotropicPairs>,
    /// How texels are spaced along θh; none for what suits best.
    pub spacing: Option<Spacing>,
    /// Most bytes of all textures, as f32.
    pub bytes: usize,
}

impl Default for IsotropicSettings {
    /// The best choice of at most 33 kB.
    fn default() -> Self {
        Self { pairs: None, spacing: None, bytes: 33_000 }
    }
}

/// A choice of pairs and spacing that was tried.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TriedPairs {
    /// Which pairs.
    pub pairs: IsotropicPairs,
    /// How texels are spaced along θh.
    pub spacing: Spacing,
    /// What choices are made by: [`Fidelity::score`](brdf_model::Fidelity::score) over validation pairs, or for scattered
    /// rows the geometric mean of log and linear error over a tenth set aside.
    pub error: f64,
}

impl IsotropicSettings {
    /// Spacings that are tried: even, and crowded at the mirror direction.
    const SPACINGS: [Spacing; 2] = [Spacing::Linear, Spacing::Power { exponent: 0.5 }];

    /// The factors of a choice.
    fn specs(
        &self,
        pairs: IsotropicPairs,
        spacing: Spacing,
        channels: Channels,
        reciprocal: bool,
    ) -> Vec<FactorSpec> {
        let values = match channels {
            Channels::Luminance => 1,
            Channels::Rgb => 3,
        };
        pairs.specs(spacing, self.bytes / (VALUE_BYTES * values), reciprocal)
    }

    /// Returns the factors that suit a material best, and what was tried; nothing where there is no choice.
    pub(crate) fn choose(
        &self,
        material: &Material<'_>,
        training: &Training,
        channels: Channels,
        record: &FitSettingsRecord,
        job: &Job<'_>,
    ) -> Result<(Vec<FactorSpec>, Vec<TriedPairs>), FitError> {
        let all_pairs = self.pairs.map_or(IsotropicPairs::ALL.to_vec(), |pairs| vec![pairs]);
        let spacings = self.spacing.map_or(Self::SPACINGS.to_vec(), |spacing| vec![spacing]);
        let choices: Vec<(IsotropicPairs, Spacing)> = all_pairs
            .into_iter()
            .flat_map(|pairs| spacings.iter().map(move |&spacing| (pairs, spacing)))
            .collect();
        let specs = |(pairs, spacing)| self.specs(pairs, spacing, channels, record.reciprocal);
        if let [only] = choices[..] {
            return Ok((specs(only), Vec::new()));
        }
        let trial = Trial::new(material, training, channels, record);
        job.begin("choosing angles", choices.len() as u64);
        let mut tried = Vec::new();
        for &choice in &choices {
            if !tried.is_empty() && job.is_stopped() {
                break;
            }
            let (pairs, spacing) = choice;
            let error = trial.error(&specs(choice), &record.params)?;
            tried.push(TriedPairs { pairs, spacing, error });
            job.advance(1);
        }
        let best = tried.iter().min_by(|a, b| a.error.total_cmp(&b.error));
        let best = best.map_or(choices[0], |best| (best.pairs, best.spacing));
        Ok((specs(best), tried))
    }
}

/// What is fitted and what is compared, to choose by.
enum Trial<'a> {
    Drawn(&'a Training, Judge),
    Rows(crate::training::Choice),
}

impl<'a> Trial<'a> {
    fn new(
        material: &Material<'_>,
        training: &'a Training,
        channels: Channels,
        record: &FitSettingsRecord,
    ) -> Self {
        if material.samples().is_some() {
            let samples = training.for_search(material, channels, record, 2);
            if let Some(choice) = samples.choice {
                return Self::Rows(choice);
            }
        }
        Self::Drawn(training, Judge::new(material, channels, record.seed, record.params.theta_max))
    }

    fn error(&self, specs: &[FactorSpec], params: &FactorParams) -> Result<f64, FactorError> {
        Ok(match self {
            Self::Drawn(training, judge) => {
                judge.error(&factorize(&training.fitted, specs, params)?.model)
            }
            Self::Rows(choice) => {
                let model = factorize(&choice.fitted, specs, params)?.model;
                error_on(&choice.unseen, &choice.fitted, &model)
            }
        })
    }
}
