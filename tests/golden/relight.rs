//! Relighting against a picture by Mitsuba 3, rendered by `scripts/mitsuba_relight.py`: a torus of rough metal on the
//! ground, under a smooth sky with a soft lamp.

use brdf_image::{Film, Pixel};
use brdf_job::Job;
use brdf_mesh::{Camera, Mesh, Soup};
use brdf_model::{Analytic, Brdf, Fresnel, Ggx, Rgb};
use brdf_param::DirectionPair;
use brdf_relight::{
    BrdfMaps, Codec, CubeLight, CubeLightSampler, ExactParams, LightMaps, LightRule, MapParams,
    Occluder, Part, Precomputation, PrecomputeParams, Quality, RelitScene, RenderParams, Surface,
    exact_part, factor_for_relighting, render,
};
use brdf_render::Environment;
use glam::DVec3;

use crate::microfacet::{conductor, separable_over_correlated};

const GOLDEN: &str = include_str!("data/mitsuba_relight.csv");
const SIZE: usize = 64;
const ALPHA: f64 = 0.4;

/// Mitsuba's rough conductor, which masks and shadows each direction for itself.
struct Metal(Analytic);

impl Brdf for Metal {
    fn eval(&self, pair: &DirectionPair) -> Rgb {
        self.0.eval(pair) * separable_over_correlated(pair, ALPHA, ALPHA)
    }
}

fn metal() -> Metal {
    let fresnel: Fresnel = conductor();
    let ggx = Ggx { diffuse: Rgb::BLACK, fresnel, alpha_x: ALPHA, alpha_y: ALPHA };
    Metal(Analytic::Ggx(ggx))
}

fn light() -> CubeLight {
    let toward = DVec3::new(0.6, 0.64, 0.48);
    let (width, height) = (512, 256);
    let texels = (0..width * height).map(|at| {
        let theta = std::f64::consts::PI * ((at / width) as f64 + 0.5) / height as f64;
        // The middle of the map is −z, and it goes on over +x.
        let phi = std::f64::consts::TAU * (((at % width) as f64 + 0.5) / width as f64 - 0.5);
        let w = DVec3::new(theta.sin() * phi.sin(), theta.cos(), -theta.sin() * phi.cos());
        let (y, lobe) = (w.y.max(0.0), (30.0 * (w.dot(toward) - 1.0)).exp());
        #[expect(clippy::cast_possible_truncation, reason = "environments are f32")]
        let channel = |constant: f64, slope: f64, strength: f64| {
            ((constant + slope * y + strength * lobe) * (5.0 * y).min(1.0)) as f32
        };
        [channel(0.2, 0.3, 6.0), channel(0.22, 0.4, 5.0), channel(0.25, 0.6, 3.5)]
    });
    let environment = Environment::new(width, height, texels.collect()).unwrap();
    CubeLightSampler::default().light(&environment, 0.0)
}

/// Ground beneath the torus, finer where its shadow falls.
fn ground() -> Surface {
    const SIDE: u32 = 81;
    let place = |at: u32| {
        let x = 2.0 * f64::from(at) / f64::from(SIDE - 1) - 1.0;
        8.0 * x * x.abs().sqrt()
    };
    let cells = (0..SIDE - 1).flat_map(|row| (0..SIDE - 1).map(move |column| row * SIDE + column));
    let triangles = cells.flat_map(|at| {
        let below = at + SIDE;
        [[at, below, at + 1], [at + 1, below, below + 1]]
    });
    let positions: Vec<DVec3> =
        (0..SIDE * SIDE).map(|at| DVec3::new(place(at % SIDE), -0.5, place(at / SIDE))).collect();
    Surface { normals: vec![DVec3::Y; positions.len()], positions, triangles: triangles.collect() }
}

/// Relative RMS of pixels that are wholly covered here, and their number.
fn apart(film: &Film) -> (f64, usize) {
    let golden = GOLDEN.lines().filter(|line| !line.starts_with(['#', 'r']));
    let golden: Vec<Vec<f64>> =
        golden.map(|line| line.split(',').map(|value| value.parse().unwrap()).collect()).collect();
    assert_eq!(golden.len(), SIZE * SIZE, "pixels");
    let (mut differs, mut whole, mut count) = (0.0, 0.0, 0);
    for (pixel, wanted) in film.pixels().iter().zip(&golden) {
        if let Pixel::Radiance(found, 1.0) = pixel {
            for (found, wanted) in found.channels().into_iter().zip(wanted) {
                differs += (found - wanted).powi(2);
                whole += wanted * wanted;
            }
            count += 1;
        }
    }
    ((differs / whole).sqrt(), count)
}

#[test]
fn a_relit_torus_is_what_mitsuba_renders() {
    let (mesh, _) = Mesh::new(Soup::torus()).unwrap();
    let (occluder, metal, light) = (Occluder::of(&mesh), metal(), light());
    let eye = DVec3::new(1.2, 3.0, 4.2);
    let camera = Camera::looking_at(eye, DVec3::ZERO, DVec3::Y, 40_f64.to_radians()).unwrap();
    let shot = RenderParams { camera, size: SIZE, points: 4 };

    let fit =
        MapParams { rank: 16, light_maps: LightMaps::Joint, resolution: 48, weight_power: 0.0 };
    let maps =
        BrdfMaps::of(&factor_for_relighting(&metal, &fit, &Job::new()).unwrap().model).unwrap();
    let made =
        PrecomputeParams { codec: Codec::Clusters { tolerance: 1e-5 }, quality: Quality::One };
    let part = |surface: Surface, maps: BrdfMaps| -> Part<'static> {
        Precomputation::new(&mesh, surface, maps, made).run(&occluder).unwrap()
    };
    let parts = [part(Surface::of(&mesh), maps), part(ground(), BrdfMaps::diffuse(0.35))];
    let mut relit = RelitScene::default();
    relit.relight(&parts, &light.coefficients(LightRule::Energy));
    let (error, count) = apart(&render(&parts, &relit, &shot).0);
    assert!(count > SIZE * SIZE * 9 / 10, "{count} pixels");
    assert!(error < 0.022, "16 terms of clusters: {error}");

    let mut exact = RelitScene::default();
    let brdfs: [Option<&dyn Brdf>; 2] = [Some(&metal), None];
    let parts: Vec<Part<'_>> = parts
        .iter()
        .zip(brdfs)
        .map(|(part, brdf)| {
            let params = ExactParams { mesh: &mesh, occluder: &occluder, brdf, light: &light, eye };
            let (part, colours) = exact_part(part, &params, &Job::new()).unwrap();
            exact.parts.push(colours);
            part
        })
        .collect();
    let (error, _) = apart(&render(&parts, &exact, &shot).0);
    assert!(error < 0.01, "brute force at vertices: {error}");
}
