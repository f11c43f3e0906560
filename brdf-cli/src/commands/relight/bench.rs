//! `brdf relight bench`.

use std::io::Write;
use std::path::PathBuf;

use brdf_relight::{SpeedParams, SpeedReport, measure_speed};
use brdf_report::speed_text;

use super::loading::{LightArgs, Loaded, ShotArgs, mesh_of};
use crate::outputs::show;
use crate::progress::Watch;

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

impl Bench {
    pub(in crate::commands) fn run(self, out: &mut impl Write) -> anyhow::Result<()> {
        let loaded = Loaded::open(&self.object)?;
        let file = loaded.parse()?;
        let (mesh, environment) = (mesh_of(&file)?, self.light.environment()?);
        let params = SpeedParams {
            environment: &environment,
            rotation: self.light.rotation(),
            rule: self.light.rule(),
            orbit: self.shot.orbit(),
            frames: self.frames,
            precompute: file.record.precompute,
        };
        let watch = Watch::start();
        let speed = watch.run(|job| measure_speed(&file.parts, &mesh, &params, job))?;
        drop(watch);
        let bytes = file.parts.iter().map(|part| part.transport.bytes()).sum();
        let report = SpeedReport { speed, bytes, file_bytes: loaded.len() };
        show(out, self.json, &report, || speed_text(&report))
    }
}
