//! Searching for projections on behalf of a fit: which families to try, who wins, when to stop.

use std::time::Instant;

use brdf_factor::{Coordinate, FactorParams, FactorSpec, Fit, Problem, TermSolve};
use brdf_factor::{factorize, factorize_terms};
use brdf_job::Job;
use brdf_model::{SampleSet, log_offsets, measure};
use brdf_param::{Projection, Space};
use brdf_search::{
    Family, GreedyParams, JointParams, Objective, SearchError, SearchOutcome, search_greedy,
    search_joint,
};

use crate::method::StrategyKind;
use crate::record::SearchSettingsRecord;
use crate::training::{Choice, SearchSamples};
use crate::tried::Tried;

/// Texels along each side at which projections are searched; larger textures reuse them.
const SEARCH_SIZE: usize = 16;

/// How projections are searched.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Strategy {
    /// All projections together, by gradients, from many starts.
    #[default]
    Joint,
    /// One after another by Powell's method, as in the thesis, minimizing this.
    Powell(Objective),
}

/// Factors of given coordinates that stand beside the searched ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FixedFactors {
    /// p(wi) q(h) p(wo).
    McCool,
    /// p(|wi⊥|) q(|h⊥|) p(|wo⊥|).
    Radial,
    /// The half vector.
    H,
    /// The difference vector.
    D,
}

impl FixedFactors {
    /// Returns the factors.
    pub fn specs(self, reciprocal: bool) -> Vec<FactorSpec> {
        let one = |coordinate| {
            if reciprocal {
                FactorSpec::reciprocal(coordinate)
            } else {
                FactorSpec::single(coordinate)
            }
        };
        match self {
            Self::McCool => FactorSpec::mccool(reciprocal),
            Self::Radial => FactorSpec::radial(reciprocal),
            Self::H => vec![one(Coordinate::H)],
            Self::D => vec![one(Coordinate::D)],
        }
    }
}

/// What is searched.
#[derive(Clone, Debug, PartialEq)]
pub struct SearchSettings {
    /// How.
    pub strategy: Strategy,
    /// Largest number of projections, 1 to 8; models of fewer are found too.
    pub terms: usize,
    /// Random starts; none for the strategy's own number.
    pub restarts: Option<usize>,
    /// Spaces to choose among, at least one.
    pub spaces: Vec<Space>,
    /// Planes to start from beside the others.
    pub start: Vec<Projection>,
    /// Factors that every model has beside the searched ones.
    pub fixed: Option<FixedFactors>,
}

impl Default for SearchSettings {
    fn default() -> Self {
        Self {
            strategy: Strategy::Joint,
            terms: 5,
            restarts: None,
            spaces: vec![Space::Standard, Space::HalfDifference],
            start: Vec::new(),
            fixed: None,
        }
    }
}

/// What was found, and how.
pub(crate) struct Found {
    pub(crate) family: Family,
    pub(crate) outcome: SearchOutcome,
    pub(crate) tried: Vec<Tried>,
}

impl SearchSettings {
    /// How the textures of several terms are solved for.
    pub(crate) fn term_solve(&self) -> TermSolve {
        match self.strategy {
            Strategy::Joint => TermSolve::All,
            Strategy::Powell(_) => TermSolve::Last(GreedyParams::default().last),
        }
    }

    /// What a record keeps of this.
    pub(crate) fn record(&self) -> SearchSettingsRecord {
        let (strategy, objective, restarts) = match self.strategy {
            Strategy::Joint => (StrategyKind::Joint, None, JointParams::default().restarts),
            Strategy::Powell(objective) => {
                (StrategyKind::Powell, Some(objective), GreedyParams::default().restarts)
            }
        };
        SearchSettingsRecord {
            strategy,
            objective,
            terms: self.terms,
            restarts: self.restarts.unwrap_or(restarts),
            start: self.start.clone(),
        }
    }

    /// The families to choose among.
    pub(crate) fn families(&self, reciprocal: &[bool]) -> Vec<Family> {
        let fixed = |reciprocal| self.fixed.map_or_else(Vec::new, |fixed| fixed.specs(reciprocal));
        self.spaces
            .iter()
            .flat_map(|&space| {
                reciprocal.iter().map(move |&reciprocal| Family {
                    space,
                    reciprocal,
                    fixed: fixed(reciprocal),
                })
            })
            .collect()
    }

    /// Runs the search. With several families, each is searched and the one with the lowest error on
    /// the validation samples wins.
    pub(crate) fn run(
        &self,
        families: &[Family],
        samples: &SearchSamples,
        params: &FactorParams,
        seed: u64,
        job: &Job<'_>,
    ) -> Result<Found, SearchError> {
        let begin = Instant::now();
        let limit = job.deadline().map(|end| end.saturating_duration_since(begin));
        // Each family gets an equal share of the time; the winner of a choice may be searched again.
        let again = samples.choice.as_ref().is_some_and(|choice| !choice.is_complete);
        let runs = families.len() + usize::from(again);
        let mut jobs = job.split_into(&vec![1.0; runs]);
        if let Some(limit) = limit {
            #[expect(clippy::cast_possible_truncation, reason = "at most five runs")]
            let end = |run: usize| begin + limit * (run as u32 + 1) / runs as u32;
            let bounded = jobs.into_iter().enumerate();
            jobs = bounded.map(|(run, job)| job.with_deadline(end(run))).collect();
        }
        let search = Search { settings: self, params, seed };
        let Some(choice) = &samples.choice else {
            let family = &families[0];
            let (outcome, tried) = search.run(&samples.fitted, family, &jobs[0])?;
            return Ok(Found { family: family.clone(), outcome, tried: vec![tried] });
        };
        let mut best: Option<(f64, &Family, SearchOutcome)> = None;
        let mut tried = Vec::new();
        for (family, job) in families.iter().zip(&jobs) {
            let (outcome, mut this) = search.run(&choice.fitted, family, job)?;
            let error = search.validation_error(choice, family, &outcome)?;
            this.validation = Some(error);
            tried.push(this);
            if best.as_ref().is_none_or(|(lowest, ..)| error < *lowest) {
                best = Some((error, family, outcome));
            }
        }
        let Some((_, family, mut outcome)) = best else { unreachable!("at least one family") };
        if again {
            let (whole, this) = search.run(&samples.fitted, family, &jobs[runs - 1])?;
            tried.push(this);
            outcome = whole;
        }
        Ok(Found { family: family.clone(), outcome, tried })
    }
}

/// What all searches of a choice share.
struct Search<'a> {
    settings: &'a SearchSettings,
    params: &'a FactorParams,
    seed: u64,
}

impl Search<'_> {
    fn run(
        &self,
        samples: &SampleSet,
        family: &Family,
        job: &Job<'_>,
    ) -> Result<(SearchOutcome, Tried), SearchError> {
        let begin = Instant::now();
        let problem = Problem::new(samples, self.params)?;
        let texture_size = self.params.texture_size.min(SEARCH_SIZE);
        let SearchSettings { terms, restarts, .. } = *self.settings;
        let (start, seed) = (self.settings.start.clone(), self.seed);
        let outcome = match self.settings.strategy {
            Strategy::Joint => {
                let restarts = restarts.unwrap_or(JointParams::default().restarts);
                let params = JointParams { terms, texture_size, restarts, start, seed };
                search_joint(&problem, family, &params, job)?
            }
            Strategy::Powell(objective) => {
                let defaults = GreedyParams::default();
                let restarts = restarts.unwrap_or(defaults.restarts);
                let params = GreedyParams {
                    terms,
                    texture_size,
                    restarts,
                    objective,
                    start,
                    seed,
                    ..defaults
                };
                search_greedy(&problem, family, &params, job)?
            }
        };
        let tried = Tried {
            space: family.space,
            reciprocal: family.reciprocal,
            validation: None,
            evaluations: outcome.evaluations,
            seconds: begin.elapsed().as_secs_f64(),
        };
        Ok((outcome, tried))
    }

    /// Mean square log error of the largest model on samples that were not fitted.
    fn validation_error(
        &self,
        choice: &Choice,
        family: &Family,
        outcome: &SearchOutcome,
    ) -> Result<f64, SearchError> {
        let params = FactorParams { terms: self.settings.term_solve(), ..*self.params };
        // There is at least one term.
        let projections = &outcome.terms[outcome.terms.len() - 1].projections;
        let specs = family.specs(projections);
        let fit = match params.terms {
            TermSolve::All => Some(factorize(&choice.fitted, &specs, &params)?),
            TermSolve::Last(_) => factorize_terms(&choice.fitted, &specs, &params)?.pop(),
        };
        let error = |fit: Fit| {
            measure(&choice.unseen, &fit.model, &log_offsets(&choice.fitted)).log.mean_square
        };
        Ok(fit.map_or(f64::INFINITY, error))
    }
}
