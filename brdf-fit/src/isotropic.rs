//! Which pairs of angles an isotropic material gets textures over, and how their texels are spaced.

use brdf_factor::{
    FactorError, FactorSpec, IsotropicPairs, Problem, Solver, Spacing, TexelFormat,
    factorize_problem,
};
use brdf_job::Job;
use brdf_model::{Channels, SampleSet};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::error::FitError;
use crate::judge::{Judge, error_on};
use crate::material::Material;
use crate::record::FitSettingsRecord;
use crate::training::Training;

/// Textures over pairs of angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IsotropicSettings {
    /// Which pairs; none for those that suit best.
    pub pairs: Option<IsotropicPairs>,
    /// How texels are spaced along θh; none for what suits best.
    pub spacing: Option<Spacing>,
    /// Most bytes of all textures as stored. There are at most 8192 texels, whatever the bytes are.
    pub bytes: usize,
}

impl Default for IsotropicSettings {
    /// The best choice of at most 33.75 KiB, as much as five square textures of 24² take.
    fn default() -> Self {
        Self { pairs: None, spacing: None, bytes: 34_560 }
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
    /// Whether light and viewer share textures.
    pub reciprocal: bool,
    /// What choices are made by: [`Fidelity::score`](brdf_model::Fidelity::score) over validation pairs, or for scattered
    /// rows [`FidelityErrors::score`](brdf_model::FidelityErrors::score) over a tenth set aside.
    pub error: f64,
}

impl IsotropicSettings {
    /// Spacings that are tried: even, and crowded at the mirror direction.
    const SPACINGS: [Spacing; 3] =
        [Spacing::Linear, Spacing::Power { exponent: 0.75 }, Spacing::Power { exponent: 0.5 }];

    /// Returns the number of pairs that as many texels are fitted to well as there can be in this format: 32 for each, from
    /// 20,000 to 90,000.
    pub fn samples(&self, format: TexelFormat) -> u32 {
        let texels = format.texels_within(self.bytes, 4, 3);
        let pairs = texels.saturating_mul(32).clamp(20_000, 90_000);
        u32::try_from(pairs).unwrap_or(u32::MAX)
    }

    /// The texels that a choice of pairs can have in all. An iterative solver would take minutes for more than are solved
    /// for directly, and more pairs would have to be fitted.
    fn texels(&self, pairs: IsotropicPairs, format: TexelFormat, channels: Channels) -> usize {
        let texels = format.texels_within(self.bytes, pairs.textures(), channels.count());
        texels.min(Solver::MAX_DENSE)
    }

    /// Returns the factors that suit a material best, whether they are reciprocal, and what was tried: nothing where
    /// there is no choice.
    pub(crate) fn choose(
        &self,
        material: &Material<'_>,
        training: &Training,
        channels: Channels,
        reciprocal: &[bool],
        record: &FitSettingsRecord,
        job: &Job<'_>,
    ) -> Result<(Vec<FactorSpec>, bool, Vec<TriedPairs>), FitError> {
        let all_pairs = self.pairs.map_or(IsotropicPairs::ALL.to_vec(), |pairs| vec![pairs]);
        let spacings = self.spacing.map_or(Self::SPACINGS.to_vec(), |spacing| vec![spacing]);
        let mut choices = Vec::new();
        for &reciprocal in reciprocal {
            for &pairs in &all_pairs {
                choices.extend(spacings.iter().map(|&spacing| (pairs, spacing, reciprocal)));
            }
        }
        let specs = |(pairs, spacing, reciprocal): (IsotropicPairs, Spacing, bool), most| {
            let texels = self.texels(pairs, record.texels, channels).min(most);
            pairs.specs(spacing, texels, reciprocal)
        };
        if let [only] = choices[..] {
            return Ok((specs(only, usize::MAX), only.2, Vec::new()));
        }
        let trial = Trial::new(material, training, channels, record)?;
        job.begin("choosing angles", choices.len() as u64);
        let tried: Vec<TriedPairs> = choices
            .par_iter()
            .map(|&choice| {
                job.check()?;
                let (pairs, spacing, reciprocal) = choice;
                let error = trial.error(&specs(choice, TRIAL_TEXELS), record.texels)?;
                job.advance(1);
                Ok(TriedPairs { pairs, spacing, reciprocal, error })
            })
            .collect::<Result<_, FitError>>()?;
        let best = tried.iter().min_by(|a, b| a.handicapped().total_cmp(&b.handicapped()));
        let best = best.map_or(choices[0], |best| (best.pairs, best.spacing, best.reciprocal));
        Ok((specs(best, usize::MAX), best.2, tried))
    }
}

impl TriedPairs {
    /// The error by which choices are compared: renderers rely on reciprocity, so that a model without it has to be
    /// better by more than chance.
    fn handicapped(&self) -> f64 {
        const WITHOUT_RECIPROCITY: f64 = 1.05;
        if self.reciprocal { self.error } else { WITHOUT_RECIPROCITY * self.error }
    }
}

/// Pairs that trials are fitted to at most: half of all, which rank choices as well.
const TRIAL_PAIRS: usize = 30_000;

/// Texels that a model of a trial has at most: those of 33.75 KiB in f32. More of them take their time and rank choices alike.
const TRIAL_TEXELS: usize = 2_880;

/// What is fitted and what is compared, to choose by.
enum Trial {
    Drawn { problem: Problem, judge: Judge },
    Rows { problem: Problem, fitted: SampleSet, unseen: SampleSet },
}

impl Trial {
    fn new(
        material: &Material<'_>,
        training: &Training,
        channels: Channels,
        record: &FitSettingsRecord,
    ) -> Result<Self, FactorError> {
        if material.samples().is_some()
            && let Some(choice) = training.for_search(material, channels, record, 2).choice
        {
            let problem = Problem::new(&choice.fitted, &record.params)?;
            return Ok(Self::Rows { problem, fitted: choice.fitted, unseen: choice.unseen });
        }
        // Spread over uniform pairs and those at the highlight alike.
        let every = training.fitted.len().div_ceil(TRIAL_PAIRS).max(2);
        let kept: Vec<usize> = (0..training.fitted.len()).step_by(every).collect();
        Ok(Self::Drawn {
            problem: Problem::new(&training.fitted.select(&kept), &record.params)?,
            judge: Judge::new(material, channels, record.seed, record.params.theta_max),
        })
    }

    /// The error of the model as it would be stored.
    fn error(&self, specs: &[FactorSpec], format: TexelFormat) -> Result<f64, FactorError> {
        let (Self::Drawn { problem, .. } | Self::Rows { problem, .. }) = self;
        let model = factorize_problem(problem, specs)?.model.stored_as(format)?;
        Ok(match self {
            Self::Drawn { judge, .. } => judge.error(&model),
            Self::Rows { fitted, unseen, .. } => error_on(unseen, fitted, &model),
        })
    }
}
