//! Searching for projections on behalf of a fit: which families to try, who wins, when to stop.

use std::time::Instant;

use brdf_factor::{Coordinate, FactorError, FactorParams, FactorSpec, Fit, Problem, TermSolve};
use brdf_factor::{factorize, factorize_terms};
use brdf_job::{Job, StopCause};
use brdf_model::{SampleSet, log_offsets, measure};
use brdf_param::{Projection, Space};
use brdf_search::{
    Family, GreedyParams, JointParams, Objective, SearchError, SearchOutcome, TermOutcome,
    search_greedy, search_joint,
};
use rayon::prelude::*;

use crate::method::StrategyKind;
use crate::record::SearchSettingsRecord;
use crate::training::{Choice, SearchSamples};
use crate::tried::{FamilyRecord, Tried};

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
    /// The best model of one projection, of two, and so on; at least one.
    pub(crate) models: Vec<FoundModel>,
    /// Cause for which a search was stopped, if one was.
    pub(crate) stopped: Option<StopCause>,
    pub(crate) tried: Vec<Tried>,
}

/// The factors of a model and what its projections are of.
#[derive(Clone)]
pub(crate) struct FoundModel {
    pub(crate) family: FamilyRecord,
    pub(crate) specs: Vec<FactorSpec>,
}

impl FoundModel {
    fn new(family: &Family, projections: &[Projection]) -> Self {
        Self { family: family.into(), specs: family.specs(projections) }
    }
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

    /// Runs the search. With several families, each is searched; for each number of terms the model with
    /// the lowest error on the validation samples wins.
    pub(crate) fn run(
        &self,
        families: &[Family],
        samples: &SearchSamples,
        params: &FactorParams,
        seed: u64,
        job: &Job<'_>,
    ) -> Result<Found, SearchError> {
        let search = Search { settings: self, params, seed };
        let Some(choice) = &samples.choice else {
            let family = &families[0];
            let (outcome, this) = search.run(&samples.fitted, family, self.terms, job)?;
            let model = |term: &TermOutcome| FoundModel::new(family, &term.projections);
            let models = outcome.terms.iter().map(model).collect();
            return Ok(Found { models, stopped: outcome.stopped, tried: vec![this] });
        };
        let parts = in_turn(job, &[1.0, if choice.is_complete { 0.0 } else { AGAIN }]);
        let mut tried = Vec::new();
        let mut outcomes = Vec::new();
        for (family, job) in families.iter().zip(in_turn(&parts[0], &vec![1.0; families.len()])) {
            let (outcome, mut this) = search.run(&choice.fitted, family, self.terms, &job)?;
            this.validation = search.validation_errors(choice, family, &outcome)?;
            tried.push(this);
            outcomes.push(outcome);
        }
        let winners = winners(&tried);
        if !choice.is_complete {
            // No further than a family wins.
            let reach = |family| winners.iter().rposition(|w| *w == family).map_or(0, |at| at + 1);
            let reaches: Vec<usize> = (0..families.len()).map(reach).collect();
            let weights: Vec<f64> = reaches.iter().map(|terms| *terms as f64).collect();
            for (index, job) in in_turn(&parts[1], &weights).iter().enumerate() {
                if reaches[index] == 0 {
                    continue;
                }
                let (whole, this) =
                    search.run(&samples.fitted, &families[index], reaches[index], job)?;
                tried.push(this);
                // A search that is stopped early finds fewer; the others remain as they were.
                let outcome: &mut SearchOutcome = &mut outcomes[index];
                outcome.stopped = outcome.stopped.or(whole.stopped);
                for (term, better) in outcome.terms.iter_mut().zip(whole.terms) {
                    *term = better;
                }
            }
        }
        let model = |(index, winner): (usize, &usize)| {
            FoundModel::new(&families[*winner], &outcomes[*winner].terms[index].projections)
        };
        Ok(Found {
            models: winners.iter().enumerate().map(model).collect(),
            stopped: outcomes.iter().find_map(|outcome| outcome.stopped),
            tried,
        })
    }
}

/// Work of searching winners again with all rows, relative to that of the comparison: not every family
/// wins, nor all the way.
const AGAIN: f64 = 0.75;

/// Jobs that follow each other, with these shares of the progress and of the time that is left.
fn in_turn<'a>(job: &Job<'a>, weights: &[f64]) -> Vec<Job<'a>> {
    let begin = Instant::now();
    let limit = job.deadline().map(|end| end.saturating_duration_since(begin));
    let whole: f64 = weights.iter().sum();
    let mut sum = 0.0;
    let parts = job.split_into(weights).into_iter().zip(weights);
    let bounded = parts.map(|(part, weight)| {
        sum += weight;
        match limit {
            Some(limit) => part.with_deadline(begin + limit.mul_f64((sum / whole).min(1.0))),
            None => part,
        }
    });
    bounded.collect()
}

/// For each number of terms, the family with the lowest validation error; the first of equals.
fn winners(tried: &[Tried]) -> Vec<usize> {
    let most = tried.iter().map(|this| this.validation.len()).max().unwrap_or(0);
    let winner = |index: usize| {
        let errors = tried.iter().enumerate();
        let errors = errors.filter_map(|(at, this)| Some((at, *this.validation.get(index)?)));
        errors.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(at, _)| at)
    };
    (0..most).map(winner).collect()
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
        terms: usize,
        job: &Job<'_>,
    ) -> Result<(SearchOutcome, Tried), SearchError> {
        let begin = Instant::now();
        let problem = Problem::new(samples, self.params)?;
        let texture_size = self.params.texture_size.min(SEARCH_SIZE);
        let restarts = self.settings.restarts;
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
            family: family.into(),
            validation: Vec::new(),
            evaluations: outcome.evaluations,
            seconds: begin.elapsed().as_secs_f64(),
        };
        Ok((outcome, tried))
    }

    /// Mean square log error of the model of each number of terms on samples that were not fitted.
    fn validation_errors(
        &self,
        choice: &Choice,
        family: &Family,
        outcome: &SearchOutcome,
    ) -> Result<Vec<f64>, SearchError> {
        let params = FactorParams { terms: self.settings.term_solve(), ..*self.params };
        let models: Vec<Vec<FactorSpec>> =
            outcome.terms.iter().map(|term| family.specs(&term.projections)).collect();
        let offsets = log_offsets(&choice.fitted);
        let fits = fit_models(&choice.fitted, &models, &params)?;
        let error = |fit: &Fit| measure(&choice.unseen, &fit.model, &offsets).log.mean_square;
        Ok(fits.par_iter().map(error).collect())
    }
}

/// The textures of every model: each on its own, or each with the textures that the one before
/// leaves it.
pub(crate) fn fit_models(
    samples: &SampleSet,
    models: &[Vec<FactorSpec>],
    params: &FactorParams,
) -> Result<Vec<Fit>, FactorError> {
    if params.terms == TermSolve::All {
        return models.iter().map(|specs| factorize(samples, specs, params)).collect();
    }
    let mut fits = Vec::new();
    // Models that continue each other come from one pass.
    for run in models.chunk_by(|smaller, larger| larger.starts_with(smaller)) {
        let (first, last) = (&run[0], &run[run.len() - 1]);
        fits.extend(factorize_terms(samples, last, params)?.split_off(first.len() - 1));
    }
    Ok(fits)
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn every_number_of_terms_has_its_own_winner() {
        let tried = |space, validation: &[f64]| Tried {
            family: FamilyRecord { space, reciprocal: true },
            validation: validation.to_vec(),
            evaluations: 0,
            seconds: 0.0,
        };
        let standard = tried(Space::Standard, &[3.0, 2.0, f64::NAN, 1.0]);
        // Stopped after three terms.
        let half = tried(Space::HalfDifference, &[3.0, 1.0, 1.5]);
        assert_eq!(winners(&[standard.clone(), half.clone()]), [0, 1, 1, 0]);
        assert_eq!(winners(&[half, standard]), [0, 0, 0, 1], "the first of equals");
    }

    #[test]
    fn time_is_shared_in_turn() {
        let end = Instant::now() + Duration::from_secs(1000);
        let job = Job::new().with_deadline(end);
        let ends: Vec<f64> = in_turn(&job, &[1.0, 0.0, 3.0])
            .iter()
            .filter_map(|part| Some((end - part.deadline()?).as_secs_f64()))
            .collect();
        for (left, expected) in ends.iter().zip([750.0, 750.0, 0.0]) {
            assert!((left - expected).abs() < 10.0, "{ends:?}");
        }
        assert!(in_turn(&Job::new(), &[1.0]).iter().all(|part| part.deadline().is_none()));
    }
}
