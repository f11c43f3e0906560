//! Transport, its storage and its pictures against slow and obvious forms.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::f64::consts::PI;

use brdf_model::{Brdf, Preset};
use brdf_relight::cube::{TEXELS, direction, solid_angle};
use brdf_relight::*;
use brdf_render::{Camera, Environment, Mesh, Pixel, Soup};
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
    BrdfMaps::of(&factor_for_relighting(&brdf, &params).unwrap().model).unwrap()
}

#[test]
fn bundles_see_what_single_rays_see() {
    let mesh = torus();
    let (occluder, surface) = (Occluder::of(&mesh), Surface::of(&mesh));
    let sites = surface.sites(4.0);
    let mut visibility = Visibility::default();
    let (mut shaded, mut apart) = (0, 0);
    for site in sites.iter().step_by(sites.len() / 23) {
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
    let sites = Surface::of(&mesh).sites(4.0);
    let look = |at: usize, quality| {
        let mut visibility = Visibility::default();
        visibility.look(&occluder, sites[at].position, sites[at].normal, quality);
        visibility.shares().iter().map(|share| f64::from(*share) / 16.0).collect::<Vec<f64>>()
    };
    for at in [0, sites.len() / 3, sites.len() / 2] {
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
    let mut workspace = Workspace::new(1);
    let site = Site { position: DVec3::Y, normal: DVec3::new(0.3, 0.8, -0.5).normalize() };
    let values = workspace.transport(
        &Sky::default(),
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
    let (mesh, light) = (torus(), LightSampler::default().light(&environment(), 0.4));
    let lit = light.coefficients(LightRule::All);
    let (occluder, sky) = (Occluder::of(&mesh), Sky::default());
    let sites = Surface::of(&mesh).sites(4.0);
    for (light_maps, rank) in [(LightMaps::Rgb, 3), (LightMaps::Joint, 5)] {
        let maps = maps("light-brown-plastic", rank, light_maps);
        let (width, channels) = (maps.light.width(), maps.light_channels());
        let mut workspace = Workspace::new(width);
        for site in sites.iter().step_by(sites.len() / 5) {
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

#[test]
fn the_store_multiplies_what_vectors_hold_whatever_the_threads() {
    let mesh = torus();
    let (occluder, surface) = (Occluder::of(&mesh), Surface::of(&mesh));
    let lit = LightSampler::default().light(&environment(), 0.0).coefficients(LightRule::Energy);
    for (light_maps, rank) in [(LightMaps::Rgb, 4), (LightMaps::Joint, 6)] {
        let maps = maps("light-brown-plastic", rank, light_maps);
        let params = PrecomputeParams { coefficients: 60, quality: Quality::One };
        let make = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let vectors =
                    precompute(&mesh, &occluder, &surface, 0..3000, &maps, &params, &|| ());
                let store = SparseTransport::of(Coding::of(maps.light_channels()), &vectors);
                let mut out = vec![[0.0; 3]; store.vectors()];
                store.relight(&lit, &mut out);
                (vectors, store, out)
            })
        };
        let (vectors, store, out) = make(1);
        let (_, again, two) = make(2);
        assert!(store == again && out == two, "threads change nothing");
        assert_eq!(store.vectors(), 3000 * maps.terms);
        let coding = store.coding();
        for (vertex, kept) in vectors.iter().enumerate().step_by(311) {
            let mut start = 0;
            for term in 0..maps.terms {
                let end = start + usize::from(kept.counts[term]);
                let mut sum = [0.0_f64; 3];
                for at in start..end {
                    let Ok(place) = lit.places().binary_search(&kept.places[at]) else { continue };
                    let value = decoded(coding, kept.codes[at], kept.largest[term]);
                    for channel in 0..3 {
                        sum[channel] += value[channel] * f64::from(lit.values()[place][channel]);
                    }
                }
                start = end;
                let found = out[vertex * maps.terms + term];
                let scale = sum.iter().fold(1e-3_f64, |most, v| most.max(v.abs()));
                for (found, wanted) in found.iter().zip(sum) {
                    assert!((f64::from(*found) - wanted).abs() < 1e-3 * scale, "{found}, {wanted}");
                }
            }
            assert_eq!(start, kept.places.len());
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
    let (mesh, light) = (torus(), LightSampler::default().light(&environment(), 0.0));
    let occluder = Occluder::of(&mesh);
    let brdf = Preset::find("light-brown-plastic").unwrap().brdf();
    let split = |rank, coefficients| {
        let params = CompareParams {
            vertices: 12,
            precompute: PrecomputeParams { coefficients, quality: Quality::Adaptive },
            rule: LightRule::Energy,
        };
        let maps = maps("light-brown-plastic", rank, LightMaps::Joint);
        compare(&mesh, &occluder, &brdf, &maps, &light, &params)
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
    let light = LightSampler::default().light(&environment(), 0.0);
    let params = PrecomputeParams { coefficients: 200, quality: Quality::One };
    let part = |surface: Surface, maps: &BrdfMaps| {
        let all = 0..surface.positions.len();
        let vectors = precompute(&mesh, &occluder, &surface, all, maps, &params, &|| ());
        Part::new(surface, maps, &vectors)
    };
    let parts = [part(Surface::of(&mesh), &maps), part(Surface::ground(&mesh), &diffuse)];
    let mut relit = RelitScene::default();
    relit.relight(&parts, &light.coefficients(LightRule::All));
    let camera =
        Camera::around(mesh.centre(), mesh.radius(), DVec3::new(0.2, 0.5, 0.8).normalize());
    let shot = Shot { camera, size: 96, points: 2 };
    let (film, _) = picture(&parts, &relit, &shot);
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
