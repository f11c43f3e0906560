//! `brdf relight bench`.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use brdf_relight::{CubeLightSampler, Occluder, Precomputation, RelightError, RelitScene, render};
use rayon::prelude::*;
use serde_json::json;

use super::loading::{LightArgs, Loaded, ShotArgs, mesh_of};
use super::precompute::of_ground;
use crate::numbers::bytes as shown_bytes;

/// Time new light and new views of a precomputed object
///
/// Frames have one point a pixel. Precomputation is timed on a dozen chunks of each part, which stand for all.
///
/// Example: brdf relight bench bunny.prt --env grace.hdr
#[derive(clap::Args)]
pub(in crate::commands) struct Bench {
    /// File that `brdf relight precompute` wrote
    object: PathBuf,

    #[command(flatten)]
    light: LightArgs,

    #[command(flatten)]
    shot: ShotArgs,

    /// Frames of each kind
    #[arg(long, default_value_t = 60, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    frames: u32,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Chunks of each part that precomputation is timed on.
const TIMED: usize = 12;

impl Bench {
    pub(in crate::commands) fn run(self, out: &mut impl Write) -> anyhow::Result<ExitCode> {
        let loaded = Loaded::open(&self.object)?;
        let file = loaded.parse()?;
        let (mesh, environment) = (mesh_of(&file)?, self.light.environment()?);
        let shot = self.shot.with_points(1);
        let mut relit = RelitScene::default();
        let degrees = |frame: u32| 360.0 * f64::from(frame) / f64::from(self.frames);
        let sampler = CubeLightSampler::default();
        let light_at = |degrees: f64| sampler.light(&environment, self.light.rotation(degrees));
        let lit = self.light.coefficients(&light_at(0.0));
        relit.relight(&file.parts, &lit);
        let timed = |f: &mut dyn FnMut(u32)| {
            let start = Instant::now();
            (0..self.frames).for_each(f);
            f64::from(self.frames) / start.elapsed().as_secs_f64()
        };
        let kernel = timed(&mut |_| relit.relight(&file.parts, &lit));
        let light = timed(&mut |frame| {
            let lit = self.light.coefficients(&light_at(degrees(frame)));
            relit.relight(&file.parts, &lit);
            render(&file.parts, &relit, &shot.shot(&mesh, 0.0));
        });
        let view = timed(&mut |frame| {
            render(&file.parts, &relit, &shot.shot(&mesh, degrees(frame)));
        });
        let occluder = Occluder::of(&mesh);
        let mut seconds = 0.0;
        for (index, part) in file.parts.iter().enumerate() {
            let params = file.record.precompute;
            let params = if index == 0 { params } else { of_ground(params) };
            let (surface, maps) = (part.surface.clone(), part.maps.clone());
            let vertices = surface.positions.len();
            let work = Precomputation::new(&mesh, surface, maps, params);
            let chunks = work.chunks().len();
            let every = chunks.div_ceil(TIMED);
            let timed: Vec<usize> = (0..chunks).step_by(every).collect();
            let start = Instant::now();
            let made = timed.par_iter().map(|chunk| {
                work.make(&occluder, *chunk)?;
                Ok(work.chunks()[*chunk].len())
            });
            let done = made.sum::<Result<usize, RelightError>>()?;
            let share = vertices as f64 / done as f64;
            seconds += start.elapsed().as_secs_f64() * share;
        }
        let transport: usize = file.parts.iter().map(|part| part.transport.bytes()).sum();
        if self.json {
            let report = json!({
                "precompute_s": seconds, "light_kernel_fps": kernel, "light_frame_fps": light,
                "view_frame_fps": view, "bytes": transport, "file_bytes": loaded.len(),
                "lit_coefficients": lit.places().len(),
            });
            writeln!(out, "{}", serde_json::to_string_pretty(&report)?)?;
        } else {
            writeln!(out, "precomputation {seconds:.1} s, {}", shown_bytes(transport))?;
            writeln!(
                out,
                "new light {kernel:.0} fps alone, {light:.0} with the picture ({} coefficients)",
                lit.places().len()
            )?;
            writeln!(out, "new view {view:.0} fps")?;
        }
        Ok(ExitCode::SUCCESS)
    }
}
