//! `brdf eval`.

use std::io::Write;
use std::path::PathBuf;

use brdf_files::{FileError, MappedFile};
use brdf_io::{direction_rows, direction_table_header};
use brdf_param::DirectionPair;
use brdf_report::evaluation_notes;

use crate::args::ReadArgs;
use crate::outputs::TableArgs;

/// Evaluate a material at given directions
///
/// Prints theta_i_deg, phi_i_deg, theta_o_deg, phi_o_deg and r, g, b in sr⁻¹ for every row of the
/// directions. Where a measured table has no data the values are NaN; below the horizon they are 0.
///
/// Example: brdf eval brdf-out/model.safetensors --directions pairs.csv
#[derive(clap::Args)]
pub(super) struct Eval {
    /// Material to evaluate
    model: String,

    /// Table whose header names theta_i_deg, phi_i_deg, theta_o_deg and phi_o_deg; other columns
    /// are not read
    #[arg(long, value_name = "FILE")]
    directions: PathBuf,

    #[command(flatten)]
    table: TableArgs,

    #[command(flatten)]
    read: ReadArgs,
}

impl Eval {
    pub(super) fn run(self, out: &mut impl Write) -> anyhow::Result<()> {
        let material = self.read.open(&self.model)?;
        let bytes = MappedFile::open(&self.directions)?;
        let rows = direction_rows(&String::from_utf8_lossy(&bytes))
            .map_err(FileError::content(&self.directions))?;
        let (pairs, angles): (Vec<DirectionPair>, Vec<String>) = rows.into_iter().unzip();
        let found = material.evaluate(&pairs);
        let mut table = format!("{}\n", direction_table_header(true));
        for (value, angles) in found.values.iter().zip(&angles) {
            let [r, g, b] = value.channels();
            table.push_str(&format!("{angles},{r},{g},{b}\n"));
        }
        self.table.write(&table, out)?;
        let mut err = std::io::stderr();
        if material.samples().is_some() {
            let name = &material.source;
            writeln!(
                err,
                "{name}: scattered samples; values are interpolated between the nearest ones"
            )?;
        }
        evaluation_notes(&found).iter().try_for_each(|note| writeln!(err, "{note}"))?;
        Ok(())
    }
}
