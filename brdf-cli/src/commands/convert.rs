//! `brdf convert`.

use std::io::Write;
use std::path::PathBuf;

use anyhow::{Context as _, bail};
use brdf_container::{Converted, MaterialFile, Tabulated};
use brdf_files::write_atomically;
use brdf_io::{write_merl, write_samples};
use brdf_model::{MerlTable, PairSampling};

use crate::advice::read_notes;
use crate::args::ReadArgs;
use crate::outputs::ForceArgs;
use crate::progress::Watch;

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
type Encoder = fn(&Convert, &MaterialFile) -> anyhow::Result<(Vec<u8>, String)>;

impl Convert {
    pub(super) fn run(self, _out: &mut impl Write) -> anyhow::Result<()> {
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
        let material = self.read.open(&self.input)?;
        let watch = Watch::start();
        watch.step("converting");
        let (bytes, said) = encode(&self, &material)?;
        write_atomically(&self.output, &bytes, self.force.overwrite())?;
        drop(watch);
        for note in read_notes(&material.notes) {
            writeln!(std::io::stderr(), "{note}")?;
        }
        writeln!(std::io::stderr(), "{said}")?;
        Ok(())
    }

    fn merl(&self, material: &MaterialFile) -> anyhow::Result<(Vec<u8>, String)> {
        let (table, how) = material.merl_table().with_context(|| scattered(material))?;
        let said = format!(
            "{}; {} of {} cells invalid",
            in_words(how),
            table.invalid_cells(),
            MerlTable::CELLS
        );
        Ok((write_merl(&table), said))
    }

    fn csv(&self, file: &MaterialFile) -> anyhow::Result<(Vec<u8>, String)> {
        let material = file.material();
        let (samples, how) = match material.samples() {
            Some(rows) => (rows.clone(), "measured rows"),
            None => {
                let theta_max = 80_f64.to_radians();
                let sampling = PairSampling { count: self.samples, seed: 1, theta_max };
                (material.draw(&sampling, material.channels()), "pairs drawn within 80°")
            }
        };
        let said = format!(
            "{} {how}; dropped: {}; {} with a negative channel set to 0",
            samples.len(),
            samples.dropped(),
            samples.clamped()
        );
        Ok((write_samples(&samples).into_bytes(), said))
    }

    fn container(&self, material: &MaterialFile) -> anyhow::Result<(Vec<u8>, String)> {
        let (bytes, converted) = material.to_container()?;
        let said = match (converted, material.samples()) {
            (Converted::Rows, Some(rows)) => {
                format!("{} measured rows; dropped: {}", rows.len(), rows.dropped())
            }
            (Converted::Rows | Converted::Model, _) => "the model, unchanged".to_owned(),
            (Converted::Table(how), _) => in_words(how),
        };
        Ok((bytes, said))
    }
}

fn scattered(material: &MaterialFile) -> String {
    format!(
        "{}: scattered samples do not fill MERL's grid; factor them first and convert the model",
        material.source
    )
}

fn in_words(how: Tabulated) -> String {
    match how {
        Tabulated::Copied => "the table, cell by cell".to_owned(),
        Tabulated::Evaluated { held_beyond } => {
            let held = held_beyond.map_or_else(String::new, |limit| {
                format!("; beyond {:.2}° the model holds its value there", limit.to_degrees())
            });
            format!(
                "evaluated at the cell centres of MERL's grid, with negative values set to 0, and made \
                 reciprocal{held}"
            )
        }
    }
}
