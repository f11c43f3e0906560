//! `brdf info`.

use std::io::Write;

use brdf_report::info_text;

use crate::advice::{AlreadySaid, on_error, read_notes};
use crate::args::ReadArgs;
use crate::progress::Watch;

/// Say what files hold, and whether they are physically plausible
///
/// Reports format, size and channels; for materials that can be evaluated, the reciprocity error,
/// the largest directional albedo and how much of the domain has data; for scattered samples, their
/// ranges and what was dropped; for models, how they were made and how good they are.
///
/// Example: brdf info *.binary preset:lafortune-blue-paint
#[derive(clap::Args)]
pub(super) struct Info {
    /// Files or presets
    #[arg(required = true, value_name = "FILE")]
    files: Vec<String>,

    /// Print a JSON list
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    read: ReadArgs,
}

impl Info {
    pub(super) fn run(self, out: &mut impl Write) -> anyhow::Result<()> {
        let watch = Watch::start();
        let mut failed = false;
        let mut all = Vec::new();
        for file in &self.files {
            watch.step(format!("checking {file}"));
            let opened = self.read.open(file);
            match opened.map(|material| material.info(read_notes(&material.notes))) {
                Ok(info) if self.json => all.push(info),
                Ok(info) => out.write_all(info_text(&info).as_bytes())?,
                Err(error) => {
                    failed = true;
                    writeln!(std::io::stderr(), "brdf: {error:#}{}", on_error(&error))?;
                }
            }
        }
        if self.json {
            writeln!(out, "{}", serde_json::to_string_pretty(&all)?)?;
        }
        if failed { Err(AlreadySaid.into()) } else { Ok(()) }
    }
}
