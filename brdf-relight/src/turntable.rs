//! Pictures from all sides, or under light from all sides.

use std::f64::consts::TAU;

use brdf_image::{DisplayImage, ToneMap};
use brdf_job::Job;
use brdf_mesh::Mesh;
use brdf_render::Environment;
use serde::Serialize;

use crate::error::RelightError;
use crate::light::{CubeLightSampler, LightRule};
use crate::orbit::Orbit;
use crate::raster::render;
use crate::scene::{Part, RelitScene};

/// What turns from frame to frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    /// The camera, around the object.
    View,
    /// The environment, about the vertical.
    Light,
}

/// Options of [`turntable`].
#[derive(Clone, Copy, Debug)]
pub struct TurntableParams<'a> {
    /// Light of the first frame.
    pub environment: &'a Environment,
    /// Turn of the environment about the vertical in the first frame, radians.
    pub rotation: f64,
    /// Rule by which its coefficients are used.
    pub rule: LightRule,
    /// The first picture.
    pub orbit: Orbit,
    /// Frames of a whole turn.
    pub frames: u32,
    /// What turns.
    pub turn: Turn,
    /// Factor from linear values to what is shown as white; `None` for what the first frame needs.
    pub exposure: Option<f64>,
}

/// `report.json` of a turntable. The first key marks the folder as ours.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TurntableReport {
    /// Version of the program.
    pub brdf: String,
    /// The object's file, as it was given.
    pub object: String,
    /// Frames of a whole turn.
    pub frames: u32,
    /// Factor from linear values to what the frames show as white.
    pub exposure: f64,
}

/// Renders the frames of a turn, passes each with its number to `take`, and returns the exposure of all of them.
///
/// # Errors
///
/// [`RelightError::Stopped`]; what `take` says.
pub fn turntable<E: From<RelightError>>(
    parts: &[Part<'_>],
    mesh: &Mesh,
    params: &TurntableParams<'_>,
    job: &Job<'_>,
    take: &mut dyn FnMut(u32, DisplayImage) -> Result<(), E>,
) -> Result<f64, E> {
    job.begin("frames", params.frames.into());
    let sampler = CubeLightSampler::default();
    let (mut relit, mut exposure) = (RelitScene::default(), params.exposure);
    for frame in 0..params.frames {
        job.check().map_err(RelightError::from)?;
        let angle = TAU * f64::from(frame) / f64::from(params.frames);
        let [view, light] = match params.turn {
            Turn::View => [angle, 0.0],
            Turn::Light => [0.0, angle],
        };
        if frame == 0 || params.turn == Turn::Light {
            let light = sampler.light(params.environment, params.rotation + light);
            relit.relight(parts, &light.coefficients(params.rule));
        }
        let (film, _) = render(parts, &relit, &params.orbit.render_params(mesh, view));
        let exposure = *exposure.get_or_insert_with(|| ToneMap::exposed_for(&film).exposure);
        take(frame, ToneMap { exposure }.apply(&film))?;
        job.advance(1);
    }
    Ok(exposure.unwrap_or(1.0))
}
