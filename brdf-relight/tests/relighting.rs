//! Transport, its storage and its pictures against slow and obvious forms.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::f64::consts::PI;

use brdf_image::Pixel;
use brdf_job::Job;
use brdf_mesh::{Camera, Mesh, Soup};
use brdf_model::{Brdf, Preset};
use brdf_relight::cube::{TEXELS, direction, solid_angle};
use brdf_relight::*;
use brdf_render::Environment;
use glam::DVec3;

fn torus() -> Mesh {
    Mesh::new(Soup::torus()).unwrap().0
}

/// A triangle that shades nothing.
fn speck() -> Mesh {
    let soup = Soup {
        positions: vec![DVec3::ZERO, 1e-3 * DVec3::X, 1e-3 * DVec3::Z],
        triangles: vec![[0, 2, 1]],
        ..Soup::default()
    };
    Mesh::new(soup).unwrap().0
}

fn environment() -> Environment {
    let texels = (0..64 * 32_u16).map(|at| {
        let (row, column) = (at / 64, at % 64);
        let lamp = if (10..13).contains(&row) && (40..44).contains(&column) { 30.0 } else { 0.0 };
        [0.3 + lamp, 0.2 + f32::from(row) / 40.0 + lamp, 0.1 + f32::from(column % 7) / 9.0]
    });
    Environment::new(64, 32, texels.collect()).unwrap()
}

fn maps(name: &str, rank: usize, light_maps: LightMaps) -> BrdfMaps {
    let brdf = Preset::find(name).unwrap().brdf();
    let params = MapParams { rank, light_maps, resolution: 24, weight_power: 0.0 };
    BrdfMaps::of(&factor_for_relighting(&brdf, &params, &Job::new()).unwrap().model).unwrap()
}

#[test]
fn bundles_see_what_single_rays_see() {
    let mesh = torus();
    let (occluder, surface) = (Occluder::of(&mesh), Surface::of(&mesh));
    let shading_points = surface.shading_points(4.0);
    let mut visibility = Visibility::default();
    let (mut shaded, mut apart) = (0, 0);
    for site in shading_points.iter().step_by(shading_points.len() / 23) {
        visibility.look(&occluder, site.position, site.normal, Quality::One);
        for texel in (0..TEXELS).step_by(7) {
            let ray = direction(texel);
            let is_up = ray.dot(site.normal) > 0.0;
            let is_covered = mesh.is_shadowed(site.position, ray, f64::INFINITY);
            shaded += usize::from(is_up && is_covered);
            apart += usize::from((visibility.shares()[texel] == 16) != (is_up && !is_covered));
        }
    }
    assert!(shaded > 2000, "the ring shades itself: {shaded} rays");
    assert!(apart <= 3, "rays along edges alone: {apart} of {shaded}");
}

#[test]
fn finer_looks_agree_away_from_borders() {
    let mesh = torus();
    let occluder = Occluder::of(&mesh);
    let shading_points = Surface::of(&mesh).shading_points(4.0);
    let look = |at: usize, quality| {
        let mut visibility = Visibility::default();
        visibility.look(&occluder, shading_points[at].position, shading_points[at].normal, quality);
        visibility.shares().iter().map(|share| f64::from(*share) / 16.0).collect::<Vec<f64>>()
    };
    for at in [0, shading_points.len() / 3, shading_points.len() / 2] {
        let [one, adaptive, all] =
            [Quality::One, Quality::Adaptive, Quality::Sixteen].map(|quality| look(at, quality));
        let wrong = |shares: &[f64]| -> f64 {
            shares.iter().zip(&all).map(|(a, b)| (a - b).abs()).sum::<f64>()
        };
        assert!(wrong(&adaptive) <= 0.1 * wrong(&one), "{} of {}", wrong(&adaptive), wrong(&one));
    }
}

#[test]
fn a_white_furnace_gives_one() {
    let mesh = speck();
    let maps = BrdfMaps::diffuse(1.0);
    let mut workspace = TransportWorkspace::new(1);
    let site = ShadingPoint { position: DVec3::Y, normal: DVec3::new(0.3, 0.8, -0.5).normalize() };
    let values = workspace.transport(
        &CubeDirections::default(),
        &Occluder::of(&mesh),
        &site,
        &maps.light,
        Quality::Sixteen,
    );
    let sum: f64 = values.iter().map(|v| f64::from(*v)).sum();
    assert!((sum / PI - 1.0).abs() < 1e-3, "{sum}");
}

#[test]
fn transport_and_its_wavelets_are_brute_force_before_they_are_cut() {
    let (mesh, light) = (torus(), CubeLightSampler::default().light(&environment(), 0.4));
    let lit = light.coefficients(LightRule::All);
    let (occluder, sky) = (Occluder::of(&mesh), CubeDirections::default());
    let shading_points = Surface::of(&mesh).shading_points(4.0);
    for (light_maps, rank) in [(LightMaps::Rgb, 3), (LightMaps::Joint, 5)] {
        let maps = maps("light-brown-plastic", rank, light_maps);
        let (width, channels) = (maps.light.width(), maps.light_channels());
        let mut workspace = TransportWorkspace::new(width);
        for site in shading_points.iter().step_by(shading_points.len() / 5) {
            let frame = tangent_frame(site.normal);
            let dense =
                workspace.transport(&sky, &occluder, site, &maps.light, Quality::One).to_vec();
            let shares = workspace.visibility.shares().to_vec();
            let (mut wanted, mut found) = (vec![0.0; 3 * maps.terms], vec![0.0; 3 * maps.terms]);
            let mut g = vec![0.0; width];
            for texel in (0..TEXELS).filter(|texel| shares[*texel] > 0) {
                let wi = frame.transpose() * direction(texel);
                let weight = solid_angle(texel) * wi.z.max(0.0) * f64::from(shares[texel]) / 16.0;
                maps.light.read(wi.as_vec3(), 1.0, &mut g);
                for (at, wanted) in wanted.iter_mut().enumerate() {
                    let g = f64::from(g[at / 3 * channels + (at % 3).min(channels - 1)]);
                    *wanted += weight * g * f64::from(light.radiance[texel][at % 3]);
                }
            }
            for texel in 0..TEXELS {
                for (at, found) in found.iter_mut().enumerate() {
                    let t = dense[texel * width + at / 3 * channels + (at % 3).min(channels - 1)];
                    *found += f64::from(t) * f64::from(light.radiance[texel][at % 3]);
                }
            }
            let coefficients = workspace.transform();
            let mut waves = vec![0.0; 3 * maps.terms];
            for (place, radiance) in lit.places().iter().zip(lit.values()) {
                for (at, sum) in waves.iter_mut().enumerate() {
                    let t = coefficients[usize::from(*place) * width
                        + at / 3 * channels
                        + (at % 3).min(channels - 1)];
                    *sum += f64::from(t) * f64::from(radiance[at % 3]);
                }
            }
            let scale = wanted.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
            for ((wanted, found), waves) in wanted.iter().zip(&found).zip(&waves) {
                assert!((wanted - found).abs() < 1e-5 * scale, "{wanted} and {found}");
                assert!((wanted - waves).abs() < 2e-5 * scale, "{wanted} and {waves}");
            }
        }
    }
}

/// Vertices of a torus, with the options of a test.
fn plan(surface: Surface, maps: &BrdfMaps, codec: Codec, quality: Quality) -> Precomputation {
    Precomputation::new(&torus(), surface, maps.clone(), PrecomputeParams { codec, quality })
}

/// In pools of one and of two threads, the same twice.
fn with_threads<T: PartialEq + Send>(make: impl Fn() -> T + Sync + Send) -> T {
    let [one, two] = [1, 2].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(&make)
    });
    assert!(one == two, "threads change nothing");
    one
}

#[test]
fn the_store_multiplies_what_vectors_hold_whatever_the_threads() {
    let occluder = Occluder::of(&torus());
    let lit =
        CubeLightSampler::default().light(&environment(), 0.0).coefficients(LightRule::Energy);
    for (light_maps, rank) in [(LightMaps::Rgb, 4), (LightMaps::Joint, 6)] {
        let maps = maps("light-brown-plastic", rank, light_maps);
        let codec = Codec::Wavelet { coefficients: 60 };
        let (vectors, store, out) = with_threads(|| {
            let work = plan(Surface::of(&torus()), &maps, codec, Quality::One);
            let chunks = 0..work.chunks().len().min(7);
            let made: Vec<Chunk> = chunks.map(|at| work.make(&occluder, at).unwrap()).collect();
            let vectors: Vec<SparseVectors> = made.into_iter().flat_map(|c| c.vectors).collect();
            let all: Vec<&SparseVectors> = vectors.iter().collect();
            let store = SparseTransport::of(Coding::of(maps.light_channels()), &all);
            let mut out = vec![[0.0; 3]; store.vectors()];
            store.relight(&lit, &mut out);
            (vectors, store, out)
        });
        assert_eq!(store.vectors(), 7 * 256 * maps.terms);
        let coding = store.coding();
        for (vertex, kept) in vectors.iter().enumerate().step_by(311) {
            for (term, sum) in products(kept, coding, &lit).into_iter().enumerate() {
                let found = out[vertex * maps.terms + term];
                let scale = sum.iter().fold(1e-3_f64, |most, v| most.max(v.abs()));
                for (found, wanted) in found.iter().zip(sum) {
                    assert!((f64::from(*found) - wanted).abs() < 1e-3 * scale, "{found}, {wanted}");
                }
            }
        }
        let (scales, offsets, owners, codes) = store.parts();
        let back =
            SparseTransport::new(scales.into(), offsets.into(), owners.into(), codes.clone());
        assert_eq!(back.unwrap(), store);
        let broken =
            SparseTransport::new(scales.into(), offsets[1..].into(), owners.into(), codes.clone());
        assert!(matches!(broken, Err(RelightError::Transport { .. })));
    }
}

/// Products of the terms of a vertex, or of a component, with light.
fn products(kept: &SparseVectors, coding: Coding, lit: &LitCoefficients) -> Vec<[f64; 3]> {
    let mut start = 0;
    let terms = kept.counts.iter().zip(&kept.largest).map(|(count, largest)| {
        let end = start + usize::from(*count);
        let mut sum = [0.0_f64; 3];
        for at in start..end {
            let Ok(place) = lit.places().binary_search(&kept.places[at]) else { continue };
            let value = decoded(coding, kept.codes[at], *largest);
            for channel in 0..3 {
                sum[channel] += value[channel] * f64::from(lit.values()[place][channel]);
            }
        }
        start = end;
        sum
    });
    terms.collect()
}

#[test]
fn clusters_stand_for_their_vertices() {
    let all = Surface::of(&torus());
    let first = |vectors: &[DVec3]| vectors[..600].to_vec();
    let some = Surface {
        positions: first(&all.positions),
        normals: first(&all.normals),
        triangles: Vec::new(),
    };
    let occluder = Occluder::of(&torus());
    let lit = CubeLightSampler::default().light(&environment(), 0.0).coefficients(LightRule::All);
    for (light_maps, rank) in [(LightMaps::Rgb, 2), (LightMaps::Joint, 6)] {
        let maps = maps("light-brown-plastic", rank, light_maps);
        let run = |codec| {
            let work = plan(some.clone(), &maps, codec, Quality::One);
            work.run(&occluder).unwrap().transport
        };
        let relit = |transport: &Transport<'_>| {
            let mut out = vec![[0.0; 3]; transport.vectors()];
            transport.relight(&lit, &mut Vec::new(), &mut out);
            out
        };
        let apart = |found: &[[f32; 3]], wanted: &[[f32; 3]]| {
            let sum = |of: &mut dyn Iterator<Item = f32>| of.map(|v| f64::from(v * v)).sum::<f64>();
            let pairs = found.as_flattened().iter().zip(wanted.as_flattened());
            let apart = sum(&mut pairs.map(|(a, b)| a - b));
            (apart / sum(&mut wanted.as_flattened().iter().copied())).sqrt()
        };
        let exact = relit(&run(Codec::Wavelet { coefficients: TEXELS }));
        let mut last = (0, f64::INFINITY);
        for tolerance in [1e-3, 1e-5] {
            let transport = with_threads(|| run(Codec::Clusters { tolerance }));
            let error = apart(&relit(&transport), &exact);
            assert!(transport.bytes() > last.0 && error < 0.8 * last.1, "{tolerance}: {error}");
            last = (transport.bytes(), error);
        }
        assert!(last.1 < 0.03, "{}", last.1);
        let wavelets = run(Codec::Wavelet { coefficients: 96 });
        let error = apart(&relit(&wavelets), &exact);
        let bytes = wavelets.bytes();
        assert!(last.0 < bytes && last.1 < error, "{last:?} and {bytes}, {error}");
    }
}

#[test]
fn components_multiply_what_chunks_hold() {
    let occluder = Occluder::of(&torus());
    let lit =
        CubeLightSampler::default().light(&environment(), 0.0).coefficients(LightRule::Energy);
    let maps = maps("light-brown-plastic", 2, LightMaps::Joint);
    let codec = Codec::Clusters { tolerance: 1e-4 };
    let work = plan(Surface::of(&torus()), &maps, codec, Quality::One);
    let clusters = work.chunks().to_vec();
    let made: Vec<Chunk> =
        (0..clusters.len()).map(|at| work.make(&occluder, at).unwrap()).collect();
    let Transport::Clusters(store) = work.assemble(&made).transport else {
        panic!("clusters were asked for");
    };
    let mut out = vec![[0.0; 3]; clusters.concat().len() * maps.terms];
    Transport::Clusters(store.clone()).relight(&lit, &mut Vec::new(), &mut out);
    for (cluster, made) in clusters.iter().zip(&made) {
        let lit: Vec<_> =
            made.vectors.iter().map(|vector| products(vector, Coding::Scalar, &lit)).collect();
        let weights = made.weights.chunks_exact(lit.len());
        for (vertex, weights) in cluster.iter().zip(weights).step_by(61) {
            for term in 0..maps.terms {
                let parts = weights.iter().zip(&lit);
                let wanted: f64 =
                    parts.map(|(weight, lit)| f64::from(*weight) / 32767.0 * lit[term][1]).sum();
                let found = f64::from(out[*vertex as usize * maps.terms + term][1]);
                assert!((found - wanted).abs() < 1e-4 * (1.0 + wanted.abs()), "{found}, {wanted}");
            }
        }
    }
    let (components, vertices, first, weights) = store.parts();
    let rebuilt = |vertices: &[u16], weights: &[i16], terms| {
        let (vertices, weights) = (vertices.to_vec().into(), weights.to_vec().into());
        ClusteredTransport::new(components.clone(), terms, vertices, first.to_vec().into(), weights)
    };
    assert_eq!(rebuilt(vertices, weights, maps.terms).unwrap(), store);
    assert!(rebuilt(vertices, &weights[1..], maps.terms).is_err(), "a weight too few");
    assert!(rebuilt(vertices, weights, 2).is_err(), "other terms");
    let beyond = vec![u16::MAX; vertices.len()];
    assert!(rebuilt(&beyond, weights, maps.terms).is_err(), "a cluster that is not there");
}

/// What the documentation of codes says, without the library's decoder.
fn decoded(coding: Coding, code: u32, largest: f32) -> [f64; 3] {
    let signed = |bits: u32, count: u32| {
        let half = 1_i64 << (count - 1);
        let value = i64::from(bits & ((1 << count) - 1));
        (if value >= half { value - 2 * half } else { value }) as f64
    };
    let largest = f64::from(largest);
    match coding {
        Coding::Rgb => [
            signed(code >> 21, 11) / 1023.0 * largest,
            signed(code >> 10, 11) / 1023.0 * largest,
            signed(code, 10) / 511.0 * largest,
        ],
        Coding::Scalar => [signed(code, 16) / 32767.0 * largest; 3],
    }
}

#[test]
fn more_terms_and_coefficients_come_closer_to_brute_force() {
    let (mesh, light) = (torus(), CubeLightSampler::default().light(&environment(), 0.0));
    let occluder = Occluder::of(&mesh);
    let brdf = Preset::find("light-brown-plastic").unwrap().brdf();
    let split = |rank, coefficients| {
        let params = CompareParams { vertices: 48, quality: Quality::One, rule: LightRule::Energy };
        let maps = maps("light-brown-plastic", rank, LightMaps::Joint);
        let codec = Codec::Wavelet { coefficients };
        let part = plan(Surface::of(&mesh), &maps, codec, params.quality).run(&occluder).unwrap();
        compare(&part, &occluder, &brdf, &light, &params, &Job::new()).unwrap()
    };
    let (few, many) = (split(2, 24), split(12, 192));
    assert!(many.rank < 0.7 * few.rank, "{many:?} and {few:?}");
    assert!(many.coefficients < 0.8 * few.coefficients, "{many:?} and {few:?}");
    assert!(many.total < 0.12 && many.visibility < 0.02, "{many:?}");
    let parts = few.rank + few.coefficients + few.light + few.visibility;
    assert!(few.total < 1.2 * parts, "parts explain the whole: {few:?}");
    assert_eq!(few.colours, many.colours);
}

#[test]
fn the_picture_shows_the_shadow_and_matches_brute_force_at_a_pixel() {
    let mesh = torus();
    let occluder = Occluder::of(&mesh);
    let brdf = Preset::find("light-brown-plastic").unwrap().brdf();
    let maps = maps("light-brown-plastic", 12, LightMaps::Joint);
    let diffuse = BrdfMaps::diffuse(0.5);
    let light = CubeLightSampler::default().light(&environment(), 0.0);
    let part = |surface: Surface, maps: &BrdfMaps| {
        let codec = Codec::Clusters { tolerance: 1e-5 };
        plan(surface, maps, codec, Quality::One).run(&occluder).unwrap()
    };
    let parts = [part(Surface::of(&mesh), &maps), part(Surface::ground(&mesh), &diffuse)];
    let mut relit = RelitScene::default();
    relit.relight(&parts, &light.coefficients(LightRule::All));
    let camera =
        Camera::around(mesh.centre(), mesh.radius(), DVec3::new(0.2, 0.5, 0.8).normalize());
    let shot = RenderParams { camera, size: 96, points: 2 };
    let (film, _) = render(&parts, &relit, &shot);
    let mut apart = Vec::new();
    for (at, pixel) in film.pixels().iter().enumerate().step_by(5) {
        let Pixel::Radiance(found, share) = *pixel else { continue };
        let place = glam::DVec2::new((at % 96) as f64 + 0.5, (at / 96) as f64 + 0.5);
        let ray = camera.ray(place, 96, 96);
        let Some(hit) = mesh.hit(camera.eye, ray, 0.0) else { continue };
        let surface = mesh.surface(&hit);
        if share < 1.0 || surface.normal.dot(-ray) < 0.4 {
            continue;
        }
        let frame = tangent_frame(surface.normal);
        let mut visibility = Visibility::default();
        let origin = surface.position + 4e-4 * surface.normal;
        visibility.look(&occluder, origin, surface.normal, Quality::Sixteen);
        let wo = frame.transpose() * -ray;
        let wanted: f64 = (0..TEXELS)
            .map(|texel| {
                let wi = frame.transpose() * direction(texel);
                let share = f64::from(visibility.shares()[texel]) / 16.0;
                let value = brdf.eval(&brdf_param::DirectionPair::new(wi, wo)).g;
                let weight = solid_angle(texel) * wi.z.max(0.0) * share;
                weight * value * f64::from(light.radiance[texel][1])
            })
            .sum();
        apart.push((found.g / wanted - 1.0).abs());
    }
    // Borders of shadows lie between vertices, and the highlight's maps are coarse: most pixels show neither.
    apart.sort_by(f64::total_cmp);
    let [half, most] = [2, 10].map(|part| apart[apart.len() - apart.len() / part]);
    assert!(apart.len() > 600 && half < 0.05 && most < 0.2, "median {half}, a tenth beyond {most}");
    let ground = |place: usize| relit.parts[1][place][1];
    let (under, far) = (ground(74 * 148 + 74), ground(148 * 20 + 20));
    assert!(under < 0.8 * far, "within the ring less of the sky is seen: {under} and {far}");
}
