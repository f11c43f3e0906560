//! `brdf compare`.

use std::io::Write;
use std::process::ExitCode;

use anyhow::bail;
use brdf_model::{
    Channels, CosineRms, Dropped, ErrorMeasures, PairSampling, SampleSet, cosine_rms, log_offsets,
    measure,
};
use serde::Serialize;

use crate::args::{PairArgs, ReadArgs};
use crate::numbers::{bytes, or_dash, significant};
use crate::progress::Progress;
use crate::subject::Subject;

/// Compare models with a reference
///
/// Log errors are of ln(a + f), with a = 1e-5 of the reference's mean; linear errors and the
/// cosine-weighted RMS are in sr⁻¹. Pairs are drawn as `brdf sample` draws them; a scattered
/// reference gives its own rows. The cosine-weighted RMS has 80,000 pairs of its own, uniform over
/// both hemispheres, and needs a reference that can be evaluated everywhere.
///
/// Example: brdf compare garnet_red.brdf garnet/model.safetensors
#[derive(clap::Args)]
pub(super) struct Compare {
    /// Material to compare with
    reference: String,

    /// Models to judge
    #[arg(required = true)]
    models: Vec<String>,

    /// Number of pairs to draw
    #[arg(short = 'n', long, default_value_t = 45_000, value_parser = clap::value_parser!(u32).range(1..))]
    samples: u32,

    /// Which scramble of the sequence; the one that `brdf factor` fits by default is 1
    #[arg(long, default_value_t = 2)]
    seed: u64,

    #[command(flatten)]
    pairs: PairArgs,

    /// Print JSON
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    read: ReadArgs,
}

/// What `compare --json` prints.
#[derive(Serialize)]
struct Comparison {
    reference: String,
    /// Pairs that were compared.
    samples: usize,
    dropped: Dropped,
    /// Samples of the reference with a negative channel that was set to 0.
    clamped: usize,
    seed: u64,
    results: Vec<Row>,
}

#[derive(Serialize)]
struct Row {
    model: String,
    bytes: usize,
    /// Pairs that the model has no data for; they are left out of its errors.
    without_data: usize,
    /// Log residuals for which a + f̂ was not positive and f̂ = 0 stood in.
    without_logarithm: usize,
    log: ErrorMeasures,
    linear: ErrorMeasures,
    /// sr⁻¹; null where the reference cannot be evaluated everywhere.
    cosine_rms: Option<f64>,
    /// The same over the reference's own cosine-weighted RMS.
    cosine_rms_relative: Option<f64>,
    /// Pairs of the cosine-weighted RMS for which the reference or the model has no data.
    cosine_rms_without_data: Option<usize>,
}

impl Compare {
    pub(super) fn run(self, out: &mut impl Write) -> anyhow::Result<ExitCode> {
        let options = self.read.options();
        let reference = Subject::open(&self.reference, &options)?;
        let models: Vec<Subject> = self
            .models
            .iter()
            .map(|model| Subject::open(model, &options))
            .collect::<anyhow::Result<_>>()?;
        if let Some(scattered) = models.iter().find(|model| model.samples().is_some()) {
            bail!(
                "{}: scattered samples cannot be judged as a model; give them as the reference",
                scattered.argument
            );
        }
        let channels = self.pairs.channels(reference.channels());
        let theta_max = self.pairs.theta_max();
        let samples = match reference.samples() {
            Some(rows) if self.pairs.luminance => rows.to_luminance().within(theta_max),
            Some(rows) => rows.within(theta_max),
            None => {
                let sampling = PairSampling { count: self.samples, seed: self.seed, theta_max };
                SampleSet::draw(reference.brdf(), &sampling, channels)
            }
        };
        if samples.is_empty() {
            bail!("{}: no usable samples: {}", self.reference, samples.dropped());
        }
        let offsets = log_offsets(&samples);
        let progress = Progress::new(models.len() as u64);
        for model in &models {
            if model.channels() == Channels::Luminance && channels == Channels::Rgb {
                writeln!(
                    std::io::stderr(),
                    "{}: one channel, compared with three; --luminance compares like with like",
                    model.argument
                )?;
            }
        }
        let results = models
            .iter()
            .map(|model| {
                progress.step(format!("comparing {}", model.short_name()));
                let shared = samples.covered_by(model.brdf());
                let errors = measure(&shared, model.brdf(), &offsets);
                let rms: Option<CosineRms> = reference
                    .samples()
                    .is_none()
                    .then(|| cosine_rms(reference.brdf(), model.brdf(), channels, self.seed));
                progress.done(1);
                Row {
                    model: model.argument.clone(),
                    bytes: model.bytes(),
                    without_data: samples.len() - shared.len(),
                    without_logarithm: errors.without_logarithm,
                    log: errors.log,
                    linear: errors.linear,
                    cosine_rms: rms.map(|r| r.absolute),
                    cosine_rms_relative: rms.map(|r| r.relative),
                    cosine_rms_without_data: rms.map(|r| r.without_data),
                }
            })
            .collect();
        drop(progress);
        let comparison = Comparison {
            reference: self.reference,
            samples: samples.len(),
            dropped: samples.dropped(),
            clamped: samples.clamped(),
            seed: self.seed,
            results,
        };
        if self.json {
            writeln!(out, "{}", serde_json::to_string_pretty(&comparison)?)?;
        } else {
            comparison.print(out)?;
        }
        if samples.dropped().total() > 0 {
            writeln!(std::io::stderr(), "dropped: {}", samples.dropped())?;
        }
        if samples.clamped() > 0 {
            writeln!(
                std::io::stderr(),
                "{} samples of the reference with a negative channel set to 0",
                samples.clamped()
            )?;
        }
        Ok(ExitCode::SUCCESS)
    }
}

impl Comparison {
    fn print(&self, out: &mut impl Write) -> std::io::Result<()> {
        writeln!(out, "reference {}, {} pairs, seed {}", self.reference, self.samples, self.seed)?;
        let width = self.results.iter().map(|r| r.model.chars().count()).max().unwrap_or(0).max(5);
        writeln!(
            out,
            "{:width$}  {:>9}  {:>9}  {:>9}  {:>9}  {:>9}  {:>10}  {:>9}  {:>10}",
            "model",
            "bytes",
            "log abs",
            "log sq",
            "log max",
            "lin abs",
            "lin sq",
            "lin max",
            "cosine rms"
        )?;
        for row in &self.results {
            writeln!(
                out,
                "{:width$}  {:>9}  {:>9}  {:>9}  {:>9}  {:>9}  {:>10}  {:>9}  {:>10}",
                row.model,
                bytes(row.bytes),
                significant(row.log.mean_abs),
                significant(row.log.mean_square),
                significant(row.log.max),
                significant(row.linear.mean_abs),
                significant(row.linear.mean_square),
                significant(row.linear.max),
                or_dash(row.cosine_rms),
            )?;
            if row.without_data > 0 {
                writeln!(out, "{:width$}  {} pairs without data left out", "", row.without_data)?;
            }
        }
        Ok(())
    }
}
