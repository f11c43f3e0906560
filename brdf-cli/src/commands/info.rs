//! `brdf info`.

use std::io::Write;
use std::process::ExitCode;

use brdf_io::{Measured, ReadOptions};
use brdf_model::{Channels, Dropped, MerlTable, PhysicalChecks, SampleSummary, check, summarize};
use serde::Serialize;

use crate::args::ReadArgs;
use crate::numbers::{bytes, or_dash, percent, significant};
use crate::subject::Subject;

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

#[derive(Serialize)]
struct Facts {
    file: String,
    format: &'static str,
    bytes: usize,
    channels: Channels,
    #[serde(skip_serializing_if = "Option::is_none")]
    invalid_cells: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    samples: Option<SampleSummary>,
    #[serde(skip_serializing_if = "Option::is_none")]
    dropped: Option<Dropped>,
    #[serde(skip_serializing_if = "Option::is_none")]
    checks: Option<PhysicalChecks>,
    #[serde(skip_serializing_if = "Option::is_none")]
    model: Option<brdf_io::FitRecord>,
    #[serde(skip_serializing_if = "Option::is_none")]
    separable: Option<brdf_io::SeparableRecord>,
    notes: Vec<String>,
}

impl Info {
    pub(super) fn run(self, out: &mut impl Write) -> anyhow::Result<ExitCode> {
        let options = self.read.options();
        let mut failed = false;
        let mut all = Vec::new();
        for file in &self.files {
            match facts(file, &options) {
                Ok(facts) if self.json => all.push(facts),
                Ok(facts) => facts.print(out)?,
                Err(error) => {
                    failed = true;
                    writeln!(std::io::stderr(), "brdf: {error:#}")?;
                }
            }
        }
        if self.json {
            writeln!(out, "{}", serde_json::to_string_pretty(&all)?)?;
        }
        Ok(if failed { ExitCode::FAILURE } else { ExitCode::SUCCESS })
    }
}

fn facts(file: &str, options: &ReadOptions) -> anyhow::Result<Facts> {
    let subject = Subject::open(file, options)?;
    let measured = subject.measurement().map(|m| &m.measured);
    let scattered = subject.samples();
    let model = match measured {
        Some(Measured::Model(file)) => Some(file.fit.clone()),
        _ => None,
    };
    let separable = match measured {
        Some(Measured::Separable(file)) => Some(file.fit.clone()),
        _ => None,
    };
    Ok(Facts {
        file: file.to_owned(),
        format: subject.kind(),
        bytes: subject.bytes(),
        channels: subject.channels(),
        invalid_cells: match measured {
            Some(Measured::Merl(table)) => Some(table.invalid_cells()),
            _ => None,
        },
        samples: scattered.map(summarize),
        dropped: scattered.map(brdf_model::SampleSet::dropped),
        checks: scattered.is_none().then(|| check(subject.brdf(), 80_f64.to_radians())),
        model,
        separable,
        notes: subject.notes().to_vec(),
    })
}

impl Facts {
    fn print(&self, out: &mut impl Write) -> std::io::Result<()> {
        let channels = match self.channels {
            Channels::Rgb => "RGB",
            Channels::Luminance => "one channel",
        };
        writeln!(out, "{}: {}, {}, {channels}", self.file, self.format, bytes(self.bytes))?;
        if let Some(invalid) = self.invalid_cells {
            writeln!(out, "  {invalid} of {} cells invalid", MerlTable::CELLS)?;
        }
        if let Some(summary) = &self.samples {
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
        if let Some(dropped) = &self.dropped
            && dropped.total() > 0
        {
            writeln!(out, "  dropped: {dropped}")?;
        }
        if let Some(checks) = &self.checks {
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
        if let Some(model) = &self.model {
            writeln!(out, "  {} of {}, {} space", model.method, model.input, model.space)?;
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
        if let Some(fit) = &self.separable {
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
        for note in &self.notes {
            writeln!(out, "  {note}")?;
        }
        Ok(())
    }
}
