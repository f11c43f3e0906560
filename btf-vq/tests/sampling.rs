//! Importance sampling against its pdf, and the pdf against 1.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

mod support;

use brdf_job::Job;
use brdf_model::DirectionSampler as _;
use btf_vq::{
    Chroma, CodebookSizes, Encoding, IndexCodebook, LightQuery, ProjectedTexels, ProjectionParams,
    SampledLight, ScaleBits, TexelSet, VqModel, encode_refined,
};
use glam::DVec3;
use support::{Formula, empty, material, resampler};

fn model() -> VqModel {
    let source = Formula::new(8, 0.4, Encoding::Srgb);
    let resampler = resampler(&source);
    let sets = [TexelSet::Images { source: &source, resampler: &resampler }];
    let params = ProjectionParams { dims: 40, sample: 64 };
    let surveys = [ProjectedTexels::of(&sets, params, &Job::new()).unwrap()];
    let sizes = CodebookSizes { p4: 32, p3: 100, p2: 100, p1: 80, i2: 8, i1: 8, c: 8 };
    let encoded =
        encode_refined(&surveys, &sizes, empty(&source, Chroma::Relative), &Job::new()).unwrap();
    let texture = IndexCodebook { len: 1, index: encoded.index, scale: encoded.scale };
    let mut books = encoded.books;
    let mut materials = [material(&source, texture)];
    books.normalize(&mut materials);
    VqModel::pack(&books, &materials, ScaleBits::refined(Encoding::Srgb)).unwrap()
}

/// Bins of equal solid angle: rings of cos θ, sectors of φ.
const RINGS: usize = 12;
const SECTORS: usize = 24;

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "small numbers of bins"
)]
fn bin(wi: DVec3) -> usize {
    let ring = ((wi.z.clamp(0.0, 1.0) * RINGS as f64) as usize).min(RINGS - 1);
    let turn = (wi.y.atan2(wi.x) / std::f64::consts::TAU).rem_euclid(1.0);
    ring * SECTORS + ((turn * SECTORS as f64) as usize).min(SECTORS - 1)
}

/// Share of each bin by quadrature of the pdf.
fn shares(pdf: &dyn Fn(DVec3) -> f64) -> Vec<f64> {
    let mut shares = vec![0.0; RINGS * SECTORS];
    let (rings, sectors) = (480_u32, 960_u32);
    for ring in 0..rings {
        for sector in 0..sectors {
            let z = (f64::from(ring) + 0.5) / f64::from(rings);
            let phi = std::f64::consts::TAU * (f64::from(sector) + 0.5) / f64::from(sectors);
            let planar = (1.0 - z * z).sqrt();
            let wi = DVec3::new(planar * phi.cos(), planar * phi.sin(), z);
            let area = std::f64::consts::TAU / f64::from(rings * sectors);
            shares[bin(wi)] += pdf(wi) * area;
        }
    }
    shares
}

/// χ² of hits against expected shares, over bins that expect at least five.
fn chi_square(hits: &[f64], shares: &[f64], total: f64) -> (f64, f64) {
    let bins = hits.iter().zip(shares).filter(|(_, share)| *share * total >= 5.0);
    let (sum, count) = bins.fold((0.0, -1.0), |(sum, count), (hit, share)| {
        (sum + (hit - share * total).powi(2) / (share * total), count + 1.0)
    });
    (sum, count)
}

/// Points of the plane that fill it evenly (golden ratio in two dimensions), shuffled by a stride.
fn uniform(index: u32) -> [f64; 2] {
    let mix = |salt: u64| {
        let mut z = (u64::from(index) + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(salt);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    };
    [mix(1), mix(0x5851_f42d_4c95_7f2d)]
}

#[test]
fn samples_follow_their_density_and_it_integrates_to_one() {
    let model = model();
    let decoder = model.decoder(0).unwrap();
    const COUNT: u32 = 100_000;
    for (texel, theta, phi) in [(0, 0.0, 0.0), (9, 0.5, 1.0), (18, 1.0, 2.5), (27, 1.3, 4.0)] {
        let wo = brdf_param::spherical_direction(theta, phi);
        let sampler = decoder.light_sampler(0, texel, wo);
        let shares = shares(&|wi| sampler.pdf(wi));
        let total: f64 = shares.iter().sum();
        assert!((total - 1.0).abs() < 2e-3, "texel {texel}: the pdf integrates to {total}");

        let mut tabulated = vec![0.0; shares.len()];
        let mut mixed = vec![0.0; shares.len()];
        let queries: Vec<LightQuery> =
            (0..COUNT).map(|index| LightQuery { texel, wo, u: uniform(index) }).collect();
        let mut lights = vec![SampledLight::default(); queries.len()];
        decoder.sample_lights(&queries, &mut lights);
        for (LightQuery { u: [u1, u2], .. }, drawn) in queries.into_iter().zip(lights) {
            let (wi, pdf) = sampler.sample([u1, u2]);
            assert!((pdf - sampler.pdf(wi)).abs() < 1e-3 * (1.0 + pdf), "{wi}");
            tabulated[bin(wi)] += 1.0;
            assert!(
                (drawn.pdf - sampler.pdf(drawn.wi)).abs() < 1e-2 * (0.1 + drawn.pdf),
                "texel {texel}: {drawn:?} {}",
                sampler.pdf(drawn.wi)
            );
            mixed[bin(drawn.wi)] += 1.0;
        }
        for (name, hits) in [("tabulated", tabulated), ("mixture", mixed)] {
            let (chi, freedom) = chi_square(&hits, &shares, f64::from(COUNT));
            // Five standard deviations of χ².
            let limit = freedom + 5.0 * (2.0_f64 * freedom).sqrt();
            assert!(chi < limit, "{name}, texel {texel}: χ² {chi:.0} of {freedom} bins");
        }
    }
}
