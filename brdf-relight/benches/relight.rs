//! What a change of light and of view costs on a torus, and what a chunk of precomputation does.

#![allow(
    missing_docs,
    clippy::missing_panics_doc,
    clippy::unwrap_used,
    reason = "criterion's macros, and a bench that cannot go on"
)]

use std::hint::black_box;

use brdf_job::Job;
use brdf_mesh::{Camera, Mesh, Soup};
use brdf_model::Preset;
use brdf_relight::{
    BrdfMaps, Codec, CubeLightSampler, LightMaps, LightRule, MapParams, Occluder, Part,
    Precomputation, PrecomputeParams, Quality, RelitScene, RenderParams, Surface,
    factor_for_relighting, render,
};
use brdf_render::Environment;
use criterion::{Criterion, criterion_group, criterion_main};
use glam::DVec3;

const CODECS: [(&str, Codec); 2] = [
    ("wavelet", Codec::Wavelet { coefficients: 96 }),
    ("clusters", Codec::Clusters { tolerance: 1e-5 }),
];

fn work(mesh: &Mesh, codec: Codec) -> Precomputation {
    let params =
        MapParams { rank: 16, light_maps: LightMaps::Joint, resolution: 48, weight_power: 0.0 };
    let brdf = Preset::find("plastic").unwrap().brdf();
    let maps =
        BrdfMaps::of(&factor_for_relighting(&brdf, &params, &Job::new()).unwrap().model).unwrap();
    let params = PrecomputeParams { codec, quality: Quality::One };
    Precomputation::new(mesh, Surface::of(mesh), maps, params)
}

fn relight(c: &mut Criterion) {
    let (mesh, _) = Mesh::new(Soup::torus()).unwrap();
    let occluder = Occluder::of(&mesh);
    let sampler = CubeLightSampler::default();
    let environment = Environment::sky().unwrap();
    let lit = sampler.light(&environment, 0.0).coefficients(LightRule::Energy);
    c.bench_function("new light, its coefficients", |bencher| {
        bencher
            .iter(|| sampler.light(black_box(&environment), 0.3).coefficients(LightRule::Energy));
    });
    let camera = Camera::around(DVec3::ZERO, mesh.radius(), DVec3::new(0.0, 0.6, 0.8));
    let shot = RenderParams { camera, size: 512, points: 1 };
    for (name, codec) in CODECS {
        let plan = work(&mesh, codec);
        c.bench_function(&format!("a chunk, {name}"), |bencher| {
            bencher.iter(|| plan.make(&occluder, black_box(0)).unwrap());
        });
        let parts: [Part<'_>; 1] = [plan.run(&occluder).unwrap()];
        let mut relit = RelitScene::default();
        c.bench_function(&format!("new light, product with {name}"), |bencher| {
            bencher.iter(|| relit.relight(black_box(&parts), &lit));
        });
        c.bench_function(&format!("render, {name}"), |bencher| {
            bencher.iter(|| render(black_box(&parts), &relit, &shot));
        });
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20);
    targets = relight
}
criterion_main!(benches);
