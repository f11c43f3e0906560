//! Searching for projections on behalf of `factor`: which families to try, who wins, when to stop.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use brdf_factor::{FactorParams, Problem, TermSolve, factorize, factorize_terms};
use brdf_io::SearchSettings;
use brdf_model::{SampleSet, log_offsets, measure};
use brdf_param::Projection;
use brdf_search::{
    Control, Family, GreedyParams, JointParams, Objective, SearchError, SearchOutcome,
    search_greedy, search_joint,
};
use serde::Serialize;

use crate::numbers::significant;
use crate::progress::Progress;

/// Texels along each side at which projections are searched; larger textures reuse them.
const SEARCH_SIZE: usize = 16;

/// How projections are searched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Strategy {
    /// All projections together.
    Joint,
    /// One after another by Powell's method.
    Powell(Objective),
}

/// A search to run.
pub(crate) struct SearchPlan {
    pub(crate) strategy: Strategy,
    pub(crate) terms: usize,
    /// None for the strategy's own number.
    pub(crate) restarts: Option<usize>,
    /// The families to choose among, at least one.
    pub(crate) families: Vec<Family>,
    /// Planes to start from.
    pub(crate) start: Vec<Projection>,
    pub(crate) seed: u64,
    pub(crate) time_limit: Option<Duration>,
}

/// Samples to search with, and to choose a family by.
pub(crate) struct SearchSamples {
    /// All that is fitted.
    pub(crate) fitted: SampleSet,
    /// What families are compared on, and what is fitted for that: neither is held out, nor do they
    /// overlap.
    pub(crate) choice: Option<Choice>,
}

pub(crate) struct Choice {
    pub(crate) fitted: SampleSet,
    pub(crate) unseen: SampleSet,
    /// The fitted samples are all there are, so that the winner need not be searched again.
    pub(crate) is_complete: bool,
}

/// A family that was tried.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Tried {
    pub(crate) space: &'static str,
    pub(crate) reciprocal: bool,
    /// Mean square log error on the validation pairs; none where there was nothing to choose.
    pub(crate) validation: Option<f64>,
    pub(crate) evaluations: usize,
    pub(crate) seconds: f64,
}

/// What was found, and how.
pub(crate) struct Found {
    pub(crate) family: Family,
    pub(crate) outcome: SearchOutcome,
    pub(crate) tried: Vec<Tried>,
}

impl SearchPlan {
    /// How the textures of several terms are solved for.
    pub(crate) fn term_solve(&self) -> TermSolve {
        match self.strategy {
            Strategy::Joint => TermSolve::All,
            Strategy::Powell(_) => TermSolve::Last(GreedyParams::default().last),
        }
    }

    /// What a record keeps of this plan.
    pub(crate) fn settings(&self) -> SearchSettings {
        let (strategy, objective, restarts) = match self.strategy {
            Strategy::Joint => ("joint", None, JointParams::default().restarts),
            Strategy::Powell(objective) => {
                ("powell", Some(objective), GreedyParams::default().restarts)
            }
        };
        SearchSettings {
            strategy: strategy.to_owned(),
            objective,
            terms: self.terms,
            restarts: self.restarts.unwrap_or(restarts),
            start: self.start.clone(),
        }
    }

    /// Runs the search. With several families, each is searched and the one with the lowest error on
    /// the validation samples wins.
    pub(crate) fn run(
        &self,
        samples: &SearchSamples,
        params: &FactorParams,
        progress: &Progress,
    ) -> Result<Found, SearchError> {
        let begin = Instant::now();
        // Each family gets an equal share of the time; the winner of a choice may be searched again.
        let again = samples.choice.as_ref().is_some_and(|choice| !choice.is_complete);
        let runs = self.families.len() + usize::from(again);
        let share = |run: usize| {
            #[expect(clippy::cast_possible_truncation, reason = "at most five runs")]
            self.time_limit.map(|limit| begin + limit * (run as u32 + 1) / runs as u32)
        };
        let Some(choice) = &samples.choice else {
            let family = &self.families[0];
            let (outcome, tried) =
                self.search(&samples.fitted, family, params, share(0), progress)?;
            return Ok(Found { family: family.clone(), outcome, tried: vec![tried] });
        };
        let mut best: Option<(f64, &Family, SearchOutcome)> = None;
        let mut tried = Vec::new();
        for (run, family) in self.families.iter().enumerate() {
            let (outcome, mut this) =
                self.search(&choice.fitted, family, params, share(run), progress)?;
            let error = self.validation_error(choice, family, &outcome, params)?;
            this.validation = Some(error);
            tried.push(this);
            if best.as_ref().is_none_or(|(lowest, ..)| error < *lowest) {
                best = Some((error, family, outcome));
            }
        }
        let Some((_, family, mut outcome)) = best else { unreachable!("at least one family") };
        if again {
            let (whole, this) =
                self.search(&samples.fitted, family, params, share(runs - 1), progress)?;
            tried.push(this);
            outcome = whole;
        }
        Ok(Found { family: family.clone(), outcome, tried })
    }

    fn search(
        &self,
        samples: &SampleSet,
        family: &Family,
        params: &FactorParams,
        deadline: Option<Instant>,
        progress: &Progress,
    ) -> Result<(SearchOutcome, Tried), SearchError> {
        let begin = Instant::now();
        let problem = Problem::new(samples, params)?;
        let space = family.space.name();
        let stop = || is_interrupted() || deadline.is_some_and(|end| Instant::now() >= end);
        let report = |p: &brdf_search::Progress| {
            progress.step(format!(
                "searching {space}: term {}, start {} of {}, error {}, {} evaluations",
                p.terms,
                p.start,
                p.starts.max(p.start),
                significant(p.best),
                p.evaluations
            ));
        };
        let control = Control { stop: &stop, report: &report };
        let texture_size = params.texture_size.min(SEARCH_SIZE);
        let outcome = match self.strategy {
            Strategy::Joint => {
                let defaults = JointParams::default();
                let params = JointParams {
                    terms: self.terms,
                    texture_size,
                    restarts: self.restarts.unwrap_or(defaults.restarts),
                    start: self.start.clone(),
                    seed: self.seed,
                };
                search_joint(&problem, family, &params, control)?
            }
            Strategy::Powell(objective) => {
                let defaults = GreedyParams::default();
                let params = GreedyParams {
                    terms: self.terms,
                    texture_size,
                    restarts: self.restarts.unwrap_or(defaults.restarts),
                    objective,
                    start: self.start.clone(),
                    seed: self.seed,
                    ..defaults
                };
                search_greedy(&problem, family, &params, control)?
            }
        };
        let tried = Tried {
            space,
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
        params: &FactorParams,
    ) -> Result<f64, SearchError> {
        let params = FactorParams { terms: self.term_solve(), ..*params };
        // There is at least one term.
        let projections = &outcome.terms[outcome.terms.len() - 1].projections;
        let specs = family.specs(projections);
        let fit = match params.terms {
            TermSolve::All => Some(factorize(&choice.fitted, &specs, &params)?),
            TermSolve::Last(_) => factorize_terms(&choice.fitted, &specs, &params)?.pop(),
        };
        let error = |fit: brdf_factor::Fit| {
            measure(&choice.unseen, &fit.model, &log_offsets(&choice.fitted)).log.mean_square
        };
        Ok(fit.map_or(f64::INFINITY, error))
    }
}

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// From now on a first Ctrl-C asks searches to finish, and a second ends the program.
pub(crate) fn finish_on_interrupt() {
    // Without a handler Ctrl-C simply ends the program, which leaves old outputs whole.
    let _ = ctrlc::set_handler(|| {
        if INTERRUPTED.swap(true, Ordering::SeqCst) {
            std::process::exit(130);
        }
    });
}

/// Ctrl-C was pressed.
pub(crate) fn is_interrupted() -> bool {
    INTERRUPTED.load(Ordering::SeqCst)
}
