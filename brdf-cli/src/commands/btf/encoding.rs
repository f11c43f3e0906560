//! From inputs to a compressed BTF, new or grown.

use std::io::Write;
use std::path::Path;
use std::time::Instant;

use anyhow::anyhow;
use brdf_container::{CompressReport, write_btf};
use brdf_files::write_atomically;
use brdf_report::compress_text;
use btf_vq::{
    Base, CompressSettings, Compressed, Mode, Similarity, TextureInputs, VqError, compress,
};

use super::loading::peak_memory;
use crate::args::{positive, usage};
use crate::outputs::{ForceArgs, show};
use crate::progress::Watch;

/// How large books become.
#[derive(Clone, Debug, clap::Args)]
pub(super) struct SizeArgs {
    /// Raw bytes over bytes of the file [default: 700; not of the paper's mode]
    #[arg(long, value_parser = positive, conflicts_with_all = ["epsilon", "budget", "measure"])]
    ratio: Option<f64>,

    /// What is similar enough in the paper's mode [default: ssim]
    #[arg(long, value_enum)]
    measure: Option<MeasureArg>,

    /// Threshold of the paper's mode: for mse the mean squared error of sRGB values in [0, 1], for ssim
    /// 1 − SSIM [default: 0.004 for mse, 0.4 for ssim]
    #[arg(long, value_parser = positive)]
    epsilon: Option<f64>,

    /// Most rows of P4 in the paper's mode, as a share of the texels, such as 1.2%
    #[arg(long, value_parser = share, default_value = "1.2%")]
    budget: f64,
}

impl SizeArgs {
    /// The settings; options of other modes are refused.
    pub(super) fn settings(&self, mode: Mode) -> anyhow::Result<CompressSettings> {
        if mode == Mode::Paper && self.ratio.is_some() {
            return Err(usage("--ratio: the paper's mode takes --epsilon and --budget"));
        }
        if mode != Mode::Paper && (self.epsilon.is_some() || self.measure.is_some()) {
            return Err(usage("--epsilon and --measure belong to --mode paper"));
        }
        let usual = CompressSettings::default();
        #[expect(clippy::cast_possible_truncation, reason = "a threshold")]
        let epsilon = self.epsilon.map(|epsilon| epsilon as f32);
        Ok(CompressSettings {
            mode,
            ratio: self.ratio.unwrap_or(usual.ratio),
            similarity: self.measure.map(Into::into),
            epsilon,
            budget: self.budget,
        })
    }
}

choices! {
    pub(super) enum ModeArg for Mode {
        /// Centres of clusters, sizes for a ratio
        Refined => Refined,
        /// As published
        Paper => Paper,
        /// Local principal components in bytes
        Lpca => Lpca,
    }
}

choices! {
    enum MeasureArg for Similarity {
        /// Mean squared error
        Mse => Mse,
        /// 98th percentile of 1 − SSIM over light directions
        Ssim => Ssim,
    }
}

/// A share of the whole from `1.2%` or `0.012`.
fn share(text: &str) -> Result<f64, String> {
    let (digits, unit) = text.strip_suffix('%').map_or((text, 1.0), |digits| (digits, 0.01));
    match digits.trim().parse::<f64>() {
        Ok(value) if value > 0.0 && value * unit <= 1.0 => Ok(value * unit),
        _ => Err("expected a share above 0 and at most 1, such as 1.2%".to_owned()),
    }
}

/// Where a compressed BTF goes and how that is told.
pub(super) struct Target<'a> {
    pub(super) output: &'a Path,
    pub(super) force: ForceArgs,
    pub(super) json: bool,
    /// When the command began.
    pub(super) start: Instant,
}

impl Target<'_> {
    /// Compresses and writes. Nothing is written unless all is done.
    pub(super) fn compress(
        &self,
        inputs: &TextureInputs<'_>,
        settings: &CompressSettings,
        base: Option<&Base>,
        watch: Watch,
        out: &mut impl Write,
    ) -> anyhow::Result<()> {
        let size = |model: &_, made: &_| write_btf(model, made).map_or(usize::MAX, |f| f.len());
        let made = watch.run(|job| compress(inputs, settings, base, &size, job));
        let Compressed { model, record, .. } = &made.as_ref().map_err(advise)?;
        let file = write_btf(model, record)?;
        write_atomically(self.output, &file, self.force.overwrite())?;
        drop(watch);
        let seconds = self.start.elapsed().as_secs_f64();
        let output = self.output.to_string_lossy();
        let mut report =
            CompressReport::new(&made.map_err(|e| advise(&e))?, &output, file.len(), seconds);
        report.peak_memory = peak_memory();
        show(out, self.json, &report, || compress_text(&report))
    }
}

/// The option that helps with an error.
fn advise(error: &VqError) -> anyhow::Error {
    match error {
        VqError::Budget { .. } => anyhow!("{error}; ask for a lower --ratio"),
        _ => anyhow!("{error}"),
    }
}
