//! `brdf study`.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::bail;
use brdf_io::OutputFolder;
use brdf_plot::plot_parametrizations;
use brdf_study::{StudyParams, study_material};

use crate::args::ReadArgs;
use crate::progress::Progress;
use crate::report::study::{Studied, StudyReport};
use crate::subject::Subject;

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
pub(super) struct Study {
    /// Materials, or archives of them
    #[arg(required = true, value_name = "INPUT")]
    inputs: Vec<String>,

    /// Folder to write; one that brdf wrote is replaced
    #[arg(short, long, value_name = "FOLDER", default_value = "study")]
    output: PathBuf,

    /// Write into a folder that holds other files
    #[arg(long)]
    force: bool,

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
    pub(super) fn run(self, out: &mut impl Write) -> anyhow::Result<ExitCode> {
        let options = self.read.options();
        let mut subjects = Vec::new();
        for input in &self.inputs {
            subjects.extend(Subject::open_all(input, &options)?);
        }
        let mut folder = OutputFolder::new(&self.output, self.force)?;
        let params = StudyParams { seed: self.seed, ..StudyParams::default() };
        let progress = Progress::new(subjects.len() as u64);
        let mut materials = Vec::new();
        let mut skipped = Vec::new();
        for subject in &subjects {
            progress.step(subject.short_name());
            match study_material(subject.brdf(), &params) {
                Ok(rows) => materials.push(Studied::new(subject, rows)),
                Err(error) => skipped.push(format!("{}: {error}", subject.argument)),
            }
            progress.done(1);
        }
        if materials.is_empty() {
            bail!("no material could be studied: {}", skipped.join("; "));
        }
        let mut slices = Vec::new();
        if subjects.len() <= PICTURED {
            for (index, subject) in subjects.iter().enumerate() {
                progress.step(format!("slices of {}", subject.short_name()));
                let plot = plot_parametrizations(&subject.short_name(), subject.brdf())?;
                folder.write(&format!("slices-{index}.svg"), plot.svg().as_bytes())?;
                slices.push(plot);
            }
        }
        drop(progress);
        let report = StudyReport::new(materials, skipped, params);
        let json = serde_json::to_string_pretty(&report)?;
        folder.write("study.csv", report.csv().as_bytes())?;
        folder.write("report.html", report.page(&slices).as_bytes())?;
        folder.write("report.json", json.as_bytes())?;
        let place = folder.finish()?;
        if self.json {
            writeln!(out, "{json}")?;
        } else {
            report.print(out)?;
            writeln!(out, "{}", place.join("report.html").display())?;
        }
        Ok(ExitCode::SUCCESS)
    }
}
