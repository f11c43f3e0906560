//! `brdf btf info`.

use std::io::Write;
use std::path::PathBuf;

use brdf_container::{looks_like_container, open_compressed_btf};
use brdf_files::MappedFile;
use brdf_report::{bytes, facts_text};
use btf_io::open_btf;

use crate::outputs::show;

/// Say what a BTF or a compressed BTF holds
///
/// Example: brdf btf info wool
#[derive(clap::Args)]
pub(in crate::commands) struct Info {
    /// BTF or compressed BTF
    #[arg(value_name = "IN|MODEL")]
    input: PathBuf,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl Info {
    pub(in crate::commands) fn run(self, out: &mut impl Write) -> anyhow::Result<()> {
        let is_model =
            self.input.is_file() && looks_like_container(&MappedFile::open(&self.input)?);
        let facts = if is_model {
            serde_json::to_value(open_compressed_btf(&self.input)?.info(bytes))?
        } else {
            serde_json::to_value(open_btf(&self.input)?.info())?
        };
        show(out, self.json, &facts, || facts_text(&self.input.to_string_lossy(), &facts))
    }
}
