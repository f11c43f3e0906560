//! `brdf btf eval`.

use std::io::Write;
use std::path::PathBuf;

use anyhow::bail;
use brdf_files::{FileError, MappedFile};
use btf_io::{answer_table, read_queries};

use super::loading::ModelArgs;
use crate::outputs::TableArgs;

/// Evaluate a compressed BTF at places and pairs of directions
///
/// Queries are a table of u,v,theta_i_deg,phi_i_deg,theta_v_deg,phi_v_deg, with or without this
/// header; u to the right and v upwards, tiled. Output adds r,g,b: linear radiance of one texel, where 1
/// is a white diffuser that faces the light; 0 for directions below the horizon.
///
/// Example: brdf btf eval wool.btfvq --queries queries.csv -o values.csv
#[derive(clap::Args)]
pub(in crate::commands) struct Eval {
    #[command(flatten)]
    model: ModelArgs,

    /// Table of places and directions
    #[arg(long, value_name = "FILE")]
    queries: PathBuf,

    /// Resolution; 0 is the finest
    #[arg(long, default_value_t = 0)]
    level: usize,

    #[command(flatten)]
    table: TableArgs,
}

impl Eval {
    pub(in crate::commands) fn run(self, out: &mut impl Write) -> anyhow::Result<()> {
        let model = self.model.open()?;
        let reader = model.reader()?;
        if self.level >= reader.levels() {
            bail!("--level {}: {} has {}", self.level, self.model.model.display(), reader.levels());
        }
        let rows = read_queries(&MappedFile::open(&self.queries)?)
            .map_err(FileError::content(&self.queries))?;
        let (table, below) = answer_table(&reader, self.level, &rows);
        self.table.write(&table, out)?;
        if below > 0 {
            writeln!(std::io::stderr(), "{below} rows below the horizon (0)")?;
        }
        Ok(())
    }
}
