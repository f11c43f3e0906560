//! A sphere under a light.

use brdf_image::{Film, Pixel};
use brdf_model::{Brdf, DirectionBatch, Rgb, RgbBatch, ScrambledSobol, cosine_hemisphere};
use brdf_param::{DirectionPair, Frame};
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::f64::consts::PI;

use crate::half_lobe::HalfLobe;
use crate::light::{Environment, Light};

/// Options of a picture of a sphere.
///
/// The picture is orthographic, and the sphere fills the frame but for a small margin. The tangent of the surface
/// runs along the meridians' east, so anisotropic materials are brushed around the vertical axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphereView {
    /// Pixels along each side.
    pub size: usize,
    /// Samples of the environment per pixel; for a directional light, points across the pixel.
    pub samples: u32,
}

impl Default for SphereView {
    fn default() -> Self {
        Self { size: 256, samples: 256 }
    }
}

/// Radius of the sphere in half frames.
pub(crate) const RADIUS: f64 = 0.96;
/// Share of the light on a pixel from directions without data above which the pixel has none.
const MOST_UNKNOWN: f64 = 0.1;
/// Points along each side of a pixel under a directional light.
pub(crate) const SUPERSAMPLING: u32 = 3;

/// Renders a sphere of one material under a light.
///
/// The same view and light give the same random numbers for every material, so that differences show the materials.
///
/// ```
/// use brdf_image::Pixel;
/// use brdf_model::{Analytic, Lambert, Rgb};
/// use brdf_render::{DirectionalLight, Light, SphereView, render_sphere};
///
/// let white = Analytic::Lambert(Lambert { albedo: Rgb::splat(1.0) });
/// let light = Light::Directional(DirectionalLight { theta: 0.0, phi: 0.0 });
/// let film = render_sphere(&white, &light, &SphereView { size: 33, samples: 1 });
/// let Pixel::Radiance(middle, _) = film.pixels()[33 * 16 + 16] else { panic!("the sphere") };
/// assert!((middle.g - 1.0).abs() < 0.01, "a white diffuser that faces the light");
/// ```
pub fn render_sphere(brdf: &dyn Brdf, light: &Light, view: &SphereView) -> Film {
    let size = view.size.max(1);
    let pixels = (0..size)
        .into_par_iter()
        .flat_map_iter(|row| {
            let mut scratch = Scratch::default();
            (0..size)
                .map(|column| match light {
                    Light::Directional(light) => {
                        directional(brdf, light.direction(), size, column, row)
                    }
                    Light::Environment(environment) => {
                        lit_by(brdf, environment, view, column, row, &mut scratch)
                    }
                })
                .collect::<Vec<_>>()
        })
        .collect();
    Film::new(size, pixels)
}

/// The surface frame at a point of the visible hemisphere: east, north, normal.
fn frame_at(point: DVec2) -> Option<Frame> {
    let radius_sq = point.length_squared();
    if radius_sq >= 1.0 {
        return None;
    }
    let normal = point.extend((1.0 - radius_sq).sqrt());
    let tangent = DVec3::Y.cross(normal).try_normalize().unwrap_or(DVec3::X);
    Some(Frame { tangent, bitangent: normal.cross(tangent), normal })
}

/// The point of the unit sphere's disc under a place in the picture, y up.
fn disc_point(size: usize, column: f64, row: f64) -> DVec2 {
    let half = 0.5 * size as f64;
    DVec2::new(column - half, half - row) / (half * RADIUS)
}

fn directional(brdf: &dyn Brdf, light: DVec3, size: usize, column: usize, row: usize) -> Pixel {
    let (mut sum, mut hits, mut known) = (Rgb::BLACK, 0_u32, 0_u32);
    for step in 0..SUPERSAMPLING * SUPERSAMPLING {
        let offset = |index: u32| (f64::from(index) + 0.5) / f64::from(SUPERSAMPLING);
        let x = column as f64 + offset(step % SUPERSAMPLING);
        let y = row as f64 + offset(step / SUPERSAMPLING);
        let Some(frame) = frame_at(disc_point(size, x, y)) else { continue };
        hits += 1;
        let pair = DirectionPair::new(frame.to_local(light), frame.to_local(DVec3::Z));
        if pair.wi.z <= 0.0 {
            known += 1;
        } else if brdf.has_data(&pair) {
            known += 1;
            sum = sum + brdf.eval(&pair) * (PI * pair.wi.z);
        }
    }
    finish(sum / f64::from(known.max(1)), hits, known)
}

fn finish(radiance: Rgb, hits: u32, known: u32) -> Pixel {
    if hits == 0 {
        Pixel::Background
    } else if 2 * known < hits {
        Pixel::NoData
    } else {
        Pixel::Radiance(radiance, f64::from(hits) / f64::from(SUPERSAMPLING * SUPERSAMPLING))
    }
}

/// Buffers that one row of pixels shares.
#[derive(Default)]
struct Scratch {
    pairs: DirectionBatch,
    /// Incident radiance times cosine over pdf, per pair.
    weights: Vec<Rgb>,
    values: RgbBatch,
}

/// One third of the samples each: the environment's bright places, the cosine, and a lobe about the
/// mirror direction; combined with the balance heuristic.
fn lit_by(
    brdf: &dyn Brdf,
    environment: &Environment,
    view: &SphereView,
    column: usize,
    row: usize,
    scratch: &mut Scratch,
) -> Pixel {
    let size = view.size.max(1);
    let cover = coverage(size, column, row);
    if cover <= 0.0 {
        return Pixel::Background;
    }
    let centre = disc_point(size, column as f64 + 0.5, row as f64 + 0.5);
    let inside = centre * (0.9995 / centre.length().max(0.9995));
    let Some(frame) = frame_at(inside) else { return Pixel::Background };
    let wo = frame.to_local(DVec3::Z);
    let lobe = HalfLobe { wo };
    let sobol = ScrambledSobol::new((row * size + column) as u64);
    scratch.pairs.clear();
    scratch.weights.clear();
    // Incident light, all of it and what arrives from directions without data.
    let (mut arriving, mut unknown) = (0.0, 0.0);
    // The pdf below is that of equal thirds.
    let samples = view.samples.max(1).next_multiple_of(3);
    for index in 0..samples {
        let [u, v] = sobol.planar_point(index);
        let wi = match index % 3 {
            0 => frame.to_local(environment.draw(u, v)),
            1 => cosine_hemisphere(u, v).0,
            _ => lobe.sample(u, v),
        };
        if wi.z <= 0.0 {
            continue;
        }
        let world = frame.to_world(wi);
        let radiance = environment.radiance(world);
        let pdf = (environment.pdf_of(radiance) + wi.z / PI + lobe.pdf(wi)) / 3.0;
        let pair = DirectionPair::new(wi, wo);
        if pdf > 0.0 {
            let weight = radiance * (wi.z / pdf);
            arriving += weight.luminance();
            if brdf.has_data(&pair) {
                scratch.pairs.push(&pair);
                scratch.weights.push(weight);
            } else {
                unknown += weight.luminance();
            }
        }
    }
    // Unknown directions count as dark. Where that could show, the pixel is unknown too.
    if unknown > MOST_UNKNOWN * arriving {
        return Pixel::NoData;
    }
    brdf.eval_batch(scratch.pairs.as_slices(), &mut scratch.values);
    let sum: Rgb =
        scratch.weights.iter().enumerate().map(|(i, &w)| scratch.values.get(i) * w).sum();
    Pixel::Radiance(sum / f64::from(samples), cover)
}

/// Share of a pixel that the sphere covers, from its distance to the rim.
fn coverage(size: usize, column: usize, row: usize) -> f64 {
    let radius = disc_point(size, column as f64 + 0.5, row as f64 + 0.5).length();
    let pixels_inside = (1.0 - radius) * 0.5 * size as f64 * RADIUS;
    (pixels_inside + 0.5).clamp(0.0, 1.0)
}
