//! What a picture shows and how light is gathered in it, whatever the shape.

use std::f64::consts::PI;

use brdf_image::{Film, Pixel};
use brdf_model::{Rgb, ScrambledSobol, cosine_hemisphere};
use brdf_param::Frame;
use glam::DVec3;
use rayon::prelude::*;

use crate::light::{Environment, Light};
use crate::spatially_varying::{SpatiallyVarying, TexturePoint};
use crate::sphere::SUPERSAMPLING;

/// Points within a pixel.
const POINTS: u32 = SUPERSAMPLING * SUPERSAMPLING;

/// What a place in the picture shows, in axes of the camera.
pub(crate) struct Hit<'a> {
    /// East, north and normal of the surface: x, y and z of the material.
    pub(crate) frame: Frame,
    /// Unit direction to the camera.
    pub(crate) to_camera: DVec3,
    /// Place of the tile.
    pub(crate) at: TexturePoint,
    /// What it is made of.
    pub(crate) material: &'a dyn SpatiallyVarying,
    /// Where it is, in axes of the scene, a little above the surface.
    pub(crate) position: DVec3,
}

/// What a picture shows, and its camera.
pub(crate) trait Stage: Sync {
    /// Pixels in a row, and rows.
    fn size(&self) -> (usize, usize);

    /// What stands at a place, pixels from the top left, for samples `step` pixels apart.
    fn hit(&self, column: f64, row: f64, step: f64) -> Option<Hit<'_>>;

    /// Whether light arrives from a direction in axes of the camera.
    fn is_lit(&self, hit: &Hit<'_>, direction: DVec3) -> bool;
}

pub(crate) fn render_stage(stage: &dyn Stage, light: &Light, samples: u32) -> Film {
    let (columns, rows) = stage.size();
    let pixels = (0..rows)
        .into_par_iter()
        .flat_map_iter(|row| {
            let mut gather = Gather { stage, light, samples, lit: Lit::default() };
            (0..columns).map(|column| gather.pixel(column, row)).collect::<Vec<_>>()
        })
        .collect();
    Film::new(columns, pixels)
}

/// What one row of pixels shares.
struct Gather<'a> {
    stage: &'a dyn Stage,
    light: &'a Light,
    samples: u32,
    lit: Lit,
}

/// Lights over one point of a surface.
#[derive(Default)]
struct Lit {
    /// Directions to them, local.
    directions: Vec<DVec3>,
    /// Incident radiance over pdf, or irradiance.
    weights: Vec<Rgb>,
    values: Vec<Rgb>,
}

impl Gather<'_> {
    fn pixel(&mut self, column: usize, row: usize) -> Pixel {
        let stage = self.stage;
        let sobol = ScrambledSobol::new((row * stage.size().0 + column) as u64);
        let (mut sum, mut hits) = (Rgb::BLACK, 0_u32);
        for point in 0..POINTS {
            let offset = |index: u32| (f64::from(index) + 0.5) / f64::from(SUPERSAMPLING);
            let x = column as f64 + offset(point % SUPERSAMPLING);
            let y = row as f64 + offset(point / SUPERSAMPLING);
            let Some(hit) = stage.hit(x, y, 1.0 / f64::from(SUPERSAMPLING)) else { continue };
            hits += 1;
            sum = sum + self.radiance(&hit, &sobol, point);
        }
        if hits == 0 {
            return Pixel::Background;
        }
        Pixel::Radiance(sum / f64::from(hits), f64::from(hits) / f64::from(POINTS))
    }

    /// Radiance towards the camera.
    fn radiance(&mut self, hit: &Hit<'_>, sobol: &ScrambledSobol, point: u32) -> Rgb {
        let wo = hit.frame.to_local(hit.to_camera);
        self.lit.clear();
        match self.light {
            Light::Directional(light) => {
                let wi = hit.frame.to_local(light.direction());
                if wi.z > 0.0 && self.stage.is_lit(hit, light.direction()) {
                    self.lit.push(wi, Rgb::splat(PI));
                }
            }
            Light::Environment(environment) => self.draw(environment, hit, wo, sobol, point),
        }
        self.lit.reflected(hit, wo)
    }

    /// Draws lights, one third each by the environment's brightness, the cosine, and the material's
    /// own choice, and weighs them by the balance heuristic. Each point of a pixel takes its own
    /// stretch of the sequence.
    fn draw(
        &mut self,
        environment: &Environment,
        hit: &Hit<'_>,
        wo: DVec3,
        sobol: &ScrambledSobol,
        point: u32,
    ) {
        // The pdf below is that of equal thirds.
        let count = self.samples.div_ceil(POINTS).max(1).next_multiple_of(3);
        for index in 0..count {
            let [u, v] = sobol.planar_point(point * count + index);
            let drawn = match index % 3 {
                0 => Some(hit.frame.to_local(environment.draw(u, v))),
                1 => Some(cosine_hemisphere(u, v).0),
                _ => hit.material.sample(&hit.at, wo, u, v).map(|(wi, _)| wi),
            };
            let Some(wi) = drawn.filter(|wi| wi.z > 0.0) else { continue };
            let world = hit.frame.to_world(wi);
            if !self.stage.is_lit(hit, world) {
                continue;
            }
            let radiance = environment.radiance(world);
            let own = hit.material.pdf(&hit.at, wo, wi);
            let pdf = (environment.pdf_of(radiance) + wi.z / PI + own) / 3.0;
            self.lit.push(wi, radiance / (pdf * f64::from(count)));
        }
    }
}

impl Lit {
    fn clear(&mut self) {
        self.directions.clear();
        self.weights.clear();
    }

    fn push(&mut self, wi: DVec3, weight: Rgb) {
        if wi.z > 0.0 {
            self.directions.push(wi);
            self.weights.push(weight);
        }
    }

    /// The sum of what the material makes of the lights.
    fn reflected(&mut self, hit: &Hit<'_>, wo: DVec3) -> Rgb {
        if self.directions.is_empty() {
            return Rgb::BLACK;
        }
        self.values.clear();
        self.values.resize(self.directions.len(), Rgb::BLACK);
        hit.material.reflect(&hit.at, wo, &self.directions, &mut self.values);
        self.values.iter().zip(&self.weights).map(|(&value, &weight)| value * weight).sum()
    }
}

/// The part after the point, in [0, 1).
pub(crate) fn wrapped(tiles: f64) -> f64 {
    let part = tiles - tiles.floor();
    // A tiny negative number leaves 1 after rounding.
    if part < 1.0 { part } else { 0.0 }
}
