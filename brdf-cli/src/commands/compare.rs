//! `brdf compare`.

use std::io::{Write, stderr};
use std::path::{Path, PathBuf};

use anyhow::bail;
use brdf_container::{MaterialFile, compare_folders};
use brdf_fit::{Candidate, CompareSettings, Comparison, compare, metric_lights};
use brdf_model::Channels;
use brdf_report::{comparison_measures, comparison_table, folder_comparison_text};
use clap::ValueEnum;

use crate::args::{PairArgs, ReadArgs, environment, stem, usage};
use crate::outputs::show;
use crate::progress::Watch;

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

impl Compare {
    pub(super) fn run(self, out: &mut impl Write) -> anyhow::Result<()> {
        if self.metrics == MetricsArg::Basic && !self.env.is_empty() {
            return Err(usage("--env is for --metrics all"));
        }
        let settings = self.settings()?;
        let watch = Watch::start();
        if Path::new(&self.reference).is_dir() {
            let comparison =
                compare_folders(&self.reference, &self.models, |reference, models| {
                    self.compare(reference, models, &settings, &watch)
                })?;
            drop(watch);
            return show(out, self.json, &comparison, || folder_comparison_text(&comparison));
        }
        let comparison = self.compare(&self.reference, &self.models, &settings, &watch)?;
        drop(watch);
        show(out, self.json, &comparison, || match self.metrics {
            MetricsArg::All => comparison_measures(&comparison),
            MetricsArg::Basic => comparison_table(&comparison),
        })
    }

    fn settings(&self) -> anyhow::Result<CompareSettings> {
        let is_all = self.metrics == MetricsArg::All;
        let given = self.env.iter().map(|path| Ok((stem(path), environment(path)?)));
        let given = given.collect::<anyhow::Result<Vec<_>>>()?;
        Ok(CompareSettings {
            samples: self.samples,
            seed: self.seed,
            theta_max: self.pairs.theta_max(),
            channels: self.pairs.channels(),
            lights: match is_all {
                true => metric_lights((!given.is_empty()).then_some(given))?,
                false => Vec::new(),
            },
            timed: is_all,
        })
    }

    /// Judges models by one reference.
    fn compare(
        &self,
        reference: &str,
        models: &[String],
        settings: &CompareSettings,
        watch: &Watch,
    ) -> anyhow::Result<Comparison> {
        let reference = self.read.open(reference)?;
        let models: Vec<MaterialFile> =
            models.iter().map(|model| self.read.open(model)).collect::<anyhow::Result<_>>()?;
        if let Some(scattered) = models.iter().find(|model| model.samples().is_some()) {
            bail!(
                "{}: scattered samples cannot be judged as a model; give them as the reference",
                scattered.source
            );
        }
        let is_colour = settings.channels.unwrap_or(reference.channels()) == Channels::Rgb;
        for model in models.iter().filter(|m| is_colour && m.channels() == Channels::Luminance) {
            writeln!(
                stderr(),
                "{}: one channel, compared with three; --luminance compares like with like",
                model.source
            )?;
        }
        let candidates: Vec<Candidate<'_>> = models
            .iter()
            .map(|model| Candidate {
                label: model.source.clone(),
                brdf: model.brdf(),
                bytes: model.bytes(),
            })
            .collect();
        let material = reference.named(reference.source.clone());
        let found = watch.run(|job| compare(&material, &candidates, settings, job))?;
        if found.dropped.total() > 0 {
            writeln!(stderr(), "dropped: {}", found.dropped)?;
        }
        if found.clamped > 0 {
            writeln!(
                stderr(),
                "{} samples of the reference with a negative channel set to 0",
                found.clamped
            )?;
        }
        Ok(found)
    }
}
