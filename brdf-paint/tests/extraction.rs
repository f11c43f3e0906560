//! Materials made of rendered paintings.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use brdf_job::Job;
use brdf_mesh::{Mesh, Soup};
use brdf_model::{Analytic, Brdf, Preset, Rgb};
use brdf_paint::{
    Contradictions, Extraction, GroundTruth, LightSource, Mode, PaintError, PaintLogTransform,
    PaintParams, PaintSamples, PaintView, PaintedImage, SolverChoice, ViewBuffers, extract,
    face_views, vertex_views,
};
use brdf_param::DirectionPair;

const SIZE: usize = 64;

fn torus() -> Mesh {
    Mesh::new(Soup::torus()).unwrap().0.with_sphere_coordinates()
}

fn presets() -> [Analytic; 3] {
    ["lafortune-blue-paint", "red-plastic", "ggx"].map(|name| Preset::find(name).unwrap().brdf())
}

fn buffers(mesh: &Mesh, views: &[PaintView]) -> Vec<ViewBuffers> {
    views.iter().map(|view| ViewBuffers::of(mesh, view, SIZE, SIZE)).collect()
}

fn samples(truth: &GroundTruth<'_>, views: &[ViewBuffers]) -> PaintSamples {
    let mut samples = PaintSamples::new();
    for (view, buffers) in views.iter().enumerate() {
        samples.add(view, "view", buffers, &truth.paint(buffers), 0.1).unwrap();
    }
    samples
}

fn params(mode: Mode, solver: SolverChoice) -> PaintParams {
    PaintParams {
        mode,
        solver,
        products: 3,
        texels: 32,
        map_size: 64,
        surface_size: 16,
        wraps: true,
        ..PaintParams::default()
    }
}

fn made(samples: &PaintSamples, params: &PaintParams) -> Extraction {
    extract(samples, params, &Job::new()).unwrap()
}

#[test]
fn turns_find_three_blended_materials_where_the_published_way_does_not() {
    let (mesh, brdfs) = (torus(), presets());
    let painted = buffers(&mesh, &vertex_views(&mesh));
    let truth = GroundTruth { brdfs: [&brdfs[0], &brdfs[1], &brdfs[2]], scale: 1.0 };
    let truth = truth.scaled_for(&painted);
    let training = samples(&truth, &painted);
    let held_out = samples(&truth, &buffers(&mesh, &face_views(&mesh)));
    let published = made(&training, &params(Mode::MaterialMap, SolverChoice::Paper));
    let turns = made(&training, &params(Mode::MaterialMap, SolverChoice::Alternating));
    assert!(turns.errors.rms < 0.5 * published.errors.rms, "{:?}", turns.errors);
    let errors = [&published, &turns].map(|made| made.material.errors(&held_out).rms);
    assert!(errors[1] < 0.5 * errors[0] && errors[1] < 0.05, "held out: {errors:?}");
    for other in [&published, &turns] {
        let recomputed = other.material.errors(&training);
        assert!((recomputed.rms - other.errors.rms).abs() < 1e-9, "of the model that is returned");
    }
}

/// A matt BRDF of three radial factors.
struct Product;

impl Brdf for Product {
    fn eval(&self, pair: &DirectionPair) -> Rgb {
        let radius = |w: glam::DVec3| w.truncate().length();
        let value =
            (1.2 - radius(pair.wi)) * (1.3 - radius(pair.wo)) * (-radius(pair.half())).exp();
        Rgb::new(0.2, 0.1, 0.05) * value
    }
}

#[test]
fn a_single_product_is_found_by_every_mode() {
    let mesh = torus();
    let painted = buffers(&mesh, &vertex_views(&mesh));
    let truth = GroundTruth { brdfs: [&Product, &Product, &Product], scale: 1.0 };
    let training = samples(&truth, &painted);
    let mean = training.values.iter().map(|v| f64::from(v[1])).sum::<f64>() / training.len() as f64;
    for mode in [Mode::Brdf, Mode::FourFactor] {
        let params = PaintParams {
            log_map: PaintLogTransform::Offset(1e-3),
            ..params(mode, SolverChoice::Paper)
        };
        let made = made(&training, &params);
        assert!(made.errors.rms < 0.01 * mean, "{mode:?}: {:?} of {mean}", made.errors);
        assert_eq!(made.material.components.len(), 1);
    }
    for mode in [Mode::MaterialMap, Mode::Hybrid] {
        let made = made(&training, &params(mode, SolverChoice::Alternating));
        assert!(made.errors.rms < 0.03 * mean, "{mode:?}: {:?} of {mean}", made.errors);
    }
}

#[test]
fn threads_change_nothing() {
    let (mesh, brdfs) = (torus(), presets());
    let painted = buffers(&mesh, &vertex_views(&mesh)[..4]);
    let truth = GroundTruth { brdfs: [&brdfs[0], &brdfs[1], &brdfs[2]], scale: 0.5 };
    let training = samples(&truth, &painted);
    let params = params(Mode::MaterialMap, SolverChoice::Alternating);
    let [one, two] = [1, 2].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| made(&training, &params))
    });
    assert_eq!(one, two);
}

#[test]
fn what_gives_no_sample_is_counted() {
    let mesh = torus();
    let buffers = &buffers(&mesh, &vertex_views(&mesh)[..1])[0];
    let mut image =
        PaintedImage { width: SIZE, height: SIZE, pixels: vec![[0.5, 0.5, 0.5, 1.0]; SIZE * SIZE] };
    let lit = |s: &brdf_paint::PixelSurface| s.is_seen_and_lit() && s.wi.z >= 0.1;
    let inside: Vec<usize> =
        (0..SIZE * SIZE).filter(|at| buffers.pixels[*at].as_ref().is_some_and(lit)).collect();
    image.pixels[inside[0]][3] = 0.0;
    image.pixels[inside[1]][0] = f32::NAN;
    // Finite, but not once it is divided by the cosine.
    image.pixels[inside[3]][2] = f32::MAX;
    image.pixels[inside[2]][1] = -1.0;
    let mut samples = PaintSamples::new();
    samples.add(0, "view", buffers, &image, 0.1).unwrap();
    let skipped = samples.skipped;
    assert_eq!((skipped.transparent, skipped.not_finite, skipped.clamped), (1, 2, 1));
    assert_eq!(samples.len(), inside.len() - 3);
    let seen = buffers.pixels.iter().flatten().count();
    assert_eq!(skipped.outside, SIZE * SIZE - seen);
    assert_eq!(skipped.grazing, seen - inside.len());
    image.pixels.pop();
    image.width -= 1;
    let refused = samples.add(0, "view", buffers, &image, 0.1);
    assert!(matches!(refused, Err(PaintError::Size { .. })), "{refused:?}");
    let nothing = extract(&PaintSamples::new(), &PaintParams::default(), &Job::new());
    assert!(matches!(nothing, Err(PaintError::NothingPainted { .. })));
}

#[test]
fn views_that_contradict_each_other_are_found_where_they_do() {
    let mesh = torus();
    let views = buffers(&mesh, &vertex_views(&mesh));
    let painted = |colour: &dyn Fn(usize, f64) -> [f32; 3]| {
        let mut samples = PaintSamples::new();
        for (view, buffers) in views.iter().enumerate() {
            let pixels = buffers.pixels.iter().map(|surface| {
                let Some(surface) = surface else { return [0.0; 4] };
                let [r, g, b] = colour(view, surface.uv.x);
                [r, g, b, 1.0]
            });
            let image = PaintedImage { width: SIZE, height: SIZE, pixels: pixels.collect() };
            samples.add(view, "view", buffers, &image, 0.3).unwrap();
        }
        made(&samples, &params(Mode::MaterialMap, SolverChoice::Alternating)).contradictions
    };
    // Half of the surface changes from view to view.
    let (red, blue) = ([0.8, 0.1, 0.1], [0.1, 0.1, 0.8]);
    let found = painted(&|view, u| if view % 2 == 0 && u < 0.5 { red } else { blue });
    let in_half = |left: bool| {
        let cells = found.apart.iter().enumerate();
        let chosen = cells.filter(|(at, _)| (at % found.size < found.size / 2) == left);
        chosen.filter(|(_, apart)| f64::from(**apart) > Contradictions::THRESHOLD).count()
    };
    let (left, right) = (in_half(true), in_half(false));
    assert!(left > 50 && right * 10 < left, "{left} and {right} cells");
}

#[test]
fn photographs_with_shadows_and_a_near_light_give_the_same_reflectance() {
    let (mesh, brdfs) = (torus(), presets());
    let truth = GroundTruth { brdfs: [&brdfs[0], &brdfs[1], &brdfs[2]], scale: 0.5 };
    let mut view = vertex_views(&mesh).remove(3);
    let LightSource::Direction(towards) = view.light else { unreachable!("built-in views") };
    view.light = LightSource::Position(mesh.centre() + 2.0 * mesh.radius() * towards);
    view.has_shadows = true;
    let white = [1.5_f32, 1.0, 0.5];
    view.white = white.map(f64::from);
    let buffers = ViewBuffers::of(&mesh, &view, 90, 60);
    let mut photograph = truth.paint(&buffers);
    for pixel in &mut photograph.pixels {
        pixel.iter_mut().zip(white).for_each(|(v, white)| *v *= white);
    }
    let mut samples = PaintSamples::new();
    samples.add(0, "photograph", &buffers, &photograph.balanced(view.white), 0.1).unwrap();
    assert!(samples.skipped.shadowed > 20, "the ring shades itself: {}", samples.skipped);
    let irradiance: Vec<f64> = buffers.pixels.iter().flatten().map(|s| s.irradiance).collect();
    let nearest = irradiance.iter().copied().fold(0.0, f64::max);
    assert!(nearest > 1.5 && nearest < 4.0, "places near the light get more: {nearest}");
    for ((pair, place), value) in samples.pairs.iter().zip(&samples.places).zip(&samples.values) {
        let wanted = truth.value(pair, *place).channels();
        let close = value.iter().zip(wanted).all(|(v, w)| (f64::from(*v) - w).abs() < 1e-5);
        assert!(close, "{value:?} for {wanted:?}");
    }
}

#[test]
fn the_highlight_map_favours_highlights() {
    let (mesh, brdfs) = (torus(), presets());
    let painted = buffers(&mesh, &vertex_views(&mesh)[..4]);
    let truth = GroundTruth { brdfs: [&brdfs[0], &brdfs[1], &brdfs[2]], scale: 0.3 };
    let training = samples(&truth, &painted);
    let errors = |log_map| {
        let params = PaintParams { log_map, ..params(Mode::Brdf, SolverChoice::Paper) };
        let predicted = made(&training, &params).material.predict(&training);
        let bright = |at: &usize| training.values[*at][1] > 0.6;
        let rms = |places: &mut dyn Iterator<Item = usize>| {
            let squares = places.map(|at| (predicted[at][1] - training.values[at][1]).powi(2));
            let squares: Vec<f32> = squares.collect();
            (squares.iter().sum::<f32>() / squares.len() as f32).sqrt()
        };
        let all = 0..training.len();
        (rms(&mut all.clone().filter(bright)), rms(&mut all.filter(|at| !bright(at))))
    };
    let (offset, highlight) =
        (errors(PaintLogTransform::Offset(0.05)), errors(PaintLogTransform::Highlight));
    assert!(highlight.0 < offset.0, "bright pixels: {highlight:?} and {offset:?}");
    let params = PaintParams {
        log_map: PaintLogTransform::Highlight,
        ..params(Mode::MaterialMap, SolverChoice::Alternating)
    };
    let turns = made(&training, &params);
    assert!(turns.errors.rms < 0.05, "slopes of both signs: {:?}", turns.errors);
}

#[test]
fn thinning_takes_from_everywhere() {
    let mesh = torus();
    let views = buffers(&mesh, &vertex_views(&mesh)[..3]);
    let brdf = presets();
    let truth = GroundTruth { brdfs: [&brdf[0], &brdf[1], &brdf[2]], scale: 0.5 };
    let all = samples(&truth, &views);
    let thin = all.subset(all.len() * 6 / 10);
    assert_eq!(thin.len(), all.len() * 6 / 10);
    for view in 0..3 {
        let count = |samples: &PaintSamples| samples.origins.iter().filter(|o| o.0 == view).count();
        assert!((count(&thin) * 10).abs_diff(count(&all) * 6) <= 10, "view {view}");
    }
    let params = PaintParams { map_size: 4096, products: 10, ..PaintParams::default() };
    let refused = extract(&thin, &params, &Job::new());
    assert!(matches!(refused, Err(PaintError::Option { .. })), "more memory than there is");
}

#[test]
fn a_black_painting_is_black() {
    let mesh = torus();
    let painted = buffers(&mesh, &vertex_views(&mesh)[..2]);
    let mut samples = PaintSamples::new();
    for (view, buffers) in painted.iter().enumerate() {
        let pixels = vec![[0.0, 0.0, 0.0, 1.0]; SIZE * SIZE];
        let image = PaintedImage { width: SIZE, height: SIZE, pixels };
        samples.add(view, "black", buffers, &image, 0.1).unwrap();
    }
    for solver in [SolverChoice::Paper, SolverChoice::Alternating] {
        let made = made(&samples, &params(Mode::MaterialMap, solver));
        assert!(made.errors.max < 1e-3, "{:?}", made.errors);
    }
}
