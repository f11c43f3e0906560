//! `brdf btf info`.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use brdf_io::{BtfInput, BtfModelFile, Format, MappedFile, detect, open_btf, open_btf_model};
use btf_vq::{BtfModel, Encoding};
use serde_json::{Value, json};

use super::loading::notes;
use crate::numbers::bytes;

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
    pub(in crate::commands) fn run(self, out: &mut impl Write) -> anyhow::Result<ExitCode> {
        let is_model = self.input.is_file()
            && matches!(detect(&MappedFile::open(&self.input)?), Ok(Format::Native));
        let facts = if is_model {
            model_facts(&open_btf_model(&self.input)?)
        } else {
            source_facts(&open_btf(&self.input)?)
        };
        if self.json {
            writeln!(out, "{}", serde_json::to_string_pretty(&facts)?)?;
            return Ok(ExitCode::SUCCESS);
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
        Ok(ExitCode::SUCCESS)
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

fn source_facts(input: &BtfInput) -> Value {
    let layout = input.layout();
    let lights: Vec<usize> = layout.views.iter().map(|view| view.lights.len()).collect();
    json!({
        "kind": match input { BtfInput::File(_) => "binary BTF", _ => "set of images" },
        "width": layout.width,
        "height": layout.height,
        "views": layout.views.len(),
        "lights": lights.iter().max(),
        "images": layout.image_count(),
        "encoding": encoding(layout.encoding),
        "cosine_included": layout.cosine_included,
        "raw_bytes": layout.raw_bytes(),
        "notes": notes(input),
    })
}

fn encoding(encoding: Encoding) -> &'static str {
    match encoding {
        Encoding::Srgb => "sRGB, 8 bits",
        Encoding::Linear => "linear radiance",
    }
}

fn model_facts(file: &BtfModelFile) -> Value {
    let streams = file.model.stream_bytes();
    let stored: usize = streams.iter().map(|s| s.1).sum();
    let (grid, values) = match &file.model {
        BtfModel::Vq(model) => (model.header().grid, model.header().encoding),
        BtfModel::Lpca(model) => (model.header().grid, model.header().encoding),
    };
    let textures: Vec<Value> = file
        .model
        .textures()
        .iter()
        .map(
            |t| json!({ "name": t.name, "width": t.width, "height": t.height, "levels": t.levels }),
        )
        .collect();
    let ratio = file.made.raw_bytes as f64 / file.bytes as f64;
    let mut facts = json!({
        "kind": "compressed BTF",
        "mode": file.made.mode,
        "bytes": file.bytes,
        "header_bytes": file.bytes - stored,
        "ratio": ratio,
        "encoding": encoding(values),
        "parametrization": grid.parametrization,
        "nodes": format!("{} alpha, {} beta, {} theta, {} phi",
            grid.alphas, grid.betas, grid.thetas, grid.phis),
        "textures": textures,
        "streams": streams.iter().map(|(name, n)| format!("{name} {}", bytes(*n)))
            .collect::<Vec<_>>(),
    });
    if let BtfModel::Vq(model) = &file.model {
        facts["rows"] = json!(model.header().rows);
    }
    facts
}
