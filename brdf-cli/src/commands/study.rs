//! `brdf study`.

use std::io::Write;

use anyhow::bail;
use brdf_container::MaterialFile;
use brdf_plot::plot_parametrizations;
use brdf_report::{study_files, study_text};
use brdf_study::{StudyInput, StudyParams, StudyReport};

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
        let names: Vec<String> = files.iter().map(MaterialFile::short_name).collect();
        let inputs = files.iter().zip(&names).map(|(file, name)| StudyInput {
            brdf: file.brdf(),
            name,
            source: &file.source,
            kind: file.kind(),
            interpolated: file.samples().is_some(),
        });
        let inputs: Vec<StudyInput<'_>> = inputs.collect();
        let version = env!("CARGO_PKG_VERSION");
        let report = watch.run(|job| StudyReport::of(version, &inputs, params, job))?;
        if report.materials.is_empty() {
            bail!("no material could be studied: {}", report.skipped.join("; "));
        }
        let mut slices = Vec::new();
        for file in files.iter().filter(|_| files.len() <= PICTURED) {
            watch.step(format!("slices of {}", file.short_name()));
            slices.push(plot_parametrizations(&file.short_name(), file.brdf())?);
        }
        drop(watch);
        write_all(&mut folder, &study_files(&report, &slices, &command_line())?)?;
        let place = folder.finish()?;
        show(out, self.json, &report, || {
            format!("{}{}\n", study_text(&report), place.join("report.html").display())
        })
    }
}
