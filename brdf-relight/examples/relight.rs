//! Precomputes a glossy plate, relights it by two skies and measures what was lost.
//!
//! `cargo run --release -p brdf-relight --example relight`
#![allow(clippy::print_stdout, reason = "an example")]

use brdf_image::Pixel;
use brdf_job::Job;
use brdf_mesh::{Camera, Mesh, Soup};
use brdf_model::Preset;
use brdf_relight::{
    BrdfMaps, Codec, CompareParams, CubeLightSampler, LightMaps, LightRule, MapParams, Occluder,
    Precomputation, PrecomputeParams, Quality, RelitScene, RenderParams, Surface, compare,
    factor_for_relighting, render,
};
use brdf_render::Environment;
use glam::DVec3;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let job = Job::new();
    let (mesh, _) = Mesh::new(plate(12))?;
    let brdf = Preset::ALL[0].brdf();
    let rank =
        MapParams { rank: 6, light_maps: LightMaps::Joint, resolution: 24, weight_power: 0.0 };
    let maps = BrdfMaps::of(&factor_for_relighting(&brdf, &rank, &job)?.model)?;

    let params =
        PrecomputeParams { codec: Codec::Wavelet { coefficients: 96 }, quality: Quality::One };
    let plan = Precomputation::new(&mesh, Surface::of(&mesh), maps, params);
    let occluder = Occluder::of(&mesh);
    let parts = [plan.run(&occluder)?];
    let (entries, bytes) = (parts[0].transport.entries(), parts[0].transport.bytes());
    println!("{} vertices: {entries} coefficients in {bytes} bytes", mesh.positions().len());

    let camera = Camera::around(mesh.centre(), mesh.radius(), DVec3::new(0.0, 0.8, 0.6));
    let shot = RenderParams { camera, size: 64, points: 1 };
    let (sampler, sky) = (CubeLightSampler::default(), Environment::sky()?);
    for degrees in [0.0_f64, 90.0] {
        let light = sampler.light(&sky, degrees.to_radians());
        let mut scene = RelitScene::default();
        scene.relight(&parts, &light.coefficients(LightRule::Energy));
        let (film, _) = render(&parts, &scene, &shot);
        let green = film.pixels().iter().filter_map(|pixel| match pixel {
            Pixel::Radiance(rgb, _) => Some(rgb.g),
            _ => None,
        });
        println!("sky turned by {degrees}°: brightest green {:.3}", green.fold(0.0, f64::max));
        let settings =
            CompareParams { vertices: 40, quality: Quality::One, rule: LightRule::Energy };
        let errors = compare(&parts[0], &occluder, &brdf, &light, &settings, &job)?;
        println!("  relative error {:.3}, of terms alone {:.3}", errors.total, errors.rank);
    }
    Ok(())
}

/// A square of `side` × `side` cells with a wave across it.
fn plate(side: u32) -> Soup {
    let at = |i: u32| f64::from(i) / f64::from(side) - 0.5;
    let points = (0..=side).flat_map(|z| (0..=side).map(move |x| (x, z)));
    let positions = points.map(|(x, z)| DVec3::new(at(x), 0.1 * (8.0 * at(x)).sin(), at(z)));
    let corner = |x: u32, z: u32| z * (side + 1) + x;
    let cells = (0..side).flat_map(|z| (0..side).map(move |x| (x, z)));
    let triangles = cells.flat_map(|(x, z)| {
        let (a, b, c, d) = (corner(x, z), corner(x + 1, z), corner(x, z + 1), corner(x + 1, z + 1));
        [[a, c, b], [b, c, d]]
    });
    Soup { positions: positions.collect(), triangles: triangles.collect(), ..Soup::default() }
}
