//! Speed of fits and of batched evaluation, beside a formula in the same run.

use std::hint::black_box;

use brdf_job::Job;
use brdf_model::{Brdf, DirectionBatch, PairSampling, Preset, RgbBatch};
use brdf_spline::{SplineSettings, fit_splines};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

fn evaluate(c: &mut Criterion) {
    const PAIRS: u32 = 65_536;
    let sampling = PairSampling { count: PAIRS, seed: 1, theta_max: 1.4 };
    let pairs: Vec<_> = sampling.pairs().collect();
    let batch: DirectionBatch = pairs.iter().collect();
    let mut values = RgbBatch::default();
    let gold = Preset::find("ggx").expect("a preset").brdf();
    let mut group = c.benchmark_group("evaluate");
    group.throughput(Throughput::Elements(PAIRS.into()));
    group.bench_function("ggx formula", |b| {
        b.iter(|| gold.eval_batch(black_box(batch.as_slices()), &mut values));
    });
    for bytes in [2_700, 8_192, 33_000] {
        let settings = SplineSettings { bytes, ..SplineSettings::default() };
        let model = fit_splines(&gold, &settings, &Job::new()).expect("a fit").model;
        group.bench_function(format!("{bytes} bytes, {} terms", model.terms()), |b| {
            b.iter(|| model.eval_batch(black_box(batch.as_slices()), &mut values));
        });
    }
    group.finish();
}

fn fit(c: &mut Criterion) {
    let gold = Preset::find("ggx").expect("a preset").brdf();
    let mut group = c.benchmark_group("fit");
    group.sample_size(10);
    for bytes in [2_700, 8_192, 33_000] {
        let settings = SplineSettings { bytes, ..SplineSettings::default() };
        group.bench_function(format!("{bytes} bytes"), |b| {
            b.iter(|| fit_splines(black_box(&gold), &settings, &Job::new()));
        });
    }
    group.finish();
}

criterion_group!(benches, evaluate, fit);
criterion_main!(benches);
