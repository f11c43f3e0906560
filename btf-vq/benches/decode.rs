//! Decoding and importance sampling on one thread, over books as large as those of the paper's wool.

#![allow(
    missing_docs,
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    reason = "a bench: criterion's items, and numbers of known size"
)]

use std::hint::black_box;

use btf_vq::{
    AngularGrid, Chroma, Codebooks, CompressedTexture, Decoder, Encoding, IndexCodebook,
    LightQuery, SampledLight, ScaleBits, Taps, TextureInfo, VqModel,
};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::DVec3;
use rand_core::{Rng as _, SeedableRng as _};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Queries of one measurement.
const COUNT: usize = 4096;
/// Consecutive texels of one pair of directions.
const RUN: usize = 256;
const SIDE: usize = 256;

/// Numbers that look like those of a real texture to caches and branches.
struct Noise(Xoshiro256PlusPlus);

impl Noise {
    fn below(&mut self, count: usize) -> usize {
        (self.0.next_u64() >> 32) as usize % count
    }

    fn unit(&mut self) -> f64 {
        (self.below(1 << 24) as f64 + 0.5) / f64::from(1 << 24)
    }

    fn book(&mut self, len: usize, rows: usize, target: usize, has_scale: bool) -> IndexCodebook {
        let index =
            (0..rows * len).map(|_| u32::try_from(self.below(target)).unwrap_or(0)).collect();
        let scale =
            (0..if has_scale { rows * len } else { 0 }).map(|_| 0.3 + self.unit() as f32).collect();
        IndexCodebook { len, index, scale }
    }

    fn direction(&mut self) -> DVec3 {
        let (theta, phi) = (1.3 * self.unit(), std::f64::consts::TAU * self.unit());
        brdf_param::spherical_direction(theta, phi)
    }
}

/// Rows of Table 3: P1 10486, P2 66728, C 22, I1 62108, I2 88434, M 95325, P3 20972, P4 1311.
fn wool(noise: &mut Noise) -> VqModel {
    let grid = AngularGrid::default();
    let mut books = Codebooks::new(grid, Encoding::Srgb, Chroma::Absolute);
    books.p1.values = (0..10_486 * grid.betas).map(|_| noise.unit() as f32).collect();
    books.p2 = noise.book(grid.alphas, 66_728, 10_486, true);
    books.c.values = (0..22 * 2).map(|_| noise.unit() as f32 - 0.5).collect();
    books.i1 = noise.book(grid.betas, 62_108, 22, false);
    books.i2 = noise.book(grid.alphas, 88_434, 62_108, false);
    let luma = noise.book(1, 95_325, 66_728, false);
    let chroma = noise.book(1, 95_325, 88_434, false);
    books.m.index = luma.index.iter().zip(&chroma.index).flat_map(|(p, i)| [*p, *i]).collect();
    books.p3 = noise.book(grid.thetas, 20_972, 95_325, true);
    books.p4 = noise.book(grid.phis, 1311, 20_972, true);
    let levels = vec![noise.book(1, SIDE * SIDE, 1311, true)];
    let info = TextureInfo {
        name: "noise".to_owned(),
        width: SIDE,
        height: SIDE,
        cosine_included: true,
        levels: 1,
    };
    let mut materials = [CompressedTexture { info, levels }];
    books.normalize(&mut materials);
    VqModel::pack(&books, &materials, ScaleBits::paper(Encoding::Srgb)).expect("sound books")
}

fn evaluate(c: &mut Criterion) {
    let mut noise = Noise(Xoshiro256PlusPlus::seed_from_u64(7));
    let model = wool(&mut noise);
    let decoder: Decoder<'_> = model.decoder(0).expect("a texture");
    let queries: Vec<(usize, DVec3, DVec3)> = (0..COUNT)
        .map(|_| (noise.below(SIDE * SIDE), noise.direction(), noise.direction()))
        .collect();
    let mut out = vec![[0.0; 3]; COUNT];
    let mut group = c.benchmark_group("decode");
    group.throughput(Throughput::Elements(COUNT as u64));
    let mut placed = vec![(0, Taps::default()); COUNT];
    group.bench_function("random", |b| {
        b.iter(|| {
            for ((texel, wi, wo), place) in queries.iter().zip(&mut placed) {
                *place = (*texel, Taps::new(decoder.grid(), *wi, *wo));
            }
            decoder.batch(&placed, &mut out);
            black_box(&out);
        });
    });
    group.bench_function("coherent", |b| {
        b.iter(|| {
            for ((first, wi, wo), run) in queries.iter().zip(out.chunks_mut(RUN)) {
                let first = first / RUN * RUN;
                decoder.run(0, first, &Taps::new(decoder.grid(), *wi, *wo), run);
            }
            black_box(&out);
        });
    });
    let wanted = queries.iter().map(|(texel, _, wo)| {
        let u = [noise.unit(), noise.unit()];
        LightQuery { texel: *texel, wo: *wo, u }
    });
    let wanted: Vec<LightQuery> = wanted.collect();
    let mut lights = vec![SampledLight::default(); COUNT];
    group.bench_function("sample", |b| {
        b.iter(|| {
            decoder.sample_lights(&wanted, &mut lights);
            black_box(&lights);
        });
    });
    group.finish();
}

criterion_group!(benches, evaluate);
criterion_main!(benches);
