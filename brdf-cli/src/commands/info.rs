//! `brdf info`.

use std::io::Write;
use std::process::ExitCode;

use brdf_container::MaterialInfo;
use brdf_model::{Channels, MerlTable};
use brdf_report::{bytes, or_dash, percent, significant};

use crate::advice::{on_error, read_notes};
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
    pub(super) fn run(self, out: &mut impl Write) -> anyhow::Result<ExitCode> {
        let watch = Watch::start();
        let mut failed = false;
        let mut all = Vec::new();
        for file in &self.files {
            watch.step(format!("checking {file}"));
            let opened = self.read.open(file);
            match opened.map(|material| material.info(read_notes(&material.notes))) {
                Ok(info) if self.json => all.push(info),
                Ok(info) => print(&info, out)?,
                Err(error) => {
                    failed = true;
                    writeln!(std::io::stderr(), "brdf: {error:#}{}", on_error(&error))?;
                }
            }
        }
        if self.json {
            writeln!(out, "{}", serde_json::to_string_pretty(&all)?)?;
        }
        Ok(if failed { ExitCode::FAILURE } else { ExitCode::SUCCESS })
    }
}

fn print(info: &MaterialInfo, out: &mut impl Write) -> std::io::Result<()> {
    let channels = match info.channels {
        Channels::Rgb => "RGB",
        Channels::Luminance => "one channel",
    };
    writeln!(out, "{}: {}, {}, {channels}", info.file, info.format, bytes(info.bytes))?;
    if let Some(invalid) = info.invalid_cells {
        writeln!(out, "  {invalid} of {} cells invalid", MerlTable::CELLS)?;
    }
    if let Some(summary) = &info.samples {
        writeln!(
            out,
            "  {} samples, {} directions of light up to {:.1}°, viewers up to {:.1}°",
            summary.count, summary.incidences, summary.max_theta_i_deg, summary.max_theta_o_deg
        )?;
        writeln!(
            out,
            "  values {} to {} sr⁻¹, {} exactly 0",
            significant(summary.min_value),
            significant(summary.max_value),
            percent(summary.zero_share)
        )?;
    }
    if let Some(dropped) = &info.dropped
        && dropped.total() > 0
    {
        writeln!(out, "  dropped: {dropped}")?;
    }
    if let Some(checks) = &info.checks {
        writeln!(
            out,
            "  reciprocity error {}, largest albedo {} at {:.0}°, data for {} of pairs within \
             {:.0}°",
            percent(checks.reciprocity_error),
            significant(checks.largest_albedo),
            checks.largest_albedo_theta_deg,
            percent(checks.coverage.share),
            checks.coverage.max_theta_deg
        )?;
        if checks.largest_albedo > 1.0 {
            writeln!(out, "  more light leaves than arrives: an albedo above 1")?;
        }
    }
    if let Some(model) = &info.model {
        writeln!(out, "  {} of {}, {} space", model.method, model.input, model.space.name())?;
        for term in &model.terms {
            writeln!(
                out,
                "  {} textures: mean square log error {}, held out {}",
                term.textures,
                significant(term.training.log.mean_square),
                or_dash(term.held_out.as_ref().map(|e| e.log.mean_square))
            )?;
        }
    }
    if let Some(fit) = &info.separable {
        let terms = fit.terms.last().map_or(0, |term| term.matrix.rank);
        writeln!(out, "  {} of {}, {terms} terms", fit.method, fit.input)?;
        for term in &fit.terms {
            writeln!(
                out,
                "  {} terms: relative residual {}, mean square log error {} held out",
                term.matrix.rank,
                significant(term.matrix.relative_residual),
                or_dash(term.held_out.as_ref().map(|e| e.log.mean_square))
            )?;
        }
    }
    for note in &info.notes {
        writeln!(out, "  {note}")?;
    }
    Ok(())
}
