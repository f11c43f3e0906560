//! How fast relighting is.

use std::f64::consts::TAU;
use std::time::Instant;

use brdf_job::Job;
use brdf_mesh::Mesh;
use brdf_render::Environment;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::error::RelightError;
use crate::light::{CubeLightSampler, LightRule};
use crate::object::of_ground;
use crate::orbit::Orbit;
use crate::precompute::{Precomputation, PrecomputeParams};
use crate::raster::render;
use crate::ray_packet::Occluder;
use crate::scene::{Part, RelitScene};

/// Options of [`measure_speed`].
#[derive(Clone, Copy, Debug)]
pub struct SpeedParams<'a> {
    /// Light of the frames.
    pub environment: &'a Environment,
    /// Turn of the environment about the vertical in the first frame, radians.
    pub rotation: f64,
    /// Rule by which its coefficients are used.
    pub rule: LightRule,
    /// The first picture; one point a pixel is drawn.
    pub orbit: Orbit,
    /// Number of frames of each kind.
    pub frames: u32,
    /// Options that the transport was made with.
    pub precompute: PrecomputeParams,
}

/// Times of relighting an object on this machine.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Speed {
    /// Seconds of a precomputation: of a dozen chunks of each part, which stand for all.
    pub precompute_s: f64,
    /// Products of light and transport in a second, without the picture.
    pub light_kernel_fps: f64,
    /// Frames in a second with a new light each: its coefficients, the product and the picture.
    pub light_frame_fps: f64,
    /// Frames in a second with a new view each.
    pub view_frame_fps: f64,
    /// Coefficients of the light that are used.
    pub lit_coefficients: usize,
}

/// What `brdf relight bench` prints: speed beside size.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SpeedReport {
    /// Speed of precomputation and frames.
    #[serde(flatten)]
    pub speed: Speed,
    /// Bytes of transport.
    pub bytes: usize,
    /// Bytes of the file.
    pub file_bytes: usize,
}

/// Chunks of each part that precomputation is timed on.
const TIMED: usize = 12;

/// Measures the times of new light, of new views and of the precomputation of an object.
///
/// # Errors
///
/// As [`Precomputation::make`]; [`RelightError::Stopped`].
pub fn measure_speed(
    parts: &[Part<'_>],
    mesh: &Mesh,
    params: &SpeedParams<'_>,
    job: &Job<'_>,
) -> Result<Speed, RelightError> {
    let [kernel_job, light_job, view_job, precompute_job] = job.split([0.2, 1.0, 1.0, 1.0]);
    let orbit = Orbit { points: 1, ..params.orbit };
    let mut relit = RelitScene::default();
    let turn = |frame: u32| TAU * f64::from(frame) / f64::from(params.frames);
    let sampler = CubeLightSampler::default();
    let light_at = |turn: f64| sampler.light(params.environment, params.rotation + turn);
    let lit = light_at(0.0).coefficients(params.rule);
    relit.relight(parts, &lit);
    let timed = |job: &Job<'_>, what: &str, frame: &mut dyn FnMut(u32)| {
        job.begin(what, params.frames.into());
        let start = Instant::now();
        for number in 0..params.frames {
            job.check()?;
            frame(number);
            job.advance(1);
        }
        Ok::<_, RelightError>(f64::from(params.frames) / start.elapsed().as_secs_f64())
    };
    let light_kernel_fps = timed(&kernel_job, "products", &mut |_| relit.relight(parts, &lit))?;
    let light_frame_fps = timed(&light_job, "new light", &mut |frame| {
        relit.relight(parts, &light_at(turn(frame)).coefficients(params.rule));
        render(parts, &relit, &orbit.render_params(mesh, 0.0));
    })?;
    let view_frame_fps = timed(&view_job, "new views", &mut |frame| {
        render(parts, &relit, &orbit.render_params(mesh, turn(frame)));
    })?;
    let precompute_s = precompute_seconds(parts, mesh, params.precompute, &precompute_job)?;
    let lit_coefficients = lit.places().len();
    Ok(Speed { precompute_s, light_kernel_fps, light_frame_fps, view_frame_fps, lit_coefficients })
}

fn precompute_seconds(
    parts: &[Part<'_>],
    mesh: &Mesh,
    params: PrecomputeParams,
    job: &Job<'_>,
) -> Result<f64, RelightError> {
    job.begin("precomputation", parts.len() as u64);
    let occluder = Occluder::of(mesh);
    let mut seconds = 0.0;
    for (index, part) in parts.iter().enumerate() {
        let params = if index == 0 { params } else { of_ground(params) };
        let (surface, maps) = (part.surface.clone(), part.maps.clone());
        let vertices = surface.positions.len();
        let work = Precomputation::new(mesh, surface, maps, params);
        let chunks = work.chunks().len();
        let timed: Vec<usize> = (0..chunks).step_by(chunks.div_ceil(TIMED)).collect();
        let start = Instant::now();
        let made = timed.par_iter().map(|chunk| {
            job.check()?;
            work.make(&occluder, *chunk)?;
            Ok(work.chunks()[*chunk].len())
        });
        let done = made.sum::<Result<usize, RelightError>>()?;
        let share = vertices as f64 / done as f64;
        seconds += start.elapsed().as_secs_f64() * share;
        job.advance(1);
    }
    Ok(seconds)
}
