//! `brdf convert`.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::bail;
use brdf_io::{
    Measured, merl_to_bytes, model_to_bytes, samples_to_bytes, samples_to_csv, separable_to_bytes,
    table_to_bytes, write_atomically,
};
use brdf_model::{Channels, MerlTable, PairSampling, SampleSet};

use crate::args::{ForceArgs, ReadArgs};
use crate::subject::Subject;

/// Write a material in another format: .binary (MERL), .csv or .safetensors
///
/// MERL's grid is isotropic and reciprocal: other materials are evaluated at its cell centres with
/// the half vector in the plane of the tangent, and made reciprocal. A .csv holds the rows of
/// scattered measurements, and drawn pairs of everything else. A .safetensors file holds a fitted
/// model, scattered rows, or a table on MERL's grid.
///
/// Example: brdf convert aurora_white_rgb.bsdf aurora_white.binary
#[derive(clap::Args)]
pub(super) struct Convert {
    /// Material to read
    input: String,

    /// File to write; its extension chooses the format
    output: PathBuf,

    /// Pairs to draw where rows have to be made up for a .csv
    #[arg(short = 'n', long = "samples", default_value_t = 45_000, value_parser = clap::value_parser!(u32).range(1..))]
    samples: u32,

    #[command(flatten)]
    force: ForceArgs,

    #[command(flatten)]
    read: ReadArgs,
}

/// Gives a file's bytes and a sentence about them.
type Encoder = fn(&Convert, &Subject) -> anyhow::Result<(Vec<u8>, String)>;

impl Convert {
    pub(super) fn run(self, _out: &mut impl Write) -> anyhow::Result<ExitCode> {
        let extension = self.output.extension().map(|e| e.to_string_lossy().to_lowercase());
        let encode: Encoder = match extension.as_deref() {
            Some("binary") => Self::merl,
            Some("csv") => Self::csv,
            Some("safetensors") => Self::container,
            _ => bail!(
                "{}: unknown extension; expected .binary, .csv or .safetensors",
                self.output.display()
            ),
        };
        let subject = Subject::open(&self.input, &self.read.options())?;
        let (bytes, said) = encode(&self, &subject)?;
        write_atomically(&self.output, &bytes, self.force.overwrite())?;
        for note in subject.notes() {
            writeln!(std::io::stderr(), "{note}")?;
        }
        writeln!(std::io::stderr(), "{said}")?;
        Ok(ExitCode::SUCCESS)
    }

    fn merl(&self, subject: &Subject) -> anyhow::Result<(Vec<u8>, String)> {
        let (table, how) = merl_grid(subject)?;
        let said =
            format!("{how}; {} of {} cells invalid", table.invalid_cells(), MerlTable::CELLS);
        Ok((merl_to_bytes(&table), said))
    }

    fn csv(&self, subject: &Subject) -> anyhow::Result<(Vec<u8>, String)> {
        let (samples, how) = match subject.samples() {
            Some(rows) => (rows.clone(), "measured rows"),
            None => {
                let theta_max = 80_f64.to_radians();
                let sampling = PairSampling { count: self.samples, seed: 1, theta_max };
                let channels: Channels = subject.channels();
                (SampleSet::draw(subject.brdf(), &sampling, channels), "pairs drawn within 80°")
            }
        };
        let said = format!(
            "{} {how}; dropped: {}; {} with a negative channel set to 0",
            samples.len(),
            samples.dropped(),
            samples.clamped()
        );
        Ok((samples_to_csv(&samples).into_bytes(), said))
    }

    fn container(&self, subject: &Subject) -> anyhow::Result<(Vec<u8>, String)> {
        if let Some(rows) = subject.samples() {
            let said = format!("{} measured rows; dropped: {}", rows.len(), rows.dropped());
            return Ok((samples_to_bytes(rows)?, said));
        }
        let unchanged = || "the model, unchanged".to_owned();
        match subject.measurement().map(|m| &m.measured) {
            Some(Measured::Model(file)) => return Ok((model_to_bytes(file)?, unchanged())),
            Some(Measured::Separable(file)) => return Ok((separable_to_bytes(file)?, unchanged())),
            _ => {}
        }
        let (table, how) = merl_grid(subject)?;
        Ok((table_to_bytes(&table)?, how))
    }
}

/// The material on MERL's grid: as stored, or evaluated at its cell centres.
fn merl_grid(subject: &Subject) -> anyhow::Result<(MerlTable, String)> {
    if subject.samples().is_some() {
        bail!(
            "{}: scattered samples do not fill MERL's grid; factor them first and convert the model",
            subject.argument
        );
    }
    if let Some(Measured::Merl(table)) = subject.measurement().map(|m| &m.measured) {
        return Ok((table.clone(), "the table, cell by cell".to_owned()));
    }
    let mut how =
        "evaluated at the cell centres of MERL's grid, with negative values set to 0, and made \
                   reciprocal"
            .to_owned();
    if let Some(Measured::Model(file)) = subject.measurement().map(|m| &m.measured) {
        let limit = file.model.theta_max().to_degrees();
        how.push_str(&format!("; beyond {limit:.2}° the model holds its value there"));
    }
    Ok((MerlTable::tabulate(subject.brdf()), how))
}
