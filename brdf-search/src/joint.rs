//! The joint search: all projections of a model together, from many starts, coarse to fine.
//!
//! Sets of projections are compared at a few thousand samples and 12 × 12 texels, with all textures
//! solved for at every step. Sets of one, two and three planes start at random; larger sets grow out of
//! the best ones, by the planes that help most. Starts run in heats: after a few steps those that lag are
//! dropped. The best sets are refined at more samples and texels, the winner on all samples.
//!
//! Some variants did not help: fewer than 12 texels or 3,000 samples, weak smoothing at the coarse level,
//! and every eleventh sample instead of the first of the sequence (all three rank sets by their noise);
//! planes of uniform distribution alone; ranking more sets at the medium level.

use brdf_factor::Problem;
use brdf_job::Job;
use brdf_param::Projection;
use rayon::prelude::*;

use crate::monitor::{Monitor, Stage};
use crate::starts::{canonical_projections, joint_starts, new_planes};
use crate::varpro::{Candidate, Level, Limits, Solved};
use crate::{Family, SearchError, SearchOutcome, TermOutcome};

/// The options of a joint search.
#[derive(Clone, Debug, PartialEq)]
pub struct JointParams {
    /// Largest number of projections, 1 to 8; models of fewer are found on the way.
    pub terms: usize,
    /// Number of texels along each side at which the winner is refined; the textures of the result may be
    /// larger.
    pub texture_size: usize,
    /// Number of random sets of two planes to start from, at least 1; of three planes there are three
    /// quarters as many. With fewer than 30, models of two terms were worse than those of a Powell search.
    pub restarts: usize,
    /// Planes to start from, beside the random ones, such as those of an earlier model.
    pub start: Vec<Projection>,
    /// Seed of the random starts.
    pub seed: u64,
}

impl Default for JointParams {
    fn default() -> Self {
        Self { terms: 5, texture_size: 16, restarts: 40, start: Vec::new(), seed: 1 }
    }
}

/// Texels along each side, and samples, of the levels below the finest. Samples are powers of two,
/// at which a leading part of a Sobol sequence is most even.
const COARSE: (usize, usize) = (12, 4_096);
const MEDIUM: (usize, usize) = (16, 12_288);
/// Smoothing μ at the coarse level, where noise would otherwise decide.
const COARSE_SMOOTHING: f64 = 1e-3;
/// Sets carried from one number of terms to the next.
const BEAM: usize = 4;
/// How many planes compete to become the next of a set.
#[derive(Clone, Copy)]
struct Effort {
    /// Planes tried beside each set.
    tried: usize,
    /// Of those, how many for each set are moved alone.
    moved_alone: usize,
    /// Of those, how many for each set are then moved with the rest.
    moved_together: usize,
}

const GROW: Effort = Effort { tried: 24, moved_alone: 6, moved_together: 2 };
const EXCHANGE: Effort = Effort { tried: 24, moved_alone: 5, moved_together: 1 };
/// Largest number of terms for which random sets compete with grown ones.
const RANDOM_TERMS: usize = 3;
/// Sets whose errors differ by less than this share are taken for the same.
const SAME: f64 = 1e-3;

/// A heat: all candidates take some steps, then the best go on.
#[derive(Clone, Copy)]
struct Heat {
    limits: Limits,
    /// Most candidates that go on.
    keep: usize,
    /// None goes on whose error exceeds this multiple of the best.
    factor: f64,
}

const fn heat(steps: usize, tolerance: f64, keep: usize, factor: f64) -> Heat {
    Heat { limits: Limits { steps, tolerance }, keep, factor }
}

const ALONE: Limits = Limits { steps: 4, tolerance: 1e-2 };
const COARSE_HEATS: [Heat; 2] = [heat(6, 1e-3, 12, 1.6), heat(14, 3e-3, BEAM, 1.5)];
const MEDIUM_HEATS: [Heat; 2] = [heat(2, 1e-3, 2, 1.5), heat(6, 1e-3, 1, 1.5)];
/// For numbers of terms below the largest.
const EARLY_MEDIUM_HEATS: [Heat; 1] = [heat(5, 1e-3, 1, 1.5)];
const FINE_STEPS: usize = 2;
const EARLY_FINE_STEPS: usize = 0;

/// Parts of the search, as its progress names them.
const GROWING: &str = "growing";
const COMPARING: &str = "comparing";
const EXCHANGING: &str = "exchanging";
const REFINING: &str = "refining";
const FINISHING: &str = "finishing";

/// The evaluations that a search should take, and what each costs.
///
/// How many steps a set takes depends on the material: the numbers are means over the presets.
fn plan(problem: &Problem, family: &Family, params: &JointParams) -> Vec<Stage> {
    let cost = |(size, samples): (usize, usize), terms: usize, moved: usize| {
        let readers = if family.reciprocal { 2.0 } else { 1.0 };
        let samples = samples.min(problem.len()) as f64 * readers * readers;
        let unknowns = (size.min(params.texture_size).pow(2) * terms) as f64;
        // Gathering the blocks that move, and a Cholesky factor.
        samples * (moved * terms) as f64 + 2e-5 * unknowns.powi(3)
    };
    let fine = (params.texture_size, problem.len());
    let beam = BEAM as f64;
    let grown = |sets: f64, effort: Effort| {
        sets * (1.0 + effort.tried as f64 + STEPS_ALONE * effort.moved_alone as f64)
    };
    let raced = |starts: f64| STEPS_FIRST * starts + STEPS_SECOND * starts.min(12.0);
    let mut stages = Vec::new();
    let mut stage = |part, terms, evaluations, cost| {
        stages.push(Stage { part, terms, evaluations, cost });
    };
    for terms in 1..=params.terms {
        let starts = random_starts(terms, params).len() as f64;
        let mut sets = raced(starts);
        if terms > 1 {
            stage(GROWING, terms, grown(beam, GROW), cost(COARSE, terms, 1));
            sets += raced(beam * GROW.moved_together as f64);
        }
        stage(COMPARING, terms, sets, cost(COARSE, terms, terms));
        if terms > 1 && terms == params.terms {
            let sets = terms as f64;
            let exchanges = grown(sets, EXCHANGE) + raced(sets * EXCHANGE.moved_together as f64);
            stage(EXCHANGING, terms, exchanges, cost(COARSE, terms, 2));
        }
    }
    for terms in 1..=params.terms {
        let (medium, fine_steps) = if terms == params.terms { (30.0, 4.0) } else { (10.0, 1.0) };
        stage(REFINING, terms, medium, cost(MEDIUM, terms, terms));
        stage(FINISHING, terms, fine_steps, cost(fine, terms, terms));
    }
    stages
}
/// Evaluations of a plane that moves alone, and of a set in the first and the second heat.
const STEPS_ALONE: f64 = 3.5;
const STEPS_FIRST: f64 = 7.0;
const STEPS_SECOND: f64 = 5.0;

/// Returns the projections that fit best together, for every number of terms up to the largest.
///
/// The result does not depend on the number of threads, unless the search is stopped. A search that is
/// stopped returns what it found so far, at least one term. [`TermOutcome::error`] is the weighted mean
/// square of log residuals, with the smoothing terms.
///
/// # Errors
///
/// [`SearchError`] for impossible options, before any work.
#[doc(alias = "homomorphic factorization")]
pub fn search_joint(
    problem: &Problem,
    family: &Family,
    params: &JointParams,
    job: &Job<'_>,
) -> Result<SearchOutcome, SearchError> {
    family.check(problem, params.terms, params.texture_size)?;
    if params.restarts == 0 {
        return Err(SearchError::Option {
            option: "the number of restarts",
            value: "0".to_owned(),
            expected: "1 or more",
        });
    }
    let monitor = Monitor::new(job, plan(problem, family, params));
    // Computed once, so that the levels below take theirs from here.
    problem.points(family.space);
    let beams = coarse_beams(problem, family, params, &monitor)?;
    let terms = refined(problem, family, params, &beams, &monitor)?;
    monitor.end();
    Ok(SearchOutcome { terms, evaluations: monitor.evaluations(), stopped: monitor.stop_cause() })
}

/// The best sets of every number of terms at the coarse level.
fn coarse_beams(
    problem: &Problem,
    family: &Family,
    params: &JointParams,
    monitor: &Monitor<'_>,
) -> Result<Vec<Vec<Candidate>>, SearchError> {
    let coarse_problem = problem.subset(COARSE.1).smoothed(COARSE_SMOOTHING);
    let level = Level::new(&coarse_problem, COARSE.0.min(params.texture_size), family)?;
    let mut beams: Vec<Vec<Candidate>> = Vec::new();
    for terms in 1..=params.terms {
        if terms > 1 && monitor.stopped() {
            break;
        }
        let mut starts = random_starts(terms, params);
        if params.start.len() >= terms {
            starts.push(Candidate::new(params.start[..terms].to_vec()));
        }
        let grown = match beams.last() {
            Some(beam) => {
                monitor.begin(GROWING, terms);
                grow(&level, beam, GROW, params, monitor)?
            }
            None => Vec::new(),
        };
        monitor.begin(COMPARING, terms);
        // Each kind keeps its share of the beam: sets that start together reach minima that growing
        // ones do not, though those may stand lower for now.
        let both = !starts.is_empty() && !grown.is_empty();
        let keep = if both { BEAM / 2 } else { BEAM };
        let mut heats = COARSE_HEATS;
        heats[1].keep = keep;
        let mut beam = race(&level, starts, &heats, monitor)?;
        beam.extend(race(&level, grown, &heats, monitor)?);
        beam.sort_by(|a, b| a.energy.total_cmp(&b.energy));
        if terms == params.terms && terms > 1 && !monitor.stopped() {
            monitor.begin(EXCHANGING, terms);
            beam.extend(exchanged(&level, &beam[0], params, monitor)?);
            beam = select(beam, BEAM, f64::INFINITY);
        }
        beams.push(beam);
    }
    Ok(beams)
}

fn random_starts(terms: usize, params: &JointParams) -> Vec<Candidate> {
    let count = match terms {
        1 => canonical_projections().len() + params.restarts / 5,
        2 => params.restarts,
        RANDOM_TERMS => (3 * params.restarts).div_ceil(4),
        _ => 0,
    };
    joint_starts(terms, count, params.seed).into_iter().map(Candidate::new).collect()
}

/// The best set with each of its planes in turn exchanged for another: what grew plane by plane may
/// have kept one that a later plane makes superfluous.
fn exchanged(
    level: &Level<'_>,
    best: &Candidate,
    params: &JointParams,
    monitor: &Monitor<'_>,
) -> Result<Vec<Candidate>, SearchError> {
    let without = |dropped: usize| {
        let mut rest = best.projections.clone();
        rest.remove(dropped);
        Candidate::new(rest)
    };
    let smaller: Vec<Candidate> = (0..best.projections.len()).map(without).collect();
    let grown = grow(level, &smaller, EXCHANGE, params, monitor)?;
    race(level, grown, &COARSE_HEATS, monitor)
}

/// Every set of a beam with one plane more: of many that are tried, those that help most.
fn grow(
    level: &Level<'_>,
    beam: &[Candidate],
    effort: Effort,
    params: &JointParams,
    monitor: &Monitor<'_>,
) -> Result<Vec<Candidate>, SearchError> {
    let known: Result<Vec<Solved>, _> =
        beam.par_iter().map(|set| level.solve(&set.projections, monitor)).collect();
    let known = known?;
    let terms = beam.first().map_or(0, |set| set.projections.len());
    let mut planes: Vec<(usize, Projection)> = Vec::new();
    for set in 0..beam.len() {
        planes.extend(
            new_planes(effort.tried, params.seed, terms, set).into_iter().map(|p| (set, p)),
        );
        planes.extend(params.start.get(terms).map(|&plane| (set, plane)));
    }
    let energies: Result<Vec<f64>, _> = planes
        .par_iter()
        .map(|&(set, plane)| match monitor.stopped() {
            true => Ok(f64::INFINITY),
            false => level.energy_with(&known[set], plane, monitor),
        })
        .collect();
    let mut order: Vec<(f64, (usize, Projection))> = energies?.into_iter().zip(planes).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    order.truncate(effort.moved_alone * beam.len());
    let moved: Result<Vec<Candidate>, _> = order
        .par_iter()
        .map(|&(_, (set, plane))| level.improve_last(&known[set], plane, ALONE, monitor))
        .collect();
    Ok(select(moved?, effort.moved_together * beam.len(), f64::INFINITY))
}

/// Runs candidates in heats and returns the survivors, best first.
fn race(
    level: &Level<'_>,
    mut candidates: Vec<Candidate>,
    heats: &[Heat],
    monitor: &Monitor<'_>,
) -> Result<Vec<Candidate>, SearchError> {
    for heat in heats {
        let run: Result<Vec<Candidate>, _> = candidates
            .par_iter()
            .enumerate()
            .filter(|(index, _)| *index == 0 || !monitor.stopped())
            .map(|(_, candidate)| {
                let improved = level.improve(candidate, heat.limits, monitor)?;
                monitor.finished(improved.energy);
                Ok::<_, SearchError>(improved)
            })
            .collect();
        candidates = select(run?, heat.keep, heat.factor);
    }
    Ok(candidates)
}

/// The best candidates, best first, at most `keep` and none that repeats a better one.
fn select(mut candidates: Vec<Candidate>, keep: usize, factor: f64) -> Vec<Candidate> {
    candidates.sort_by(|a, b| a.energy.total_cmp(&b.energy));
    let limit = factor * candidates.first().map_or(f64::INFINITY, |best| best.energy);
    let mut kept: Vec<Candidate> = Vec::new();
    for candidate in candidates {
        let is_new = kept.last().is_none_or(|last| candidate.energy > (1.0 + SAME) * last.energy);
        if kept.len() < keep && candidate.energy <= limit && is_new {
            kept.push(candidate);
        }
    }
    kept
}

/// The best set of every number of terms, refined.
fn refined(
    problem: &Problem,
    family: &Family,
    params: &JointParams,
    beams: &[Vec<Candidate>],
    monitor: &Monitor<'_>,
) -> Result<Vec<TermOutcome>, SearchError> {
    let medium_problem = problem.subset(MEDIUM.1);
    let medium = Level::new(&medium_problem, MEDIUM.0.min(params.texture_size), family)?;
    let fine = Level::new(problem, params.texture_size, family)?;
    let mut terms: Vec<TermOutcome> = Vec::new();
    for beam in beams {
        let fresh = |set: &Candidate| Candidate::new(set.projections.clone());
        let last = beam[0].projections.len() == params.terms;
        let (sets, heats, steps): (usize, &[Heat], usize) = if last {
            (BEAM, &MEDIUM_HEATS, FINE_STEPS)
        } else {
            (BEAM / 2, &EARLY_MEDIUM_HEATS, EARLY_FINE_STEPS)
        };
        monitor.begin(REFINING, beam[0].projections.len());
        let sets = beam.iter().take(sets).map(fresh).collect();
        let best = race(&medium, sets, heats, monitor)?.swap_remove(0);
        let limits = Limits { steps, tolerance: 1e-3 };
        monitor.begin(FINISHING, beam[0].projections.len());
        let best = fine.improve(&fresh(&best), limits, monitor)?;
        terms.push(TermOutcome { projections: best.projections, error: best.energy });
    }
    Ok(terms)
}
