//! Speed of one evaluation on one thread, and of whole searches.
//!
//! `cargo bench -p brdf-search`. Measured figures stand in ARCHITECTURE.md.

use std::hint::black_box;
use std::sync::Arc;

use brdf_factor::{FactorError, FactorParams, NormalEquations, Problem};
use brdf_job::Job;
use brdf_model::{Channels, PairSampling, Preset, SampleSet};
use brdf_param::{Projection, Space};
use brdf_search::{Family, JointParams, canonical_projections, search_joint};
use criterion::{Criterion, criterion_group, criterion_main};
use faer::MatMut;

fn samples(count: u32) -> SampleSet {
    let paint = Preset::ALL[0].brdf();
    let sampling = PairSampling { count, seed: 1, theta_max: 80_f64.to_radians() };
    SampleSet::draw(&paint, &sampling, Channels::Luminance)
}

/// What every evaluation does: place the samples, gather the normal equations, solve them.
fn evaluate(problem: &Problem, family: &Family, planes: &[Projection]) -> Result<f64, FactorError> {
    let mut columns = Vec::new();
    for spec in family.specs(planes) {
        columns.push(Arc::new(problem.columns(&problem.empty_factor(&spec, 16)?)));
    }
    let equations = NormalEquations::new(columns, problem.weights());
    let factor = equations.factorize(Vec::new())?;
    let mut side = Vec::new();
    for columns in equations.columns() {
        let mut own = vec![0.0; columns.unknowns()];
        columns.add_transposed(&problem.targets()[0], &mut own);
        side.extend(own);
    }
    let unknowns = side.len();
    let mut solution = side.clone();
    factor.solve_in_place(MatMut::from_column_major_slice_mut(&mut solution, unknowns, 1));
    Ok(solution.iter().zip(&side).map(|(x, y)| x * y).sum())
}

fn evaluations(c: &mut Criterion) {
    let samples = samples(45_000);
    let params = FactorParams { texture_size: 16, ..FactorParams::default() };
    let Ok(problem) = Problem::new(&samples, &params) else { unreachable!("there are samples") };
    let canonical = canonical_projections();
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let Ok(pool) = one_thread else { unreachable!("a pool of one thread") };
    let mut group = c.benchmark_group("one evaluation, 45,000 samples, 16², one thread");
    group.sample_size(20);
    for (terms, reciprocal) in [(2, false), (2, true), (5, false), (5, true)] {
        let family = Family::new(Space::Standard, reciprocal);
        let kind = if reciprocal { "reciprocal" } else { "free" };
        let planes = &canonical[2..2 + terms];
        group.bench_function(format!("{terms} terms, {kind}"), |b| {
            pool.install(|| b.iter(|| evaluate(black_box(&problem), &family, planes)));
        });
    }
    group.finish();
}

fn searches(c: &mut Criterion) {
    let samples = samples(45_000);
    let params = FactorParams { texture_size: 16, ..FactorParams::default() };
    let Ok(problem) = Problem::new(&samples, &params) else { unreachable!("there are samples") };
    let mut group = c.benchmark_group("joint search, 45,000 samples, 16², reciprocal");
    group.sample_size(10);
    for terms in [2, 5] {
        let search = JointParams { terms, ..JointParams::default() };
        let family = Family::new(Space::Standard, true);
        group.bench_function(format!("{terms} terms"), |b| {
            b.iter(|| search_joint(&problem, &family, &search, &Job::new()));
        });
    }
    group.finish();
}

criterion_group!(benches, evaluations, searches);
criterion_main!(benches);
