//! The greedy search: one term after another, each by Powell's method from several starts.
//!
//! Source: Cole 2002, section 3.1.

use brdf_factor::{FactorError, Problem};
use brdf_job::Job;
use brdf_param::{Projection, Space};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::monitor::{Monitor, Stage};
use crate::random::StartRng;
use crate::starts::canonical_projections;
use crate::varpro::{Level, Solved};
use crate::{
    Family, PowellParams, Rotation4, SearchError, SearchOutcome, TermOutcome, minimize_rotation,
};

/// The error that a greedy search minimizes (Cole 2002, section 3.1.4).
///
/// Textures are always least-squares solutions in logarithms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Objective {
    /// Weighted mean square of log residuals, smoothing terms included.
    #[default]
    Relative,
    /// Mean square of linear residuals, sr⁻².
    Absolute,
    /// Mean of |log residual| + |linear residual|.
    Blend,
}

/// The options of a greedy search.
#[derive(Clone, Debug, PartialEq)]
pub struct GreedyParams {
    /// Number of projections, 1 to 8.
    pub terms: usize,
    /// Number of texels along each side of a texture during the search.
    pub texture_size: usize,
    /// Number of random starts of every term; at least 1.
    pub restarts: usize,
    /// Whether every term starts from canonical planes too: the first direction, the second, and their
    /// sum; of `wi` and `wo` in a reciprocal search only one, since they share a texture. Cole 2002 calls
    /// them good guesses, but measures with random ones alone.
    pub canonical_starts: bool,
    /// Number of factors whose textures are solved for together, the new one included; at least 1. Earlier
    /// ones keep theirs. Cole 2002 finds 2 much better than 1, and more hardly better than 2.
    pub last: usize,
    /// Error that is minimized.
    pub objective: Objective,
    /// Options of each descent.
    pub powell: PowellParams,
    /// Planes to start from, one for each term, beside the other starts, such as those of an earlier model.
    pub start: Vec<Projection>,
    /// Seed of the random starts.
    pub seed: u64,
}

impl Default for GreedyParams {
    fn default() -> Self {
        Self {
            terms: 5,
            texture_size: 16,
            restarts: 6,
            canonical_starts: true,
            last: 2,
            objective: Objective::Relative,
            powell: PowellParams::default(),
            start: Vec::new(),
            seed: 1,
        }
    }
}

/// Number of canonical starts of every term: the first direction, the second, and their sum.
const CANONICAL: usize = 3;

/// Returns the models found by adding one projection after another, each the best of several Powell
/// descents over rotations.
///
/// The result does not depend on the number of threads, unless the search is stopped. A search that is
/// stopped returns what it found so far, at least one term. [`TermOutcome::error`] is the
/// [`Objective`]. Source: Cole 2002, section 3.1.
///
/// # Errors
///
/// [`SearchError`] for impossible options, before any work.
#[doc(alias = "homomorphic factorization")]
#[doc(alias = "Powell")]
pub fn search_greedy(
    problem: &Problem,
    family: &Family,
    params: &GreedyParams,
    job: &Job<'_>,
) -> Result<SearchOutcome, SearchError> {
    family.check(problem, params.terms, params.texture_size)?;
    for (option, value) in [
        ("the number of restarts", params.restarts),
        ("the number of terms solved together", params.last),
    ] {
        if value == 0 {
            return Err(SearchError::Option {
                option,
                value: "0".to_owned(),
                expected: "1 or more",
            });
        }
    }
    let monitor = Monitor::new(job, plan(problem, family, params));
    let mut greedy = Greedy {
        // Factors whose textures may still change: fixed ones first, then searched ones.
        active: Family { fixed: family.fixed.clone(), ..*family },
        problem: problem.clone(),
        explained: vec![vec![0.0; problem.len()]; problem.targets().len()],
        params,
        monitor: &monitor,
    };
    let mut terms: Vec<TermOutcome> = Vec::new();
    while terms.len() < params.terms && (terms.is_empty() || !monitor.stopped()) {
        let (plane, error) = greedy.next_term(terms.len())?;
        let mut projections = terms.last().map_or(Vec::new(), |term| term.projections.clone());
        projections.push(plane);
        terms.push(TermOutcome { projections, error });
    }
    monitor.end();
    Ok(SearchOutcome { terms, evaluations: monitor.evaluations(), stopped: monitor.stop_cause() })
}

/// The one part of this search, as its progress names it.
const ADDING: &str = "adding";

/// The evaluations that a search should take: a mean number for each descent, measured on presets.
fn plan(problem: &Problem, family: &Family, params: &GreedyParams) -> Vec<Stage> {
    let stage = |term: usize| {
        let starts = starts(family.space, family.reciprocal, params, term).len() as f64;
        // Textures that are solved for together; only the last ones move.
        let factors = (family.fixed.len() + term + 1).min(params.last) as f64;
        let unknowns = factors * (params.texture_size * params.texture_size) as f64;
        Stage {
            part: ADDING,
            terms: term + 1,
            evaluations: starts * DESCENT + 2.0,
            cost: 4.0 * problem.len() as f64 * factors + 2e-5 * unknowns.powi(3),
        }
    };
    (0..params.terms).map(stage).collect()
}

/// Evaluations of a descent.
const DESCENT: f64 = 270.0;

/// The places from which the descents of a term start.
fn starts(space: Space, reciprocal: bool, params: &GreedyParams, term: usize) -> Vec<Rotation4> {
    let mut canonical = canonical_projections();
    canonical.truncate(if params.canonical_starts { CANONICAL } else { 0 });
    if reciprocal && space == Space::Standard {
        // A texture that is read at wi is read at wo too.
        canonical.retain(|plane| *plane != Projection::SECOND);
    }
    let planes = params.start.get(term).copied().into_iter().chain(canonical);
    let mut starts: Vec<Rotation4> =
        planes.map(|plane| Rotation4::from_projection(&plane)).collect();
    let mut rng = StartRng::new(params.seed, 201, term as u64);
    starts.extend((0..params.restarts).map(|_| rng.rotation()));
    starts
}

struct Greedy<'a, 'm> {
    active: Family,
    /// Less what factors with final textures explain.
    problem: Problem,
    /// What they explain, per channel and sample.
    explained: Vec<Vec<f64>>,
    params: &'a GreedyParams,
    monitor: &'a Monitor<'m>,
}

impl Greedy<'_, '_> {
    /// The best next projection, and the error with it.
    fn next_term(&mut self, index: usize) -> Result<(Projection, f64), SearchError> {
        self.monitor.begin(ADDING, index + 1);
        let level = Level::new(&self.problem, self.params.texture_size, &self.active)?;
        let known = level.solve(&[], self.monitor)?;
        let starts = starts(self.active.space, self.active.reciprocal, self.params, index);
        let minima: Result<Vec<(Projection, f64)>, SearchError> = starts
            .par_iter()
            .enumerate()
            .filter(|(start, _)| *start == 0 || !self.monitor.stopped())
            .map(|(_, start)| self.descend(&level, &known, start))
            .collect();
        // The first of equals, so that the number of threads does not matter.
        let best = minima?.into_iter().reduce(|a, b| if b.1 < a.1 { b } else { a });
        let Some((plane, error)) = best else { unreachable!("there is always a first start") };
        let chosen = level.solve_after(&known, 0, &[plane], self.monitor)?;
        let retired = (self.active.fixed.len() + 1).saturating_sub(self.params.last - 1);
        let given = level.explained_by(&chosen, retired);
        drop((level, known));
        self.retire(retired, plane, &given);
        Ok((plane, error))
    }

    /// Lets the first factors keep their textures for good.
    fn retire(&mut self, count: usize, plane: Projection, given: &[Vec<f64>]) {
        let next = self.active.spec(plane);
        self.active.fixed.push(next);
        self.active.fixed.drain(..count);
        for (total, part) in self.explained.iter_mut().zip(given) {
            total.iter_mut().zip(part).for_each(|(total, part)| *total += part);
        }
        self.problem = self.problem.subtract(given);
    }

    /// One descent; once the search is stopped, every further place looks infinitely bad.
    fn descend(
        &self,
        level: &Level<'_>,
        known: &Solved,
        start: &Rotation4,
    ) -> Result<(Projection, f64), SearchError> {
        let mut failure: Option<FactorError> = None;
        let mut first = true;
        let error = |rotation: &Rotation4| {
            if failure.is_some() || (self.monitor.stopped() && !first) {
                return f64::INFINITY;
            }
            first = false;
            match self.error(level, known, rotation.projection()) {
                Ok(error) => error,
                Err(problem) => {
                    failure = Some(problem);
                    f64::INFINITY
                }
            }
        };
        let minimum = minimize_rotation(error, start, &self.params.powell);
        if let Some(problem) = failure {
            return Err(problem.into());
        }
        self.monitor.finished(minimum.value);
        Ok((minimum.rotation.projection(), minimum.value))
    }

    fn error(
        &self,
        level: &Level<'_>,
        known: &Solved,
        plane: Projection,
    ) -> Result<f64, FactorError> {
        if self.params.objective == Objective::Relative {
            return level.energy_with(known, plane, self.monitor);
        }
        let set = level.solve_after(known, 0, &[plane], self.monitor)?;
        let factors = self.active.fixed.len() + 1;
        let given = level.explained_by(&set, factors);
        let mut sum = 0.0;
        for (channel, map) in self.problem.maps().iter().enumerate() {
            let values = &self.problem.values()[channel];
            for (sample, &f) in values.iter().enumerate() {
                let fitted = self.explained[channel][sample] + given[channel][sample];
                let linear = map.inverse(fitted).max(0.0) - f;
                sum += match self.params.objective {
                    Objective::Absolute => linear * linear,
                    Objective::Relative | Objective::Blend => {
                        linear.abs() + (fitted - map.forward(f)).abs()
                    }
                };
            }
        }
        let count = (self.problem.len() * self.problem.maps().len()) as f64;
        Ok(sum / count)
    }
}
