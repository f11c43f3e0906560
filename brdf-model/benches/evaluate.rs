//! Speed of evaluating tables and formulas, one thread.
//!
//! `cargo bench -p brdf-model`. Measured figures stand in ARCHITECTURE.md.

use std::hint::black_box;

use brdf_model::{Brdf, DirectionBatch, MerlLookup, MerlTable, PairSampling, Preset, RgbBatch};
use brdf_param::DirectionPair;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

fn evaluation(c: &mut Criterion) {
    let sampling = PairSampling { count: 100_000, seed: 1, theta_max: 80_f64.to_radians() };
    let pairs: Vec<DirectionPair> = sampling.pairs().collect();
    let paint = Preset::ALL[0].brdf();
    let table = MerlTable::tabulate(&paint);
    let nearest = table.clone().with_lookup(MerlLookup::Nearest);
    let models: [(&str, &dyn Brdf); 3] = [
        ("MERL grid, trilinear", &table),
        ("MERL grid, nearest", &nearest),
        ("Lafortune, three lobes", &paint),
    ];
    let mut group = c.benchmark_group("evaluation, RGB");
    group.throughput(Throughput::Elements(pairs.len() as u64));
    for (name, model) in models {
        group.bench_function(name, |b| {
            b.iter(|| pairs.iter().map(|pair| model.eval(black_box(pair)).r).sum::<f64>());
        });
    }
    let batch: DirectionBatch = pairs.iter().collect();
    let mut out = RgbBatch::default();
    group.bench_function("MERL grid, trilinear, batch", |b| {
        b.iter(|| table.eval_batch(black_box(batch.as_slices()), &mut out));
    });
    group.finish();
}

criterion_group!(benches, evaluation);
criterion_main!(benches);
