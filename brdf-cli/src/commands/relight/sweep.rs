//! `brdf relight sweep`.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context as _;
use brdf_container::MaterialFile;
use brdf_files::OutputFolder;
use brdf_image::{Panel, ToneMap, encode_png, strip};
use brdf_io::ReadOptions;
use brdf_plot::{Curves, Scale, Series, plot_curves};
use brdf_relight::{Vary, sweep};
use brdf_report::significant;
use serde_json::json;

use super::loading::{LightArgs, Loaded, ShotArgs, mesh_of};
use crate::args::positive;
use crate::progress::Watch;

/// Show what fewer terms, or fewer coefficients, do to a picture
///
/// Writes a folder: strip.png, a picture for each number and one by brute force, errors.svg, and report.json. Terms and
/// coefficients are taken from the file, largest first. Brute force takes all light with adaptive rays at each vertex (a
/// minute; coarse meshes show it coarsely), and the exact BRDF where terms vary, the file's terms where coefficients do.
///
/// Example: brdf relight sweep bunny.prt --env grace.hdr --brdf preset:plastic --terms 1,4,16 -o terms
#[derive(clap::Args)]
pub(in crate::commands) struct Sweep {
    /// File that `brdf relight precompute` wrote
    object: PathBuf,

    /// Numbers of terms
    #[arg(
        long,
        value_name = "K,…",
        value_delimiter = ',',
        required_unless_present = "coefficients"
    )]
    terms: Vec<usize>,

    /// Numbers of wavelet coefficients of each vertex and term; of a file of --codec wavelet
    #[arg(long, value_name = "N,…", value_delimiter = ',', conflicts_with = "terms")]
    coefficients: Vec<usize>,

    /// The material that it was made with, where terms vary
    #[arg(long, value_name = "MODEL", default_value = "preset:plastic")]
    brdf: String,

    #[command(flatten)]
    light: LightArgs,

    #[command(flatten)]
    shot: ShotArgs,

    /// Factor from linear values to what is shown as white
    #[arg(long, value_parser = positive)]
    exposure: Option<f64>,

    /// Folder to write
    #[arg(short, long, value_name = "FOLDER", default_value = "sweep")]
    output: PathBuf,

    /// Write into a folder that holds other files
    #[arg(long)]
    force: bool,
}

impl Sweep {
    pub(in crate::commands) fn run(self, _out: &mut impl Write) -> anyhow::Result<ExitCode> {
        let loaded = Loaded::open(&self.object)?;
        let file = loaded.parse()?;
        let subject = MaterialFile::open(&self.brdf, &ReadOptions::default())?;
        let mesh = mesh_of(&file)?;
        let (light, shot) = (self.light.light()?, self.shot.orbit().render_params(&mesh, 0.0));
        let mut folder = OutputFolder::new(&self.output, self.force)?;
        let (what, values) = match self.terms.is_empty() {
            false => ("terms", &self.terms),
            true => ("coefficients", &self.coefficients),
        };
        let vary = match self.terms.is_empty() {
            false => Vary::Terms(subject.brdf()),
            true => Vary::Coefficients,
        };
        let watch = Watch::start();
        let light = (&light, self.light.rule());
        let swept = watch
            .run(|job| sweep(&file.parts, &mesh, vary, values, light, &shot, job))
            .with_context(|| self.object.display().to_string())?;
        drop(watch);
        let (films, wanted, errors) = (&swept.films, &swept.exact, &swept.relative_rms);
        let tone = self
            .exposure
            .map_or_else(|| ToneMap::exposed_for(wanted), |exposure| ToneMap { exposure });
        let caption =
            |value: &usize, error: &f64| format!("{what}: {value}, RMS {}", significant(*error));
        let mut panels: Vec<Panel> = values
            .iter()
            .zip(errors)
            .zip(films)
            .map(|((value, error), film)| Panel {
                picture: tone.apply(film),
                caption: caption(value, error),
            })
            .collect();
        panels.push(Panel { picture: tone.apply(wanted), caption: "brute force".to_owned() });
        folder.write("strip.png", &encode_png(&strip(&panels))?)?;
        let points = values.iter().map(|v| *v as f64).zip(errors.iter().copied()).collect();
        let curves = Curves {
            title: format!("{} of {}", subject.short_name(), file.record.mesh),
            x: what.to_owned(),
            y: "relative RMS of the picture".to_owned(),
            y_scale: Scale::Log,
            series: vec![Series::new(self.light.name(), points)],
        };
        folder.write("errors.svg", plot_curves(&[curves], 1)?.svg().as_bytes())?;
        let report = json!({
            "brdf": env!("CARGO_PKG_VERSION"), "object": self.object, "material": subject.short_name(),
            "env": self.light.name(), "exposure": tone.exposure, what: values, "relative_rms": errors,
        });
        folder.write("report.json", (serde_json::to_string_pretty(&report)? + "\n").as_bytes())?;
        folder.finish()?;
        for (value, error) in values.iter().zip(errors) {
            writeln!(std::io::stderr(), "{}", caption(value, error))?;
        }
        writeln!(std::io::stderr(), "{}", self.output.display())?;
        Ok(ExitCode::SUCCESS)
    }
}
