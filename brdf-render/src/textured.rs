//! Pictures of materials that vary over a tile.

use brdf_image::Film;

use crate::light::Light;
use crate::shape::{Scene, Shape};
use crate::spatially_varying::SpatiallyVarying;
use crate::stage::render_stage;

/// Options of a picture of a tiled material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TexturedView {
    /// Pixels in a row; a plane has fewer rows, as many as it fills.
    pub size: usize,
    /// Samples of the environment per pixel, shared among the points within it.
    pub samples: u32,
    /// Repeats of the tile between the left and the right of the shape: along half the equator of
    /// a sphere, half the turn of a cylinder.
    pub tiles: f64,
    /// Radians between the shape and upright; see [`Shape`]. None is [`Shape::default_tilt`].
    pub tilt: Option<f64>,
}

impl Default for TexturedView {
    fn default() -> Self {
        Self { size: 256, samples: 256, tiles: 4.0, tilt: None }
    }
}

/// Renders a shape with a tiled material under a light. Light from below a point's horizon gives nothing; nothing
/// else casts shadows.
///
/// Each pixel is the mean of 3 × 3 points, whose footprints are a third of the pixel's. The same
/// view and light give the same random numbers for every material, so that differences show the
/// materials; the same bits come from any number of threads.
pub fn render_textured(
    material: &dyn SpatiallyVarying,
    shape: Shape,
    light: &Light,
    view: &TexturedView,
) -> Film {
    let tilt = view.tilt.unwrap_or_else(|| shape.default_tilt());
    let scene = Scene::new(material, shape, tilt, view.tiles, view.size);
    render_stage(&scene, light, view.samples)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use brdf_image::Pixel;
    use brdf_model::{Preset, Rgb};
    use glam::DVec3;

    use super::*;
    use crate::{DirectionalLight, Environment, SphereView, TexturePoint, Uniform, render_sphere};

    /// White and black squares, two by two in a tile; white at the lower left.
    struct Chequer;

    impl SpatiallyVarying for Chequer {
        fn reflect(&self, at: &TexturePoint, _wo: DVec3, lights: &[DVec3], out: &mut [Rgb]) {
            let white = (at.u < 0.5) == (at.v < 0.5);
            for (value, wi) in out.iter_mut().zip(lights) {
                *value = Rgb::splat(if white { wi.z / PI } else { 0.0 });
            }
        }
    }

    /// Shows u in red and v in green.
    struct Coordinates;

    impl SpatiallyVarying for Coordinates {
        fn reflect(&self, at: &TexturePoint, _wo: DVec3, _lights: &[DVec3], out: &mut [Rgb]) {
            out.fill(Rgb::new(at.u, at.v, 0.0));
        }
    }

    fn facing() -> Light {
        Light::Directional(DirectionalLight { theta: 0.0, phi: 0.0 })
    }

    fn small() -> TexturedView {
        TexturedView { size: 33, samples: 90, ..TexturedView::default() }
    }

    fn radiance(film: &Film, column: usize, row: usize) -> Rgb {
        match film.pixels()[row * film.width() + column] {
            Pixel::Radiance(rgb, _) => rgb,
            other => panic!("{other:?} at column {column}, row {row}"),
        }
    }

    #[test]
    fn a_uniform_sphere_under_one_light_is_the_sphere_of_the_brdf() {
        let brdf = Preset::find("cook-torrance").unwrap().brdf();
        let light = Light::Directional(DirectionalLight::default());
        let plain = render_sphere(&brdf, &light, &SphereView { size: 33, samples: 1 });
        let textured = render_textured(&Uniform(&brdf), Shape::Sphere, &light, &small());
        for (a, b) in plain.pixels().iter().zip(textured.pixels()) {
            match (a, b) {
                (Pixel::Radiance(a, x), Pixel::Radiance(b, y)) => {
                    let apart = (*a - *b).map(f64::abs).max_channel();
                    assert!(apart <= 1e-6 * a.max_channel(), "{a:?} and {b:?}");
                    assert!((x - y).abs() < 1e-12, "cover {x} and {y}");
                }
                _ => assert_eq!(a, b, "one covers the pixel, one does not"),
            }
        }
    }

    #[test]
    fn a_uniform_sphere_in_an_environment_is_the_sphere_of_the_brdf() {
        let brdf = Preset::find("lafortune-blue-paint").unwrap().brdf();
        for environment in [Environment::sky().unwrap(), Environment::studio().unwrap()] {
            let light = Light::Environment(environment);
            let plain = render_sphere(&brdf, &light, &SphereView { size: 17, samples: 3000 });
            let view = TexturedView { size: 17, samples: 3000, ..TexturedView::default() };
            let textured = render_textured(&Uniform(&brdf), Shape::Sphere, &light, &view);
            for (a, b) in plain.pixels().iter().zip(textured.pixels()) {
                // The rim is the mean of its points here, one point there.
                if let (Pixel::Radiance(a, _), Pixel::Radiance(b, cover)) = (a, b)
                    && *cover > 0.999
                {
                    let (a, b) = (a.luminance(), b.luminance());
                    assert!((a / b - 1.0).abs() < 0.12, "{a} and {b}");
                }
            }
        }
    }

    #[test]
    fn a_plane_shows_as_many_tiles_as_asked() {
        let view = TexturedView { size: 200, tilt: Some(0.0), ..TexturedView::default() };
        for tiles in [1_u8, 3, 5] {
            let view = TexturedView { tiles: f64::from(tiles), ..view };
            let film = render_textured(&Chequer, Shape::Plane, &facing(), &view);
            let line = |place: &dyn Fn(usize) -> usize| {
                let lit: Vec<bool> = (0..200)
                    .filter_map(|i| match film.pixels()[place(i)] {
                        Pixel::Radiance(rgb, _) => Some(rgb.r > 0.25),
                        _ => None,
                    })
                    .collect();
                1 + lit.windows(2).filter(|w| w[0] != w[1]).count()
            };
            let squares = 2 * usize::from(tiles);
            assert_eq!(line(&|i| 10 * 200 + i), squares, "squares in a row of {tiles} tiles");
            assert_eq!(line(&|i| 200 * i + 10), squares, "squares in a column of {tiles} tiles");
        }
    }

    #[test]
    fn u_runs_right_and_v_up_on_every_shape() {
        for shape in [Shape::Plane, Shape::Sphere, Shape::Cylinder] {
            let view = TexturedView { tiles: 1.0, tilt: Some(0.2), ..small() };
            let film = render_textured(&Coordinates, shape, &facing(), &view);
            let (middle, rows) = (16, film.height());
            let [left, right] = [8, 24].map(|column| radiance(&film, column, rows / 2));
            assert!(right.r > left.r, "{shape:?}: u runs right");
            let [low, high] = [rows / 2 + 2, rows / 2 - 2].map(|row| radiance(&film, middle, row));
            assert!(high.g > low.g, "{shape:?}: v runs up");
        }
    }

    #[test]
    fn a_white_plane_that_faces_the_light_shows_as_one() {
        struct White;
        impl SpatiallyVarying for White {
            fn reflect(&self, _at: &TexturePoint, _wo: DVec3, lights: &[DVec3], out: &mut [Rgb]) {
                out.iter_mut().zip(lights).for_each(|(v, wi)| *v = Rgb::splat(wi.z / PI));
            }
        }
        let view = TexturedView { tilt: Some(0.0), ..small() };
        let film = render_textured(&White, Shape::Plane, &facing(), &view);
        assert!((radiance(&film, 16, 16).g - 1.0).abs() < 1e-12, "π of irradiance on albedo 1");
        let even = Environment::new(4, 2, vec![[1.0; 3]; 8]).unwrap();
        let light = Light::Environment(even);
        let view = TexturedView { tilt: Some(0.0), samples: 20_000, ..small() };
        let film = render_textured(&White, Shape::Plane, &light, &TexturedView { size: 5, ..view });
        let seen = radiance(&film, 2, 2).g;
        assert!((seen - 1.0).abs() < 2e-3, "even light of radiance 1 on albedo 1: {seen}");
    }

    #[test]
    fn a_light_behind_the_shape_shows_nothing() {
        let light = Light::Directional(DirectionalLight { theta: 3.1, phi: 0.0 });
        let film = render_textured(&Coordinates, Shape::Sphere, &light, &small());
        assert_eq!(radiance(&film, 16, 16), Rgb::BLACK, "its horizon hides the light");
    }

    #[test]
    fn threads_change_nothing() {
        let light = Light::Environment(Environment::sky().unwrap());
        let [one, two] = [1, 2].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| render_textured(&Chequer, Shape::Cylinder, &light, &small()))
        });
        assert_eq!(one, two, "one thread and two");
    }
}
