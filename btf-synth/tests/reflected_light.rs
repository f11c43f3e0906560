//! Scenes whose images are known.

#![allow(
    clippy::unwrap_used,
    clippy::missing_panics_doc,
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    reason = "a test that cannot go on has failed; sides of a few texels"
)]

use brdf_model::{Analytic, Fresnel, Ggx, Lambert, Rgb};
use btf_synth::{
    LIGHT_COUNT, Reflectance, SurfaceMaps, SurfaceScene, SynthOptions, ubo_directions,
};

const DIRECT: SynthOptions = SynthOptions { samples: 16, bounce_rays: 0 };

fn direction(theta_deg: u32, phi_deg: u32) -> usize {
    ubo_directions().iter().position(|&d| d == (theta_deg, phi_deg)).unwrap()
}

fn cos_deg(theta_deg: u32) -> f32 {
    f64::from(theta_deg).to_radians().cos() as f32
}

fn view(scene: &SurfaceScene<'_>, index: usize) -> Vec<f32> {
    let mut images = vec![0.0; LIGHT_COUNT * scene.width() * scene.height() * 3];
    scene.synthesize_view(index, &mut images);
    images
}

/// Red of a texel.
fn red(scene: &SurfaceScene<'_>, images: &[f32], light: usize, column: usize, row: usize) -> f32 {
    images[((light * scene.height() + row) * scene.width() + column) * 3]
}

/// Heights in texels, white, rough.
fn white(width: usize, height: usize, texels: impl Fn(usize, usize) -> f32) -> SurfaceMaps {
    let heights =
        (0..width * height).map(|i| texels(i % width, i / width) / width as f32).collect();
    let count = width * height;
    SurfaceMaps::new(width, height, heights, vec![[1.0; 3]; count], vec![0.6; count]).unwrap()
}

/// Hills without symmetry, up to about three texels high.
fn hills(column: usize, row: usize) -> f32 {
    let turn = std::f32::consts::TAU / 12.0;
    let (x, y) = (column as f32 * turn, row as f32 * turn);
    1.5 * x.sin() * y.cos() + 0.8 * (2.0 * x + y).cos() + 0.4 * (x - 3.0 * y).sin()
}

#[test]
fn a_white_plane_reflects_the_cosine_to_every_view() {
    let maps = white(2, 3, |_, _| 7.0);
    let options = SynthOptions { samples: 3, bounce_rays: 8 };
    let scene = SurfaceScene::new(&maps, Reflectance::Lambertian, &options).unwrap();
    for index in 0..LIGHT_COUNT {
        let images = view(&scene, index);
        for (image, (theta, _)) in images.chunks_exact(18).zip(ubo_directions()) {
            let expected = cos_deg(theta);
            assert!(
                image.iter().all(|value| (value - expected).abs() < 1e-4),
                "{theta}: {image:?}"
            );
        }
    }
}

#[test]
fn a_shifted_tile_gives_shifted_images() {
    let (side, across, down) = (12, 3, 5);
    let maps = white(side, side, hills);
    let moved =
        white(side, side, |c, r| hills((c + side - across) % side, (r + side - down) % side));
    let scene = |maps| {
        let options = SynthOptions { samples: 16, bounce_rays: 16 };
        SurfaceScene::new(maps, Reflectance::Ggx { f0: 0.04 }, &options).unwrap()
    };
    let (scene, moved) = (scene(&maps), scene(&moved));
    for index in [0, direction(45, 20), direction(75, 285)] {
        let (images, other) = (view(&scene, index), view(&moved, index));
        let mut differing = 0;
        for light in 0..LIGHT_COUNT {
            for texel in 0..side * side {
                let (column, row) = (texel % side, texel / side);
                let there = ((column + across) % side, (row + down) % side);
                let value = red(&scene, &images, light, column, row);
                let same = red(&moved, &other, light, there.0, there.1);
                differing += usize::from((value - same).abs() > 1e-3);
            }
        }
        // Positions round differently, which can move a sample at the edge of a shadow across it.
        assert!(differing < LIGHT_COUNT * side * side / 500, "view {index}: {differing}");
    }
}

#[test]
fn threads_do_not_change_a_bit() {
    let maps = white(12, 12, hills);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let options = SynthOptions { samples: 4, bounce_rays: 8 };
            let scene = SurfaceScene::new(&maps, Reflectance::Ggx { f0: 0.04 }, &options).unwrap();
            view(&scene, direction(60, 36))
        })
    };
    assert_eq!(run(1), run(2));
}

#[test]
fn a_wall_throws_a_shadow_away_from_the_light_as_long_as_it_is_high() {
    // Six texels high, over columns 20 to 24 of 48; then the same along rows.
    let wall = |along: usize| if (20..25).contains(&along) { 6.0 } else { 0.0 };
    let maps = white(48, 2, |column, _| wall(column));
    let scene = SurfaceScene::new(&maps, Reflectance::Lambertian, &DIRECT).unwrap();
    let images = view(&scene, 0);
    let lit = |light: usize| -> Vec<bool> {
        (0..48).map(|column| red(&scene, &images, light, column, 0) > 0.3).collect()
    };
    // A light right of the image (azimuth 0): the shadow falls to the left.
    let ground = lit(direction(45, 0));
    assert!(ground[15..19].iter().all(|lit| !lit), "shadow: {ground:?}");
    assert!(ground[..13].iter().chain(&ground[27..]).all(|lit| *lit), "light: {ground:?}");
    let ground = lit(direction(45, 180));
    assert!(ground[26..30].iter().all(|lit| !lit), "shadow: {ground:?}");
    assert!(ground[..18].iter().chain(&ground[32..]).all(|lit| *lit), "light: {ground:?}");

    // A light above the image (azimuth 90°): the shadow falls below, to larger rows.
    let maps = white(2, 48, |_, row| wall(row));
    let scene = SurfaceScene::new(&maps, Reflectance::Lambertian, &DIRECT).unwrap();
    let images = view(&scene, 0);
    let at = |row| red(&scene, &images, direction(30, 90), 0, row);
    assert!(at(26) == 0.0 && at(30) > 0.8 && at(17) > 0.8, "{} {} {}", at(26), at(30), at(17));
}

#[test]
fn what_stands_out_moves_away_from_the_viewer() {
    // A black plateau with a white line along its middle.
    let is_plateau = |texel: usize| (10..22).contains(&(texel % 32));
    let is_line = |texel: usize| (15..17).contains(&(texel % 32));
    let heights = (0..64).map(|t| if is_plateau(t) { 6.0 / 32.0 } else { 0.0 }).collect();
    let albedo = (0..64).map(|t| [f32::from(u8::from(is_line(t))); 3]).collect();
    let maps = SurfaceMaps::new(32, 2, heights, albedo, vec![1.0; 64]).unwrap();
    let scene = SurfaceScene::new(&maps, Reflectance::Lambertian, &DIRECT).unwrap();
    let centroid = |view_index: usize| {
        let images = view(&scene, view_index);
        let row: Vec<f32> = (0..32).map(|c| red(&scene, &images, 0, c, 0)).collect();
        let sum: f32 = row.iter().sum();
        row.iter().enumerate().map(|(c, v)| c as f32 * v).sum::<f32>() / sum
    };
    let upright = centroid(0);
    assert!((upright - 15.5).abs() < 0.05, "{upright}");
    let height = 6.0 * (1.0 - 12.0 / 32.0);
    // From the right (azimuth 0) at 45° the top moves left by its height above the mean.
    let from_right = centroid(direction(45, 0)) - upright;
    assert!((from_right + height).abs() < 0.05, "{from_right}");
    let from_left = centroid(direction(45, 180)) - upright;
    assert!((from_left - height).abs() < 0.05, "{from_left}");
}

#[test]
fn one_bounce_brightens_and_no_more_than_doubles() {
    let maps = white(12, 12, hills);
    let scene = |bounce_rays| {
        let options = SynthOptions { samples: 4, bounce_rays };
        SurfaceScene::new(&maps, Reflectance::Lambertian, &options).unwrap()
    };
    let index = direction(30, 90);
    let (direct, both) = (view(&scene(0), index), view(&scene(64), index));
    let mut gain = 0.0;
    for (direct, both) in direct.iter().zip(&both) {
        assert!(*both >= *direct - 1e-6 && *both <= *direct + 1.0 + 1e-5, "{direct} {both}");
        gain += both - direct;
    }
    assert!(gain > 0.0, "hills see each other");
}

#[test]
fn a_material_in_the_frame_of_the_normal_equals_the_built_in_reflectance() {
    let maps = white(8, 8, |column, row| 0.2 * hills(column, row));
    let scene = |reflectance| {
        let options = SynthOptions { samples: 2, bounce_rays: 0 };
        SurfaceScene::new(&maps, reflectance, &options).unwrap()
    };
    let alpha = f64::from(0.6_f32).powi(2);
    // Nearly a perfect mirror, whose reflectance both Fresnel terms call 1 at every angle.
    let fresnel = Fresnel::Conductor { eta: Rgb::splat(1.0), k: Rgb::splat(1e4) };
    let diffuse = Rgb::splat(1.0);
    let ggx = Analytic::Ggx(Ggx { diffuse, fresnel, alpha_x: alpha, alpha_y: alpha });
    let lambert = Analytic::Lambert(Lambert { albedo: Rgb::splat(1.0) });
    let index = direction(45, 60);
    let compare = |built_in, material| {
        let (expected, found) = (view(&scene(built_in), index), view(&scene(material), index));
        for (at, (expected, found)) in expected.iter().zip(&found).enumerate() {
            // The tolerance is that of f32 cosines near the horizon.
            assert!((expected - found).abs() < 1e-3 * (1.0 + expected), "{at}: {expected} {found}");
        }
    };
    compare(Reflectance::Lambertian, Reflectance::Material(&lambert));
    compare(Reflectance::Ggx { f0: 1.0 }, Reflectance::Material(&ggx));
}

#[test]
fn options_out_of_range_are_refused() {
    let maps = white(2, 2, |_, _| 0.0);
    let refused = |reflectance, options| SurfaceScene::new(&maps, reflectance, &options).is_err();
    assert!(refused(Reflectance::Lambertian, SynthOptions { samples: 0, bounce_rays: 0 }));
    assert!(refused(Reflectance::Lambertian, SynthOptions { samples: 1, bounce_rays: 5000 }));
    assert!(refused(Reflectance::Ggx { f0: f32::NAN }, DIRECT));
}
