//! The matrix of the relighting paper, its eigenpairs, and lookups.

#![allow(missing_docs, clippy::unwrap_used, reason = "a benchmark")]

use brdf_job::Job;
use brdf_model::{Brdf, Channels, PairSampling, Preset};
use brdf_param::{DirectionPair, HemisphereMap, Parametrization};
use brdf_separable::{
    BrdfMatrix, HemisphereGrid, KrylovParams, Layout, MatrixParams, SeparableParams,
    factorize_matrix, top_eigenpairs,
};
use criterion::{Criterion, criterion_group, criterion_main};

fn benches(c: &mut Criterion) {
    let brdf = Preset::find("ashikhmin-shirley").unwrap().brdf();
    let chart = HemisphereGrid::Plane { map: HemisphereMap::OrthographicDisc, resolution: 48 };
    let layout = Layout::new(Parametrization::Standard, chart, chart);
    let mut group = c.benchmark_group("1804²");
    group.sample_size(10);
    group.bench_function("fill RGB", |b| {
        b.iter(|| BrdfMatrix::sample(&brdf, &layout, &MatrixParams::default()).unwrap());
    });
    let grey = MatrixParams { channels: Channels::Luminance, ..MatrixParams::default() };
    let matrix = BrdfMatrix::sample(&brdf, &layout, &grey).unwrap();
    let values = matrix.channel(0);
    group.sample_size(30);
    for rank in [4, 8] {
        group.bench_function(format!("top {rank} eigenpairs"), |b| {
            let params = KrylovParams { rank, ..KrylovParams::default() };
            b.iter(|| top_eigenpairs(values.as_ref(), &params).unwrap());
        });
    }
    group.finish();

    let model = {
        let matrix = BrdfMatrix::sample(&brdf, &layout, &MatrixParams::default()).unwrap();
        factorize_matrix(&matrix, &SeparableParams::default(), &Job::new()).unwrap().model
    };
    let sampling = PairSampling { count: 100_000, seed: 1, theta_max: 1.4 };
    let pairs: Vec<DirectionPair> = sampling.pairs().collect();
    c.bench_function("100k RGB lookups, rank 4", |b| {
        b.iter(|| pairs.iter().map(|pair| model.eval(pair).g).sum::<f64>());
    });
}

criterion_group!(all, benches);
criterion_main!(all);
