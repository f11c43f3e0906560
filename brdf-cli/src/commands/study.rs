//! `brdf study`.

use std::io::Write;

use anyhow::bail;
use brdf_container::MaterialFile;
use brdf_job::Stopped;
use brdf_plot::plot_parametrizations;
use brdf_report::{study_files, study_text};
use brdf_separable::SeparableError;
use brdf_study::{StudiedMaterial, StudyParams, StudyReport, study_material};

use crate::args::ReadArgs;
use crate::outputs::{FolderArgs, command_line, show, write_all};
use crate::progress::Watch;

/// Measure which parametrization fits which material
///
/// For every material and every parametrization (standard, half/difference, Kautz–McCool,
/// orthographic, hybrid): how isolines of the isotropic part run against the axes, the energy that
/// sums of 1, 2, 4 and 8 products capture, the best reduction to two coordinates, and the error of
/// tables of equal size. Errors are root mean squares of ln(1 + f cosθi), f the luminance, over the
/// same pairs within 80°; isolines are those of whole slices. Writes
/// report.html with a verdict, report.json, study.csv, and for up to eight materials slices with
/// isolines. An .npz archive of neural BRDFs stands for all of its materials.
///
/// Example: brdf study merl_dev.npz *.bsdf -o study
#[derive(clap::Args)]
#[command(mut_arg("output", |arg| arg.default_value("study")))]
pub(super) struct Study {
    /// Materials, or archives of them
    #[arg(required = true, value_name = "INPUT")]
    inputs: Vec<String>,

    #[command(flatten)]
    folder: FolderArgs,

    /// Which scramble of the pairs
    #[arg(long, default_value_t = 1)]
    seed: u64,

    /// Print report.json on standard output
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    read: ReadArgs,
}

/// Materials of which slices are drawn.
const PICTURED: usize = 8;

impl Study {
    pub(super) fn run(self, out: &mut impl Write) -> anyhow::Result<()> {
        let options = self.read.options();
        let mut files = Vec::new();
        for input in &self.inputs {
            files.extend(MaterialFile::open_all(input, &options)?);
        }
        let mut folder = self.folder.create()?;
        let params = StudyParams { seed: self.seed, ..StudyParams::default() };
        let watch = Watch::start();
        let mut materials = Vec::new();
        let mut skipped = Vec::new();
        watch.run(|job| {
            for (file, job) in files.iter().zip(job.split_into(&vec![1.0; files.len()])) {
                let rows = match study_material(file.brdf(), &params, &job) {
                    Ok(rows) => rows,
                    Err(SeparableError::Stopped(stopped)) => return Err(stopped),
                    Err(error) => {
                        skipped.push(format!("{}: {error}", file.source));
                        continue;
                    }
                };
                let interpolated = file.samples().is_some();
                let name = file.short_name();
                let brdf = file.brdf();
                materials.push(StudiedMaterial::new(name, file.kind(), brdf, interpolated, rows));
            }
            Ok::<(), Stopped>(())
        })?;
        if materials.is_empty() {
            bail!("no material could be studied: {}", skipped.join("; "));
        }
        let mut slices = Vec::new();
        for file in files.iter().filter(|_| files.len() <= PICTURED) {
            watch.step(format!("slices of {}", file.short_name()));
            slices.push(plot_parametrizations(&file.short_name(), file.brdf())?);
        }
        drop(watch);
        let report = StudyReport::new(env!("CARGO_PKG_VERSION"), materials, skipped, params);
        write_all(&mut folder, &study_files(&report, &slices, &command_line())?)?;
        let place = folder.finish()?;
        show(out, self.json, &report, || {
            format!("{}{}\n", study_text(&report), place.join("report.html").display())
        })
    }
}
