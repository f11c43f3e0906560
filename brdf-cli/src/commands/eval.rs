//! `brdf eval`.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use brdf_io::{IoError, MappedFile, direction_rows, direction_table_header};
use brdf_param::DirectionPair;

use crate::args::{ReadArgs, TableArgs};
use crate::subject::Subject;

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
    pub(super) fn run(self, out: &mut impl Write) -> anyhow::Result<ExitCode> {
        let subject = Subject::open(&self.model, &self.read.options())?;
        let bytes = MappedFile::open(&self.directions)?;
        let in_file = IoError::format(&self.directions);
        let text = String::from_utf8_lossy(&bytes);
        let rows = direction_rows(&text).map_err(in_file)?;
        let mut table = format!("{}\n", direction_table_header(true));
        let (mut below, mut without_data) = (0_usize, 0_usize);
        for (pair, angles) in &rows {
            let value = subject.brdf().eval(pair);
            let lit = pair.wi.z > 0.0 && pair.wo.z > 0.0;
            below += usize::from(!lit);
            let known = !lit || subject.brdf().has_data(pair);
            without_data += usize::from(!known);
            let [r, g, b] = if known { value.channels() } else { [f64::NAN; 3] };
            table.push_str(&format!("{angles},{r},{g},{b}\n"));
        }
        self.table.write(&table, out)?;
        if below + without_data > 0 {
            writeln!(
                std::io::stderr(),
                "{below} rows below the horizon (0), {without_data} without data (NaN)"
            )?;
        }
        if subject.samples().is_some() {
            writeln!(
                std::io::stderr(),
                "{}: scattered samples; values are interpolated between the nearest ones",
                subject.argument
            )?;
        }
        if let Some(brdf_io::Measured::Separable(_)) = subject.measurement().map(|m| &m.measured) {
            let is_negative = |pair: &DirectionPair| {
                subject.brdf().eval_unclamped(pair).channels().iter().any(|v| *v < 0.0)
            };
            let count = rows.iter().filter(|(pair, _)| is_negative(pair)).count();
            if count > 0 {
                writeln!(std::io::stderr(), "{count} rows with a negative value, set to 0")?;
            }
        }
        if let Some(brdf_io::Measured::Model(file)) = subject.measurement().map(|m| &m.measured) {
            let counts = file.model.count(rows.iter().map(|(pair, _)| *pair));
            if counts != brdf_factor::EvalCounts::default() {
                writeln!(
                    std::io::stderr(),
                    "{} rows beyond the model's grazing limit of {:.4}°, pulled back to it; {} moved \
                     to the rim of a texture; {} negative values set to 0",
                    counts.pulled_back,
                    file.model.theta_max().to_degrees(),
                    counts.outside_texture,
                    counts.clamped_below_zero
                )?;
            }
        }
        Ok(ExitCode::SUCCESS)
    }
}
