//! Speed of reading files, one thread.
//!
//! `cargo bench -p brdf-io`. Measured figures stand in ARCHITECTURE.md.

use std::hint::black_box;

use brdf_io::{ReadOptions, read, write_merl, write_samples};
use brdf_model::{Channels, MerlTable, PairSampling, Preset, SampleSet};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

fn reading(c: &mut Criterion) {
    let paint = Preset::ALL[0].brdf();
    let sampling = PairSampling { count: 45_000, seed: 1, theta_max: 80_f64.to_radians() };
    let files = [
        ("MERL table", write_merl(&MerlTable::tabulate(&paint))),
        ("CSV, 45,000 rows", {
            write_samples(&SampleSet::draw(&paint, &sampling, Channels::Rgb)).into_bytes()
        }),
    ];
    let mut group = c.benchmark_group("reading");
    group.sample_size(20);
    for (name, bytes) in &files {
        group.throughput(Throughput::Bytes(bytes.len() as u64));
        group.bench_function(*name, |b| {
            b.iter(|| read(black_box(bytes), &ReadOptions::default()));
        });
    }
    group.finish();
}

criterion_group!(benches, reading);
criterion_main!(benches);
