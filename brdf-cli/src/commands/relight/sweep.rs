//! `brdf relight sweep`.

use std::io::Write;
use std::path::PathBuf;

use brdf_container::MaterialFile;
use brdf_image::ToneMap;
use brdf_io::ReadOptions;
use brdf_relight::{RelightError, SweepParams, SweepReport, SweptNumbers, Vary, sweep};
use brdf_report::{sweep_captions, sweep_files};

use super::loading::{LightArgs, Loaded, ShotArgs, mesh_of};
use crate::args::{positive, usage};
use crate::outputs::{FolderArgs, write_all};
use crate::progress::Watch;

/// Show what fewer terms, or fewer coefficients, do to a picture
///
/// Writes a folder: strip.png, a picture for each number and one by brute force, errors.svg, and report.json. Terms and
/// coefficients are taken from the file, largest first. Brute force takes all light with adaptive rays at each vertex (a
/// minute; coarse meshes show it coarsely), and the exact BRDF where terms vary, the file's terms where coefficients do.
///
/// Example: brdf relight sweep bunny.prt --env grace.hdr --brdf preset:plastic --terms 1,4,16 -o terms
#[derive(clap::Args)]
#[command(mut_arg("output", |arg| arg.default_value("sweep")))]
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

    #[command(flatten)]
    folder: FolderArgs,
}

impl Sweep {
    pub(in crate::commands) fn run(self, _out: &mut impl Write) -> anyhow::Result<()> {
        let loaded = Loaded::open(&self.object)?;
        let file = loaded.parse()?;
        let subject = MaterialFile::open(&self.brdf, &ReadOptions::default())?;
        let mesh = mesh_of(&file)?;
        let (light, picture) = (self.light.light()?, self.shot.orbit().render_params(&mesh, 0.0));
        let mut folder = self.folder.create()?;
        let (vary, numbers) = match self.terms.is_empty() {
            false => (Vary::Terms(subject.brdf()), SweptNumbers::Terms(self.terms)),
            true => (Vary::Coefficients, SweptNumbers::Coefficients(self.coefficients)),
        };
        let watch = Watch::start();
        let object = self.object.to_string_lossy();
        let (rule, values) = (self.light.rule(), numbers.values());
        let params = SweepParams { mesh: &mesh, vary, values, light: &light, rule, picture };
        let swept = watch.run(|job| sweep(&file.parts, &params, job));
        let swept = swept.map_err(|error| match error {
            RelightError::Terms { asked, most } => {
                usage(format!("{asked} terms; {object} has 1 to {most}"))
            }
            RelightError::NotWavelets => usage(format!(
                "{object}: has components of clusters; expected one of `precompute --codec wavelet`"
            )),
            other => other.into(),
        })?;
        let usual = || ToneMap::exposed_for(&swept.exact).exposure;
        let report = SweepReport {
            brdf: env!("CARGO_PKG_VERSION").to_owned(),
            object: object.into_owned(),
            material: subject.short_name(),
            env: self.light.name(),
            exposure: self.exposure.unwrap_or_else(usual),
            numbers,
            relative_rms: swept.relative_rms.clone(),
        };
        write_all(&mut folder, &sweep_files(&report, &swept, &file.record.mesh)?)?;
        folder.finish()?;
        drop(watch);
        let mut err = std::io::stderr();
        sweep_captions(&report).iter().try_for_each(|caption| writeln!(err, "{caption}"))?;
        writeln!(err, "{}", self.folder.output.display())?;
        Ok(())
    }
}
