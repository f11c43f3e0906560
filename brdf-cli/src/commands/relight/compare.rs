//! `brdf relight compare`.

use std::io::Write;
use std::path::PathBuf;

use anyhow::Context as _;
use brdf_container::MaterialFile;
use brdf_io::ReadOptions;
use brdf_relight::{CompareParams, Occluder, compare};
use brdf_report::breakdown_text;

use super::loading::{LightArgs, Loaded, mesh_of};
use crate::outputs::show;
use crate::progress::Watch;

/// Say what relighting loses, against brute force
///
/// Colours of vertices seen from six sides, against the exact BRDF under all light with sixteen rays a texel: relative
/// RMS of everything together, and of each step alone.
///
/// Example: brdf relight compare bunny.prt --env uffizi.hdr --brdf preset:plastic
#[derive(clap::Args)]
pub(in crate::commands) struct Compare {
    /// File that `brdf relight precompute` wrote
    object: PathBuf,

    #[command(flatten)]
    light: LightArgs,

    /// The material that it was made with
    #[arg(long, value_name = "MODEL", default_value = "preset:plastic")]
    brdf: String,

    /// Vertices to compare, evenly from all
    #[arg(long, default_value_t = 160, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    vertices: u32,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl Compare {
    pub(in crate::commands) fn run(self, out: &mut impl Write) -> anyhow::Result<()> {
        let loaded = Loaded::open(&self.object)?;
        let file = loaded.parse()?;
        let subject = MaterialFile::open(&self.brdf, &ReadOptions::default())?;
        if subject.short_name() != file.record.brdf {
            writeln!(
                std::io::stderr(),
                "{}: made with {}, compared with {}",
                self.object.display(),
                file.record.brdf,
                subject.short_name()
            )?;
        }
        let mesh = mesh_of(&file)?;
        let light = self.light.light()?;
        let params = CompareParams {
            vertices: self.vertices as usize,
            quality: file.record.precompute.quality,
            rule: self.light.rule(),
        };
        let part = file.parts.first().context("no parts")?;
        let watch = Watch::start();
        let occluder = Occluder::of(&mesh);
        let split =
            watch.run(|job| compare(part, &occluder, subject.brdf(), &light, &params, job))?;
        drop(watch);
        show(out, self.json, &split, || breakdown_text(&split))
    }
}
