//! `brdf render`.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::bail;
use brdf_io::write_atomically;
use brdf_model::Brdf;
use brdf_render::SphereView;

use crate::args::{ForceArgs, LightArgs, ReadArgs, positive};
use crate::pictures::{light, line_up, png};
use crate::progress::Progress;
use crate::subject::Subject;

/// Render materials on spheres, side by side
///
/// All pictures share camera, light and exposure: that which shows 99 % of the first sphere
/// unclipped, unless --exposure says otherwise. From the second material on, its difference from
/// the first follows, brightened four times. Under an environment, scattered measurements take
/// minutes. A directional light has irradiance π, so that a white
/// diffuser facing it shows as 1. Pixels where a material has no data are chequered violet.
///
/// Example: brdf render preset:ggx brdf-out/model.safetensors --env grace.hdr -o spheres.png
#[derive(clap::Args)]
pub(super) struct Render {
    /// Materials, the reference first
    #[arg(required = true)]
    models: Vec<String>,

    /// Picture to write, PNG
    #[arg(short, long, value_name = "FILE", default_value = "spheres.png")]
    output: PathBuf,

    #[command(flatten)]
    light: LightArgs,

    /// Side of each sphere's picture in pixels
    #[arg(long, default_value_t = 256, value_parser = clap::value_parser!(u32).range(16..=4096))]
    size: u32,

    /// Light samples per pixel under an environment
    #[arg(long, default_value_t = 512, value_parser = clap::value_parser!(u32).range(1..=65_536))]
    samples: u32,

    /// Factor from linear values to what is shown as white
    #[arg(long, value_parser = positive, allow_hyphen_values = true)]
    exposure: Option<f64>,

    #[command(flatten)]
    force: ForceArgs,

    #[command(flatten)]
    read: ReadArgs,
}

impl Render {
    pub(super) fn run(self, _out: &mut impl Write) -> anyhow::Result<ExitCode> {
        let is_png = self.output.extension().is_some_and(|e| e.eq_ignore_ascii_case("png"));
        if !is_png {
            bail!("{}: unknown extension; expected .png", self.output.display());
        }
        let options = self.read.options();
        let subjects: Vec<Subject> = self
            .models
            .iter()
            .map(|model| Subject::open(model, &options))
            .collect::<anyhow::Result<_>>()?;
        let materials: Vec<(String, &dyn Brdf)> =
            subjects.iter().map(|s| (s.short_name(), s.brdf())).collect();
        let light = light(&self.light)?;
        let view = SphereView { size: self.size as usize, samples: self.samples };
        let progress = Progress::new(1);
        progress.step("rendering");
        let picture = line_up(&materials, &light, &view, self.exposure);
        drop(progress);
        write_atomically(&self.output, &png(&picture)?, self.force.overwrite())?;
        writeln!(std::io::stderr(), "{}", self.output.display())?;
        Ok(ExitCode::SUCCESS)
    }
}
