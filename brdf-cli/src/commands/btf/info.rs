//! `brdf btf info`.

use std::io::Write;
use std::path::PathBuf;

use brdf_container::{looks_like_container, open_compressed_btf};
use brdf_files::MappedFile;
use brdf_report::bytes;
use btf_io::open_btf;
use serde_json::Value;

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
        if self.json {
            writeln!(out, "{}", serde_json::to_string_pretty(&facts)?)?;
            return Ok(());
        }
        writeln!(out, "{}", self.input.display())?;
        for (key, value) in facts.as_object().into_iter().flatten() {
            match value {
                Value::Array(items) => {
                    items.iter().try_for_each(|item| writeln!(out, "  {key}: {}", plain(item)))?;
                }
                other => writeln!(out, "  {key}: {}", plain(other))?,
            }
        }
        Ok(())
    }
}

/// JSON without quotes and braces.
fn plain(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Object(fields) => {
            let parts: Vec<String> =
                fields.iter().map(|(key, value)| format!("{key} {}", plain(value))).collect();
            parts.join(", ")
        }
        other => other.to_string(),
    }
}
