//! Speed of fitting and of evaluating factored models, one thread.
//!
//! `cargo bench -p brdf-factor`. Measured figures stand in ARCHITECTURE.md.

use std::hint::black_box;

use brdf_factor::{FactorParams, FactorSpec, IsotropicPairs, Spacing, factorize};
use brdf_model::{Brdf, Channels, DirectionBatch, PairSampling, Preset, RgbBatch, SampleSet};
use brdf_param::{DirectionPair, Projection, Space};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

fn samples(count: u32) -> SampleSet {
    let paint = Preset::ALL[0].brdf();
    let sampling = PairSampling { count, seed: 1, theta_max: 80_f64.to_radians() };
    SampleSet::draw(&paint, &sampling, Channels::Rgb)
}

fn fitting(c: &mut Criterion) {
    let mut group = c.benchmark_group("mccool, RGB, Cholesky");
    group.sample_size(10);
    for (count, texture_size) in [(45_000, 16), (45_000, 32), (200_000, 32)] {
        let samples = samples(count);
        let params = FactorParams { texture_size, ..FactorParams::default() };
        group.bench_function(format!("{count} samples, {texture_size}²"), |b| {
            b.iter(|| factorize(black_box(&samples), &FactorSpec::mccool(true), &params));
        });
    }
    group.finish();
}

fn evaluation(c: &mut Criterion) {
    let samples = samples(45_000);
    let params = FactorParams::default();
    let fit = |specs: &[FactorSpec]| match factorize(&samples, specs, &params) {
        Ok(fit) => fit.model,
        Err(error) => unreachable!("the built-in material can be fitted: {error}"),
    };
    let planes = [Projection::FIRST, Projection::SECOND];
    let models = [
        ("mccool, two textures, three lookups", fit(&FactorSpec::mccool(true))),
        ("two projections, standard", {
            fit(&FactorSpec::projections(Space::Standard, &planes, false))
        }),
        ("two projections, half/difference, reciprocal", {
            fit(&FactorSpec::projections(Space::HalfDifference, &planes, true))
        }),
        ("angles, polar, evenly spaced, four lookups", {
            fit(&IsotropicPairs::Polar.specs(Spacing::Linear, 2_880, true))
        }),
        ("angles, cartesian, spaced by a power, five lookups", {
            fit(&IsotropicPairs::Cartesian.specs(Spacing::Power { exponent: 0.75 }, 2_880, true))
        }),
    ];
    let pairs: Vec<DirectionPair> = samples.pairs().collect();
    let batch: DirectionBatch = pairs.iter().collect();
    let mut out = RgbBatch::default();
    let mut group = c.benchmark_group("evaluation, RGB");
    group.throughput(Throughput::Elements(pairs.len() as u64));
    for (name, model) in &models {
        group.bench_function(format!("{name}, batch"), |b| {
            b.iter(|| model.eval_batch(black_box(batch.as_slices()), &mut out));
        });
    }
    let ggx = Preset::find("ggx").map(|preset| preset.brdf());
    if let Some(ggx) = &ggx {
        group.bench_function("the GGX formula, single, for comparison", |b| {
            b.iter(|| pairs.iter().map(|pair| ggx.eval(black_box(pair)).r).sum::<f64>());
        });
    }
    group.bench_function("mccool, two textures, three lookups, single", |b| {
        b.iter(|| pairs.iter().map(|pair| models[0].1.eval(black_box(pair)).r).sum::<f64>());
    });
    group.finish();
}

criterion_group!(benches, fitting, evaluation);
criterion_main!(benches);
