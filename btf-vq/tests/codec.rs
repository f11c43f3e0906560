//! Encoding and decoding as a whole.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

mod support;

use std::sync::Arc;

use brdf_job::Job;
use btf_vq::{
    AngularGrid, Chroma, CodeSet, CodebookSizes, Codebooks, CompressedTexture, Encoded, Encoding,
    IndexCodebook, LightParametrization, LpcaModel, Measure, NodeTable, PaperParams,
    ProjectedTexels, ProjectionParams, Resampler, ScaleBits, Taps, TexelSet, TextureInfo, VqError,
    VqModel, choose_sizes, colour, encode_paper, encode_refined, fit_lpca,
};
use glam::DVec3;
use proptest::prelude::*;
use rand_core::SeedableRng as _;
use rand_xoshiro::Xoshiro256PlusPlus;
use support::{Formula, empty, info, material, resampler};

const SIZES: CodebookSizes =
    CodebookSizes { p4: 48, p3: 200, p2: 200, p1: 120, i2: 16, i1: 16, c: 8 };

fn survey(source: &Formula, resampler: &Resampler) -> ProjectedTexels {
    let sets = [TexelSet::Images { source, resampler }];
    ProjectedTexels::of(&sets, ProjectionParams { dims: 40, sample: 128 }, &Job::new()).unwrap()
}

fn refined(source: &Formula) -> VqModel {
    let resampler = resampler(source);
    let encoded = encode_refined(
        &[survey(source, &resampler)],
        &SIZES,
        empty(source, Chroma::Relative),
        &Job::new(),
    )
    .unwrap();
    let texture = IndexCodebook { len: 1, index: encoded.index, scale: encoded.scale };
    let mut books = encoded.books;
    let mut materials = [material(source, texture)];
    books.normalize(&mut materials);
    VqModel::pack(&books, &materials, ScaleBits::refined(books.encoding)).unwrap()
}

fn paper(source: &Formula, measure: Measure) -> VqModel {
    let resampler = resampler(source);
    let sets = [TexelSet::Images { source, resampler: &resampler }];
    // Small textures have few texels to learn from: 5 % of 256.
    let params = PaperParams { measure, budget: 0.2 };
    let (mut books, textures) =
        encode_paper(&sets, &params, empty(source, Chroma::Absolute), &Job::new()).unwrap();
    let mut materials: Vec<_> = textures.into_iter().map(|t| material(source, t)).collect();
    books.normalize(&mut materials);
    VqModel::pack(&books, &materials, ScaleBits::paper(Encoding::Srgb)).unwrap()
}

fn lpca(source: &Formula) -> LpcaModel {
    let resampler = resampler(source);
    let survey = survey(source, &resampler);
    let fit = fit_lpca(&survey, 400_000, 1, &Job::new()).unwrap();
    LpcaModel::pack(&survey, &fit, vec![info(source)]).unwrap()
}

/// Rows and scales of a texture.
fn entries(texture: &IndexCodebook) -> impl Iterator<Item = (usize, f32)> {
    texture.index.iter().zip(&texture.scale).map(|(row, scale)| (*row as usize, *scale))
}

/// Root mean squared error over all images.
fn rms(source: &Formula, value: impl Fn(usize, &Taps) -> [f32; 3]) -> f64 {
    let grid = AngularGrid::default();
    let (mut sum, mut count) = (0.0, 0.0);
    for view in source.layout.views.iter().step_by(5) {
        for wi in view.lights.iter().step_by(3) {
            let taps = Taps::new(&grid, *wi, view.wo);
            for texel in 0..source.layout.width * source.layout.height {
                let (a, b) = (source.value(texel, *wi, view.wo), value(texel, &taps));
                sum += a.iter().zip(b).map(|(a, b)| f64::from((a - b) * (a - b))).sum::<f64>();
                count += 3.0;
            }
        }
    }
    (sum / count).sqrt()
}

#[test]
fn every_mode_reproduces_a_simple_texture() {
    let source = Formula::new(16, 0.2, Encoding::Srgb);
    let model = refined(&source);
    let decoder = model.decoder(0).unwrap();
    let refined = rms(&source, |texel, taps| decoder.texel(0, texel, taps));
    let model = paper(&source, Measure::Mse(0.0004));
    let decoder = model.decoder(0).unwrap();
    let published = rms(&source, |texel, taps| decoder.texel(0, texel, taps));
    let model = lpca(&source);
    let decoder = model.decoder(0).unwrap();
    let components = rms(&source, |texel, taps| decoder.texel(0, texel, taps));
    // The resampling alone loses 0.02: highlights are narrower than its steps.
    assert!(refined < 0.035, "refined {refined}");
    assert!(published < 0.1, "paper {published}");
    assert!(components < 0.035, "lpca {components}");
}

#[test]
fn linear_radiance_is_reproduced_too() {
    let source = Formula::new(8, 0.1, Encoding::Linear);
    let model = refined(&source);
    let decoder = model.decoder(0).unwrap();
    let error = rms(&source, |texel, taps| decoder.texel(0, texel, taps));
    assert!(error < 0.04, "{error}");
}

#[test]
fn one_and_two_threads_give_the_same_bytes() {
    let source = Formula::new(12, 0.2, Encoding::Srgb);
    let encode = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let bytes = |model: &VqModel| -> Vec<u8> {
                (0..9).flat_map(|at| model.stream(at).to_vec()).collect()
            };
            let lpca = lpca(&source);
            [
                bytes(&refined(&source)),
                bytes(&paper(&source, Measure::Mse(0.001))),
                bytes(&paper(&source, Measure::Ssim(0.3))),
                (0..2).flat_map(|at| lpca.stream(at).to_vec()).collect(),
            ]
        })
    };
    assert!(encode(1) == encode(2));
}

#[test]
fn packing_and_unpacking_loses_nothing_more() {
    let model = refined(&Formula::new(8, 0.2, Encoding::Srgb));
    let (books, materials) = model.unpack();
    let again = VqModel::pack(&books, &materials, ScaleBits::refined(books.encoding)).unwrap();
    for at in 0..9 {
        assert!(model.stream(at) == again.stream(at), "stream {at}");
    }
}

#[test]
fn slices_of_unpacked_books_have_unit_integrals() {
    let source = Formula::new(8, 0.2, Encoding::Srgb);
    let resampler = resampler(&source);
    let encoded = encode_refined(
        &[survey(&source, &resampler)],
        &SIZES,
        empty(&source, Chroma::Relative),
        &Job::new(),
    )
    .unwrap();
    let mut books = encoded.books;
    let texture = IndexCodebook { len: 1, index: encoded.index, scale: encoded.scale };
    books.normalize(&mut [material(&source, texture)]);
    let weights: Vec<f32> = AngularGrid::trapezoid(11).collect();
    for row in 0..books.p2.rows() {
        let mut slice = vec![0.0; 121];
        books.expand_p2(row, &mut slice);
        let integral: f32 =
            slice.iter().enumerate().map(|(at, v)| v * weights[at / 11] * weights[at % 11]).sum();
        assert!((integral - 1.0).abs() < 1e-4, "row {row}: {integral}");
    }
}

#[test]
fn images_runs_and_batches_are_single_texels() {
    let source = Formula::new(8, 0.2, Encoding::Srgb);
    let (vq, lpca) = (refined(&source), lpca(&source));
    let (vq, lpca) = (vq.decoder(0).unwrap(), lpca.decoder(0).unwrap());
    let view = &source.layout.views[30];
    let taps = Taps::new(vq.grid(), view.lights[50], view.wo);
    let mut image = vec![[0.0; 3]; 64];
    vq.image(0, &taps, &mut image);
    let mut run = vec![[0.0; 3]; 64];
    vq.run(0, 0, &taps, &mut run);
    // Each texel with a light of its own, and some that make no whole group.
    let lit = |texel: usize| Taps::new(vq.grid(), view.lights[texel % 81], view.wo);
    let queries: Vec<(usize, Taps)> = (0..61).map(|texel| (texel, lit(texel))).collect();
    let mut batch = vec![[0.0; 3]; 61];
    vq.batch(&queries, &mut batch);
    for ((texel, taps), value) in queries.iter().zip(&batch) {
        assert_eq!([*value], [vq.texel(0, *texel, taps)], "texel {texel}");
    }
    let mut other = vec![[0.0; 3]; 64];
    lpca.image(0, &taps, &mut other);
    for texel in 0..64 {
        let one = vq.texel(0, texel, &taps);
        assert_eq!([image[texel], run[texel]], [one; 2], "texel {texel}");
        let one = lpca.texel(0, texel, &taps);
        for (a, b) in one.iter().zip(other[texel]) {
            assert!((a - b).abs() < 1e-4, "texel {texel}: {one:?} {:?}", other[texel]);
        }
    }
}

/// The first rows of a book are those of another.
fn starts_with(book: &IndexCodebook, start: &IndexCodebook) -> bool {
    book.index.starts_with(&start.index)
}

#[test]
fn books_grow_without_changing_the_rows_they_have() {
    let (first, second) =
        (Formula::new(12, 0.2, Encoding::Srgb), Formula::new(8, 0.0, Encoding::Srgb));
    let second_resampler = resampler(&second);
    let sets = [TexelSet::Images { source: &second, resampler: &second_resampler }];

    let (books, mut materials) = refined(&first).unpack();
    let sizes = CodebookSizes { p4: 16, p3: 40, p2: 30, p1: 20, i2: 4, i1: 4, c: 4 };
    let added =
        encode_refined(&[survey(&second, &second_resampler)], &sizes, books.clone(), &Job::new())
            .unwrap();
    let texture = IndexCodebook { len: 1, index: added.index, scale: added.scale };
    assert!(starts_with(&added.books.p4, &books.p4) && starts_with(&added.books.m, &books.m));
    assert!(starts_with(&added.books.p2, &books.p2) && starts_with(&added.books.i2, &books.i2));
    assert!(added.books.p3.rows() <= books.p3.rows() + 40);
    materials.push(material(&second, texture));
    let mut grown = added.books;
    grown.normalize(&mut materials);
    let both = VqModel::pack(&grown, &materials, ScaleBits::refined(Encoding::Srgb)).unwrap();

    let (books, mut materials) = paper(&first, Measure::Mse(0.001)).unpack();
    let params = PaperParams { measure: Measure::Mse(0.001), budget: 0.2 };
    let (mut grown, textures) = encode_paper(&sets, &params, books.clone(), &Job::new()).unwrap();
    assert!(starts_with(&grown.p4, &books.p4) && starts_with(&grown.m, &books.m));
    assert!(grown.p1.values.starts_with(&books.p1.values));
    materials.extend(textures.into_iter().map(|texture| material(&second, texture)));
    grown.normalize(&mut materials);
    let published = VqModel::pack(&grown, &materials, ScaleBits::paper(Encoding::Srgb)).unwrap();

    for (model, limits) in [(both, [0.036, 0.03]), (published, [0.1, 0.1])] {
        for ((at, source), limit) in [&first, &second].into_iter().enumerate().zip(limits) {
            let decoder = model.decoder(at).unwrap();
            let error = rms(source, |texel, taps| decoder.texel(0, texel, taps));
            assert!(error < limit, "texture {at}: {error}");
        }
    }
}

#[test]
fn textures_share_all_books_but_rows_of_p4() {
    let sources = [Formula::new(12, 0.2, Encoding::Srgb), Formula::new(8, 0.0, Encoding::Srgb)];
    let surveys = sources.each_ref().map(|source| survey(source, &resampler(source)));
    let sizes = CodebookSizes { p4: 65, ..SIZES };
    let Encoded { mut books, index, scale, .. } =
        encode_refined(&surveys, &sizes, empty(&sources[0], Chroma::Relative), &Job::new())
            .unwrap();
    // 144 and 64 texels share 65 rows in proportion.
    assert_eq!((index.len(), books.p4.rows()), (208, 65));
    let (first, second) = index.split_at(144);
    assert!(first.iter().all(|row| *row < 45) && second.iter().all(|row| (45..65).contains(row)));
    let textures = [(first, &scale[..144]), (second, &scale[144..])];
    let mut materials = [0, 1].map(|at| {
        let (index, scale) = textures[at];
        let texture = IndexCodebook { len: 1, index: index.to_vec(), scale: scale.to_vec() };
        material(&sources[at], texture)
    });
    books.normalize(&mut materials);
    let model = VqModel::pack(&books, &materials, ScaleBits::refined(Encoding::Srgb)).unwrap();
    for (at, source) in sources.iter().enumerate() {
        let decoder = model.decoder(at).unwrap();
        let error = rms(source, |texel, taps| decoder.texel(0, texel, taps));
        assert!(error < 0.036, "texture {at}: {error}");
    }
}

#[test]
fn tabulated_brdfs_are_texels_too() {
    let grid = AngularGrid { alphas: 23, betas: 23, thetas: 9, phis: 1, ..Default::default() };
    let brdf = |colour: [f32; 3], power: f64| {
        move |wi: DVec3, wo: DVec3| {
            let shine = (wi + wo).normalize_or(DVec3::Z).z.max(0.0).powf(power);
            #[expect(clippy::cast_possible_truncation, reason = "tables are f32")]
            let (diffuse, shine) = (wi.z as f32, (wi.z * shine) as f32);
            colour.map(|c| c * diffuse + shine)
        }
    };
    let materials = [([0.5, 0.2, 0.1], 5.0), ([0.1, 0.2, 0.3], 12.0), ([0.3, 0.3, 0.3], 30.0)];
    let mut table = NodeTable::new(grid).unwrap();
    for (colour, power) in materials {
        assert_eq!(table.push(brdf(colour, power)).unwrap(), 0);
    }
    assert!(table.push(|_, _| [f32::NAN; 3]).is_err());
    assert_eq!(table.len(), 3);
    let surveys =
        [ProjectedTexels::of(&[TexelSet::Nodes(&table)], ProjectionParams::default(), &Job::new())
            .unwrap()];
    let bits = ScaleBits::refined(Encoding::Linear);
    let sizes = choose_sizes(&surveys, &bits, 100_000, &Job::new()).unwrap();
    let empty = Codebooks::new(grid, Encoding::Linear, Chroma::Relative);
    let encoded = encode_refined(&surveys, &sizes, empty, &Job::new()).unwrap();
    let texture = IndexCodebook { len: 1, index: encoded.index, scale: encoded.scale };
    let info = TextureInfo {
        name: "three".to_owned(),
        width: 3,
        height: 1,
        cosine_included: true,
        levels: 1,
    };
    let mut materials_packed = [CompressedTexture { info, levels: vec![texture] }];
    let mut books = encoded.books;
    books.normalize(&mut materials_packed);
    let model = VqModel::pack(&books, &materials_packed, bits).unwrap();
    let decoder = model.decoder(0).unwrap();
    for (texel, (colour, power)) in materials.into_iter().enumerate() {
        for (wi, wo) in support::directions().into_iter().zip(support::directions().split_off(30)) {
            let value = decoder.texel(0, texel, &Taps::new(&grid, wi, wo));
            let wanted = brdf(colour, power)(wi, wo);
            for (value, wanted) in value.iter().zip(wanted) {
                assert!((value - wanted).abs() < 0.03 + 0.08 * wanted, "{texel}: {value} {wanted}");
            }
        }
    }
}

#[test]
fn the_decoder_reads_what_the_books_say() {
    for model in [
        refined(&Formula::new(8, 0.2, Encoding::Srgb)),
        paper(&Formula::new(8, 0.2, Encoding::Srgb), Measure::Mse(0.001)),
        refined(&Formula::new(8, 0.1, Encoding::Linear)),
    ] {
        let (books, materials) = model.unpack();
        let decoder = model.decoder(0).unwrap();
        let nodes = books.grid.node_count();
        let mut values = vec![0.0; 3 * nodes];
        for (texel, (row, scale)) in entries(&materials[0].levels[0]).enumerate() {
            books.expand_p4(row, &mut values);
            let directions = support::directions();
            let (wi, wo) = (directions[(7 * texel) % 81], directions[(11 * texel + 5) % 81]);
            let taps = Taps::new(&books.grid, wi, wo);
            let of = |channel: usize| -> f32 {
                taps.nodes(&books.grid).iter().map(|(n, w)| w * values[channel * nodes + n]).sum()
            };
            let [y, a, b] = [of(0), of(1), of(2)];
            let chroma = match (books.chroma, books.encoding) {
                (Chroma::Absolute, _) => 1.0,
                (Chroma::Relative, Encoding::Srgb) => scale,
                (Chroma::Relative, Encoding::Linear) => {
                    if y > 0.0 {
                        y.recip()
                    } else {
                        1.0
                    }
                }
            };
            let wanted =
                colour::from_luma_chroma(books.encoding, [y * scale, a * chroma, b * chroma]);
            for (found, wanted) in decoder.texel(0, texel, &taps).iter().zip(wanted) {
                assert!((found - wanted).abs() < 1e-5, "texel {texel}: {found} {wanted}");
            }
        }
    }
}

#[test]
fn missing_images_are_filled_from_the_same_view() {
    let whole = Formula::new(8, 0.0, Encoding::Srgb);
    let mut holey = Formula::new(8, 0.0, Encoding::Srgb);
    for (at, view) in holey.layout.views.iter_mut().enumerate() {
        view.lights.remove(7 + at % 60);
    }
    let grid = AngularGrid::default();
    let resampler = Resampler::new(&holey.layout, grid).unwrap();
    assert_eq!(resampler.filled(), 81);
    let (filled, _) = resampler.map_blocks(&holey, 0..64, |_, block| block.to_vec()).unwrap();
    let resampler = Resampler::new(&whole.layout, grid).unwrap();
    let (full, _) = resampler.map_blocks(&whole, 0..64, |_, block| block.to_vec()).unwrap();
    let (filled, full) = (filled.concat(), full.concat());
    let mean: f32 = filled.iter().zip(&full).map(|(a, b)| (a - b).abs()).sum::<f32>();
    let mean = mean / full.len() as f32;
    assert!(mean < 2e-3, "{mean}");
}

#[test]
fn the_printed_parametrization_works_as_far_as_it_can() {
    let source = Formula::new(8, 0.0, Encoding::Srgb);
    let grid = AngularGrid { parametrization: LightParametrization::Eq3, ..Default::default() };
    let resampler = Resampler::new(&source.layout, grid).unwrap();
    let (blocks, _) = resampler.map_blocks(&source, 0..64, |_, b| b.to_vec()).unwrap();
    let values = blocks.concat();
    // Lights that mirror each other in the plane of incidence share a node, so that their mean is
    // what is left of them.
    let (wi, wo) = (support::directions()[22], support::directions()[8]);
    let nodes = Taps::new(&grid, wi, wo).nodes(&grid);
    let luma: f32 = nodes.iter().map(|(node, w)| w * values[*node]).sum();
    assert!(luma > 0.0 && luma < 1.0, "{luma}");
}

#[test]
fn an_index_past_the_end_of_a_book_is_refused() {
    let model = refined(&Formula::new(8, 0.2, Encoding::Srgb));
    let mut header = model.header().clone();
    // The same bits for fewer rows: some row now points past the end.
    header.rows.p1 -= 1;
    let streams: Vec<Vec<u8>> = (0..9).map(|at| model.stream(at).to_vec()).collect();
    let mut bytes = Vec::new();
    let mut ranges = Vec::new();
    for (at, stream) in streams.iter().enumerate() {
        let end = if at == 0 { stream.len() - 11 } else { stream.len() };
        ranges.push(bytes.len()..bytes.len() + end);
        bytes.extend(&stream[..end]);
    }
    let refused = VqModel::new(header, Arc::new(bytes), ranges).unwrap_err();
    assert!(matches!(refused, VqError::Index { book: "P2", .. }), "{refused}");
}

#[test]
fn too_few_bytes_are_said_to_be_too_few() {
    let source = Formula::new(8, 0.2, Encoding::Srgb);
    let resampler = resampler(&source);
    let survey = survey(&source, &resampler);
    let refused = fit_lpca(&survey, 1000, 1, &Job::new()).unwrap_err();
    assert!(refused.to_string().contains("1000 bytes are too few"), "{refused}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn matrix_search_and_a_linear_scan_pick_the_same_codes(
        seed: u64, luma in 0_usize..40, chroma in 0_usize..30, codes in 1_usize..400,
    ) {
        prop_assume!(luma + chroma > 0);
        let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
        // Few different values, so that equal codes and ties occur.
        let mut draw = |count: usize| -> Vec<f32> {
            (0..count).map(|_| f32::from(u8::try_from(random.next_u32() % 4).unwrap_or(0)) / 3.0).collect()
        };
        let mut set = CodeSet::new(luma, chroma);
        for _ in 0..codes {
            set.push(&draw(luma), &draw(chroma));
        }
        let (lumas, chromas) = (draw(70 * luma), draw(70 * chroma));
        let found = set.nearest(&lumas, &chromas);
        prop_assert_eq!(found.len(), 70);
        for (at, found) in found.iter().enumerate() {
            let (y, c) = (&lumas[at * luma..][..luma], &chromas[at * chroma..][..chroma]);
            prop_assert_eq!(Some(*found), set.scan(y, c, 0), "vector {}", at);
        }
    }
}
