//! `brdf compare`.

mod folders;
mod measures;
mod table;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::bail;
use brdf_model::{Channels, Dropped, PairSampling, SampleSet, log_offsets};
use clap::ValueEnum;
use serde::Serialize;

use self::measures::{Evaluator, Row};
use crate::args::{PairArgs, ReadArgs, usage};
use crate::pictures::metric_lights;
use crate::progress::Progress;
use crate::subject::Subject;

/// Compare models with a reference, or folders of them
///
/// Log errors are of ln(a + f), with a = 1e-5 of the reference's mean; linear errors and the
/// cosine-weighted RMS are in sr⁻¹. Pairs are drawn as `brdf sample` draws them; a scattered
/// reference gives its own rows. The cosine-weighted RMS has 80,000 pairs of its own, uniform over
/// both hemispheres, and needs a reference that can be evaluated everywhere. --metrics all adds
/// measures that follow the eye, on pairs and on spheres under two environments and one directional
/// light, and the time of a million evaluations.
///
/// If REFERENCE is a folder, so is every MODEL: models are matched with the references of the same
/// name (NAME.* or NAME/model.safetensors), and the median and the worst five of every measure are
/// printed.
///
/// Examples:
///   brdf compare garnet_red.brdf garnet/model.safetensors
///   brdf compare silk.binary a/model.safetensors b/model.safetensors --metrics all
///   brdf compare measured/ fitted/ --metrics all --json
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(super) struct Compare {
    /// Material to compare with, or a folder of them
    reference: String,

    /// Models to judge, or folders of them
    #[arg(required = true)]
    models: Vec<String>,

    /// Which measures
    #[arg(long, value_enum, default_value_t = MetricsArg::Basic)]
    metrics: MetricsArg,

    /// Environments for the measures on spheres, lat-long Radiance HDR, in place of the built-in
    /// sky and studio
    #[arg(long, value_name = "FILE", num_args = 1)]
    env: Vec<PathBuf>,

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

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum MetricsArg {
    /// Differences on pairs
    Basic,
    /// All of them, pictures and times included
    All,
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

impl Compare {
    pub(super) fn run(self, out: &mut impl Write) -> anyhow::Result<ExitCode> {
        if self.metrics == MetricsArg::Basic && !self.env.is_empty() {
            return Err(usage("--env is for --metrics all"));
        }
        if Path::new(&self.reference).is_dir() {
            return self.compare_folders(out);
        }
        let comparison = self.compare(&self.reference, &self.models)?;
        if self.json {
            writeln!(out, "{}", serde_json::to_string_pretty(&comparison)?)?;
        } else if self.metrics == MetricsArg::All {
            table::print_all(&comparison, out)?;
        } else {
            table::print_basic(&comparison, out)?;
        }
        Ok(ExitCode::SUCCESS)
    }

    /// Judges models against one reference.
    fn compare(&self, reference: &str, models: &[String]) -> anyhow::Result<Comparison> {
        let options = self.read.options();
        let reference = Subject::open(reference, &options)?;
        let models: Vec<Subject> = models
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
        let samples = self.draw(&reference, channels);
        if samples.is_empty() {
            bail!("{}: no usable samples: {}", reference.argument, samples.dropped());
        }
        for model in &models {
            if model.channels() == Channels::Luminance && channels == Channels::Rgb {
                writeln!(
                    std::io::stderr(),
                    "{}: one channel, compared with three; --luminance compares like with like",
                    model.argument
                )?;
            }
        }
        let lights = match self.metrics {
            MetricsArg::Basic => Vec::new(),
            MetricsArg::All => metric_lights(&self.env)?,
        };
        let progress = Progress::new(models.len() as u64 + 1);
        progress.step("rendering the reference");
        let offsets = log_offsets(&samples);
        let mut judge = Evaluator::new(&reference, &samples, &offsets, channels, self.seed);
        if self.metrics == MetricsArg::All {
            judge = judge.with_pictures(lights);
        }
        progress.done(1);
        let results = models
            .iter()
            .map(|model| {
                progress.step(format!("comparing {}", model.short_name()));
                let row = judge.judge(model);
                progress.done(1);
                row
            })
            .collect();
        drop(progress);
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
        Ok(Comparison {
            reference: reference.argument.clone(),
            samples: samples.len(),
            dropped: samples.dropped(),
            clamped: samples.clamped(),
            seed: self.seed,
            results,
        })
    }

    fn draw(&self, reference: &Subject, channels: Channels) -> SampleSet {
        let theta_max = self.pairs.theta_max();
        match reference.samples() {
            Some(rows) if self.pairs.luminance => rows.to_luminance().within(theta_max),
            Some(rows) => rows.within(theta_max),
            None => {
                let sampling = PairSampling { count: self.samples, seed: self.seed, theta_max };
                SampleSet::draw(reference.brdf(), &sampling, channels)
            }
        }
    }
}
