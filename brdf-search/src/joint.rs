//! The joint search: all projections of a model together, from many starts, coarse to fine.

use brdf_factor::{FactorError, FactorSpec, Problem};
use brdf_param::{Projection, Space};
use rayon::prelude::*;

use crate::control::{Control, Monitor};
use crate::random::StartRng;
use crate::starts::{canonical_projections, joint_starts};
use crate::varpro::{Descent, Level, Solved};

/// Effort of a joint search.
#[derive(Clone, Debug, PartialEq)]
pub struct JointParams {
    pub coarse: (usize, usize),
    pub coarse_mu: f64,
    pub medium: (usize, usize),
    pub fine_size: usize,
    pub starts: Vec<usize>,
    pub screened: usize,
    pub extended: usize,
    pub screen_keep: usize,
    pub screen_steps: usize,
    pub beam: usize,
    pub rounds: Vec<(usize, usize, f64)>,
    pub tol: f64,
    pub medium_rounds: Vec<(usize, usize, f64)>,
    pub early_rounds: Vec<(usize, usize, f64)>,
    pub fine_steps: usize,
    pub seed: u64,
}

impl Default for JointParams {
    fn default() -> Self {
        Self {
            coarse: (12, 4000),
            coarse_mu: 1e-3,
            medium: (16, 12_000),
            fine_size: 16,
            starts: vec![16, 40, 30],
            screened: 32,
            extended: 3,
            screen_keep: 12,
            screen_steps: 6,
            beam: 4,
            rounds: vec![(6, 16, 1.6), (14, 4, 1.6)],
            tol: 1e-3,
            medium_rounds: vec![(3, 2, 1.5), (6, 1, 1.5)],
            early_rounds: vec![(4, 1, 1.5)],
            fine_steps: 2,
            seed: 1,
        }
    }
}

fn rounds(level: &Level, sets: Vec<Solved>, rounds: &[(usize, usize, f64)], tol: f64, monitor: &Monitor) -> Result<Vec<Solved>, FactorError> {
    let mut runs: Vec<Descent> = sets.into_iter().map(|s| Descent::new(s, 0)).collect();
    for &(steps, keep, params_factor) in rounds {
        runs.par_iter_mut().try_for_each(|run| level.descend(run, steps, tol, monitor))?;
        runs.sort_by(|a, b| a.set.energy.total_cmp(&b.set.energy));
        let mut kept: Vec<Descent> = Vec::new();
        let limit = params_factor * runs[0].set.energy;
        for run in runs {
            let distinct = kept.iter().all(|k| (run.set.energy - k.set.energy).abs() > 1e-3 * k.set.energy);
            if kept.len() < keep && distinct && run.set.energy <= limit { kept.push(run); }
        }
        runs = kept;
    }
    Ok(runs.into_iter().map(|r| r.set).collect())
}

pub fn search_joint(
    problem: &Problem,
    space: Space,
    reciprocal: bool,
    fixed: &[FactorSpec],
    terms: usize,
    params: &JointParams,
    control: Control<'_>,
) -> Result<Vec<(Vec<Projection>, f64)>, FactorError> {
    let monitor = Monitor::new(control);
    problem.points(space);
    let verbose = std::env::var("VERBOSE").is_ok();
    let clock = std::time::Instant::now();
    let coarse_problem = problem.thinned(params.coarse.1).smoothed(params.coarse_mu);
    let coarse = Level::new(&coarse_problem, params.coarse.0, (space, reciprocal), fixed)?;
    let mut beams: Vec<Vec<Vec<Projection>>> = Vec::new();
    let mut beam: Vec<Solved> = vec![coarse.solve(&[], &monitor)?];
    for k in 1..=terms {
        let starts = joint_starts(k, params.starts.get(k - 1).copied().unwrap_or(0), params.seed);
        let sets: Result<Vec<Solved>, FactorError> = starts.par_iter().map(|s| coarse.solve(s, &monitor)).collect();
        let mut sets = sets?;
        if k > 1 {
            let candidates: Vec<(usize, Projection)> = (0..beam.len()).flat_map(|b| {
                let mut list = canonical_projections();
                let mut rng = StartRng::new(params.seed, 100 + k as u64, b as u64);
                while list.len() < params.screened { list.push(rng.projection()); }
                list.into_iter().map(move |p| (b, p))
            }).collect();
            let screened: Result<Vec<Descent>, FactorError> = candidates.par_iter().map(|&(b, p)| Ok(Descent::new(coarse.solve_after(&beam[b], k - 1, &[p], &monitor)?, k - 1))).collect();
            let mut screened = screened?;
            screened.sort_by(|a, b| a.set.energy.total_cmp(&b.set.energy));
            screened.truncate(params.screen_keep * beam.len());
            screened.par_iter_mut().try_for_each(|run| coarse.descend(run, params.screen_steps, 1e-2, &monitor))?;
            screened.sort_by(|a, b| a.set.energy.total_cmp(&b.set.energy));
            let mut kept: Vec<Solved> = Vec::new();
            for run in screened {
                let distinct = kept.iter().all(|k| (run.set.energy - k.energy).abs() > 1e-3 * k.energy);
                if kept.len() < params.extended * beam.len() && distinct { kept.push(run.set); }
            }
            if verbose { eprintln!("screen {:.5?} evals {} {:.2?}", kept.iter().take(5).map(|b| b.energy).collect::<Vec<_>>(), monitor.evaluations(), clock.elapsed()); }
            sets.extend(kept);
        }
        beam = rounds(&coarse, sets, &params.rounds, params.tol, &monitor)?;
        if verbose { eprintln!("coarse k={k} {:.5?} evals {} {:.2?}", beam.iter().map(|b| b.energy).collect::<Vec<_>>(), monitor.evaluations(), clock.elapsed()); }
        beams.push(beam.iter().map(|s| s.projections.clone()).collect());
    }
    let medium_problem = problem.thinned(params.medium.1);
    let medium = Level::new(&medium_problem, params.medium.0, (space, reciprocal), fixed)?;
    let fine = Level::new(problem, params.fine_size, (space, reciprocal), fixed)?;
    let mut out = Vec::new();
    for sets in &beams {
        let sets: Result<Vec<Solved>, FactorError> = sets.iter().take(if sets[0].len() == terms { 9 } else { 2 }).collect::<Vec<_>>().par_iter().map(|s| medium.solve(s, &monitor)).collect();
        let last = sets.as_ref().unwrap()[0].projections.len() == terms;
        let refined = rounds(&medium, sets?, if last { &params.medium_rounds } else { &params.early_rounds }, params.tol, &monitor)?;
        let best = &refined[0];
        if verbose { eprintln!("medium {:.5} evals {} {:.2?}", best.energy, monitor.evaluations(), clock.elapsed()); }
        let mut end = Descent::new(fine.solve(&best.projections, &monitor)?, 0);
        fine.descend(&mut end, if last { params.fine_steps } else { 1 }, params.tol, &monitor)?;
        if verbose { eprintln!("fine {:.5} evals {} {:.2?}", end.set.energy, monitor.evaluations(), clock.elapsed()); }
        out.push((end.set.projections.clone(), end.set.energy));
    }
    Ok(out)
}
