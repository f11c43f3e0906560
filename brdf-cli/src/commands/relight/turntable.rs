//! `brdf relight turntable`.

use std::io::Write;
use std::path::PathBuf;

use brdf_image::encode_png;
use brdf_relight::{Turn, TurntableParams, TurntableReport, turntable};
use brdf_report::sorted_json;

use super::loading::{LightArgs, Loaded, ShotArgs, mesh_of};
use crate::args::positive;
use crate::outputs::FolderArgs;
use crate::progress::Watch;

/// Show a precomputed object from all sides, or under light from all sides
///
/// Writes frame-001.png … of one exposure, and report.json.
///
/// Example: brdf relight turntable bunny.prt --env grace.hdr --frames 60 -o frames/
#[derive(clap::Args)]
#[command(mut_arg("output", |arg| arg.default_value("frames")))]
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

    #[command(flatten)]
    folder: FolderArgs,

    /// Factor from linear values to what is shown as white [default: as the first frame needs]
    #[arg(long, value_parser = positive)]
    exposure: Option<f64>,
}

choices! {
    enum TurnArg for Turn {
        /// The camera, around the object
        View => View,
        /// The environment
        Light => Light,
    }
}

impl Turntable {
    pub(in crate::commands) fn run(self, _out: &mut impl Write) -> anyhow::Result<()> {
        let loaded = Loaded::open(&self.object)?;
        let file = loaded.parse()?;
        let (mesh, environment) = (mesh_of(&file)?, self.light.environment()?);
        let params = TurntableParams {
            environment: &environment,
            rotation: self.light.rotation(),
            rule: self.light.rule(),
            orbit: self.shot.orbit(),
            frames: self.frames,
            turn: self.turn.into(),
            exposure: self.exposure,
        };
        let mut folder = self.folder.create()?;
        let mut take = |frame: u32, picture| -> anyhow::Result<()> {
            let name = format!("frame-{:03}.png", frame + 1);
            Ok(folder.write(&name, &encode_png(&picture)?)?)
        };
        let watch = Watch::start();
        let exposure = watch.run(|job| turntable(&file.parts, &mesh, &params, job, &mut take))?;
        drop(watch);
        let report = TurntableReport {
            brdf: env!("CARGO_PKG_VERSION").to_owned(),
            object: self.object.to_string_lossy().into_owned(),
            frames: self.frames,
            exposure,
        };
        folder.write("report.json", sorted_json(&report)?.as_bytes())?;
        folder.finish()?;
        writeln!(std::io::stderr(), "{}", self.folder.output.display())?;
        Ok(())
    }
}
