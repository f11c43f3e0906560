//! `brdf sample`.

use std::fmt::Write as _;
use std::io::Write;

use brdf_io::write_samples;
use brdf_model::PairSampling;

use crate::args::{PairArgs, ReadArgs};
use crate::outputs::TableArgs;

/// Draw direction pairs and write them with their values
///
/// Pairs are uniform on two parabolic discs, from a scrambled Sobol sequence: what `brdf factor`
/// fits. Scattered measurements give their own rows instead. Output is a CSV table with columns
/// theta_i_deg, phi_i_deg, theta_o_deg, phi_o_deg, r, g, b (or value for one channel), which
/// `brdf eval --directions` and every command that takes a measured file can read.
///
/// Example: brdf sample preset:ggx -n 1000 -o pairs.csv
#[derive(clap::Args)]
pub(super) struct Sample {
    /// Material to draw from
    model: String,

    /// Number of pairs [default: 45000, or all rows of a scattered measurement]
    #[arg(short = 'n', long = "samples", value_parser = clap::value_parser!(u32).range(1..))]
    samples: Option<u32>,

    /// Which scramble of the sequence
    #[arg(long, default_value_t = 1)]
    seed: u64,

    #[command(flatten)]
    pairs: PairArgs,

    #[command(flatten)]
    table: TableArgs,

    #[command(flatten)]
    read: ReadArgs,
}

impl Sample {
    pub(super) fn run(self, out: &mut impl Write) -> anyhow::Result<()> {
        let file = self.read.open(&self.model)?;
        let material = file.material();
        let sampling = PairSampling {
            count: self.samples.unwrap_or(45_000),
            seed: self.seed,
            theta_max: self.pairs.theta_max(),
        };
        let channels = self.pairs.channels().unwrap_or(material.channels());
        let mut samples = material.draw(&sampling, channels);
        if let (Some(_), Some(count)) = (material.samples(), self.samples) {
            samples = samples.subset(count as usize);
        }
        let table = write_samples(&samples);
        self.table.write(&table, out)?;
        let mut said = format!("{} pairs", samples.len());
        if samples.dropped().total() > 0 {
            write!(said, "; dropped: {}", samples.dropped())?;
        }
        if samples.clamped() > 0 {
            write!(said, "; {} with a negative channel set to 0", samples.clamped())?;
        }
        writeln!(std::io::stderr(), "{said}")?;
        Ok(())
    }
}
