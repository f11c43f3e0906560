//! `brdf relight turntable`.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use brdf_files::OutputFolder;
use brdf_image::{ToneMap, encode_png};
use brdf_relight::{CubeLightSampler, RelitScene, render};
use clap::ValueEnum;
use serde_json::json;

use super::loading::{LightArgs, Loaded, ShotArgs, mesh_of};
use crate::args::positive;
use crate::progress::Watch;

/// Show a precomputed object from all sides, or under light from all sides
///
/// Writes frame-001.png … of one exposure, and report.json.
///
/// Example: brdf relight turntable bunny.prt --env grace.hdr --frames 60 -o frames/
#[derive(clap::Args)]
pub(in crate::commands) struct Turntable {
    /// File that `brdf relight precompute` wrote
    object: PathBuf,

    #[command(flatten)]
    light: LightArgs,

    #[command(flatten)]
    shot: ShotArgs,

    /// Frames of a whole turn
    #[arg(long, default_value_t = 60, value_parser = clap::value_parser!(u32).range(1..=3600))]
    frames: u32,

    /// What turns
    #[arg(long, value_enum, default_value_t = TurnArg::View)]
    turn: TurnArg,

    /// Folder to write
    #[arg(short, long, value_name = "FOLDER", default_value = "frames")]
    output: PathBuf,

    /// Factor from linear values to what is shown as white [default: as the first frame needs]
    #[arg(long, value_parser = positive)]
    exposure: Option<f64>,

    /// Write into a folder that holds other files
    #[arg(long)]
    force: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum TurnArg {
    /// The camera, around the object
    View,
    /// The environment
    Light,
}

impl Turntable {
    pub(in crate::commands) fn run(self, _out: &mut impl Write) -> anyhow::Result<ExitCode> {
        let loaded = Loaded::open(&self.object)?;
        let file = loaded.parse()?;
        let (mesh, environment) = (mesh_of(&file)?, self.light.environment()?);
        let sampler = CubeLightSampler::default();
        let mut folder = OutputFolder::new(&self.output, self.force)?;
        let watch = Watch::start();
        let orbit = self.shot.orbit();
        let (mut relit, mut tone) =
            (RelitScene::default(), self.exposure.map(|exposure| ToneMap { exposure }));
        for frame in 0..self.frames {
            watch.step(format!("frame {} of {}", frame + 1, self.frames));
            let angle = 360.0 * f64::from(frame) / f64::from(self.frames);
            let [view, light] = match self.turn {
                TurnArg::View => [angle, 0.0],
                TurnArg::Light => [0.0, angle],
            };
            if frame == 0 || self.turn == TurnArg::Light {
                let light = sampler.light(&environment, self.light.rotation(light));
                relit.relight(&file.parts, &self.light.coefficients(&light));
            }
            let (film, _) =
                render(&file.parts, &relit, &orbit.render_params(&mesh, view.to_radians()));
            let tone = *tone.get_or_insert_with(|| ToneMap::exposed_for(&film));
            folder
                .write(&format!("frame-{:03}.png", frame + 1), &encode_png(&tone.apply(&film))?)?;
        }
        let report = json!({
            "brdf": env!("CARGO_PKG_VERSION"), "object": self.object, "frames": self.frames,
            "exposure": tone.map(|tone| tone.exposure),
        });
        folder.write("report.json", (serde_json::to_string_pretty(&report)? + "\n").as_bytes())?;
        folder.finish()?;
        drop(watch);
        writeln!(std::io::stderr(), "{}", self.output.display())?;
        Ok(ExitCode::SUCCESS)
    }
}
