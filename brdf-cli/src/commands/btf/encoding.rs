//! From inputs to a compressed BTF, new or grown.

use std::io::Write;
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

use anyhow::bail;
use brdf_io::{BtfRecord, btf_model_to_bytes, write_atomically};
use btf_vq::{
    BtfModel, Chroma, CodebookSizes, Codebooks, Encoding, IndexCodebook, LpcaModel, Material,
    Measure, PaperParams, ProjectedTexels, ProjectionParams, ScaleBits, TexelSet, VqModel,
    choose_sizes, encode_paper, encode_refined, fit_lpca,
};
use clap::ValueEnum;
use serde_json::{Map, Value, json};

use super::inputs::Inputs;
use super::loading::peak_memory;
use crate::args::{ForceArgs, positive, usage};
use crate::numbers::{bytes as shown_bytes, significant};
use crate::progress::Progress;

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
    /// Refuses options of other modes.
    pub(super) fn check(&self, mode: ModeArg) -> anyhow::Result<()> {
        if mode == ModeArg::Paper && self.ratio.is_some() {
            return Err(usage("--ratio: the paper's mode takes --epsilon and --budget"));
        }
        if mode != ModeArg::Paper && (self.epsilon.is_some() || self.measure.is_some()) {
            return Err(usage("--epsilon and --measure belong to --mode paper"));
        }
        Ok(())
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum ModeArg {
    /// Centres of clusters, sizes for a ratio
    Refined,
    /// As published
    Paper,
    /// Local principal components in bytes
    Lpca,
}

impl ModeArg {
    /// As files record it.
    fn name(self) -> &'static str {
        match self {
            Self::Refined => "refined",
            Self::Paper => "paper",
            Self::Lpca => "lpca",
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum MeasureArg {
    /// Mean squared error
    Mse,
    /// 98th percentile of 1 − SSIM over light directions
    Ssim,
}

/// A share of the whole from `1.2%` or `0.012`.
fn share(text: &str) -> Result<f64, String> {
    let (digits, unit) = text.strip_suffix('%').map_or((text, 1.0), |digits| (digits, 0.01));
    match digits.trim().parse::<f64>() {
        Ok(value) if value > 0.0 && value * unit <= 1.0 => Ok(value * unit),
        _ => Err("expected a share above 0 and at most 1, such as 1.2%".to_owned()),
    }
}

/// Ratio of the refined books where none is asked for.
const RATIO: f64 = 700.0;
/// Shares of the bytes asked for between which a file need not be made again.
const NEAR_ENOUGH: std::ops::RangeInclusive<f64> = 0.97..=1.01;

/// A compressed BTF that grows.
pub(super) struct Start {
    pub(super) books: Codebooks,
    pub(super) materials: Vec<Material>,
    pub(super) made: BtfRecord,
    /// Of its file.
    pub(super) bytes: usize,
}

/// What is compressed, and how.
pub(super) struct Job<'a> {
    pub(super) mode: ModeArg,
    pub(super) sizes: &'a SizeArgs,
    pub(super) inputs: &'a Inputs,
    pub(super) start: Option<Start>,
}

/// A compressed BTF and what should be said about it.
pub(super) struct Made {
    model: BtfModel,
    record: BtfRecord,
    notes: Vec<String>,
}

impl Job<'_> {
    /// Compresses and writes. Nothing is written unless all is done.
    pub(super) fn run(
        &self,
        output: &Path,
        force: &ForceArgs,
        is_json: bool,
        start: Instant,
        out: &mut impl Write,
    ) -> anyhow::Result<ExitCode> {
        let made = self.make()?;
        let file = btf_model_to_bytes(&made.model, &made.record)?;
        write_atomically(output, &file, force.overwrite())?;
        made.report(output, file.len(), start.elapsed().as_secs_f64(), is_json, out)
    }

    fn make(&self) -> anyhow::Result<Made> {
        self.inputs.with_sets(|sets| {
            let (model, notes) = match self.mode {
                ModeArg::Refined => self.refined(sets)?,
                ModeArg::Paper => (self.paper(sets)?, Vec::new()),
                ModeArg::Lpca => self.lpca(sets)?,
            };
            Ok(Made { model, record: self.record(), notes })
        })
    }

    /// Bytes of the file that the ratio asks for.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a ratio of bytes")]
    fn target(&self) -> u64 {
        (self.inputs.raw_bytes as f64 / self.sizes.ratio.unwrap_or(RATIO)) as u64
    }

    fn measure(&self) -> Measure {
        let made = self.start.as_ref().map(|start| &start.made);
        let is_mse = match self.sizes.measure {
            Some(measure) => measure == MeasureArg::Mse,
            None => made.is_some_and(|made| made.measure.as_deref() == Some("mse")),
        };
        #[expect(clippy::cast_possible_truncation, reason = "a threshold")]
        let given = self.sizes.epsilon.map(|e| e as f32);
        let earlier = made.filter(|_| self.sizes.measure.is_none()).and_then(|made| made.epsilon);
        match (is_mse, given.or(earlier)) {
            (true, epsilon) => Measure::Mse(epsilon.unwrap_or(0.004)),
            (false, epsilon) => Measure::Ssim(epsilon.unwrap_or(0.4)),
        }
    }

    fn record(&self) -> BtfRecord {
        let (measure, epsilon) = match (self.mode, self.measure()) {
            (ModeArg::Paper, Measure::Mse(epsilon)) => (Some("mse"), Some(epsilon)),
            (ModeArg::Paper, Measure::Ssim(epsilon)) => (Some("ssim"), Some(epsilon)),
            _ => (None, None),
        };
        BtfRecord {
            mode: self.mode.name().to_owned(),
            measure: measure.map(str::to_owned),
            epsilon,
            raw_bytes: self.inputs.raw_bytes
                + self.start.as_ref().map_or(0, |start| start.made.raw_bytes),
        }
    }

    /// The books to begin with.
    fn books(&self, encoding: Encoding, chroma: Chroma) -> Codebooks {
        let grown = self.start.as_ref().map(|start| start.books.clone());
        grown.unwrap_or_else(|| Codebooks::new(self.inputs.grid, encoding, chroma))
    }

    /// All textures, from a row of P6 for each texel of the new ones.
    fn materials(&self, rows: &IndexCodebook) -> Vec<Material> {
        let mut materials =
            self.start.as_ref().map_or_else(Vec::new, |start| start.materials.clone());
        let mut first = 0;
        for info in &self.inputs.infos {
            let levels = info.level_lens().map(|texels| {
                let range = first..first + texels;
                first = range.end;
                let (index, scale) = (&rows.index[range.clone()], &rows.scale[range]);
                IndexCodebook { len: 1, index: index.to_vec(), scale: scale.to_vec() }
            });
            let levels = levels.collect();
            materials.push(Material { info: info.clone(), levels });
        }
        materials
    }

    fn pack(
        &self,
        mut books: Codebooks,
        rows: &IndexCodebook,
        bits: ScaleBits,
    ) -> anyhow::Result<BtfModel> {
        let mut materials = self.materials(rows);
        books.normalize(&mut materials);
        Ok(BtfModel::Vq(VqModel::pack(&books, &materials, bits)?))
    }

    /// A survey of texels that have a subspace in common.
    fn survey(
        &self,
        sets: &[TexelSet<'_>],
        progress: &Progress,
    ) -> anyhow::Result<ProjectedTexels> {
        progress.step("resampling");
        Ok(ProjectedTexels::of(sets, ProjectionParams::default(), &|n| progress.done(n as u64))?)
    }

    fn refined(&self, sets: &[TexelSet<'_>]) -> anyhow::Result<(BtfModel, Vec<String>)> {
        TexelSet::check_alike(sets)?;
        let texels = self.inputs.texels() as u64;
        let progress = Progress::new(3 * texels);
        let surveys = self.inputs.by_texture(sets).map(|sets| self.survey(sets, &progress));
        let surveys = surveys.collect::<Result<Vec<_>, _>>()?;
        let notes = notes(sets, &surveys);
        let bits = ScaleBits::refined(sets[0].encoding());
        progress.step("choosing sizes");
        let sizes = choose_sizes(&surveys, &bits, self.target())?;
        progress.step("building books");
        progress.done(texels);
        let model = self.build(&surveys, &sizes, bits)?;
        let bytes = btf_model_to_bytes(&model, &self.record())?.len();
        let before = self.start.as_ref().map_or(0, |start| start.bytes);
        let target = usize::try_from(self.target())? + before;
        let of_target = |bytes: usize| bytes as f64 / target as f64;
        // Where every slice of a BRDF has a row of its own, there is nothing to grow.
        let is_full = self.inputs.grid.phis == 1 && bytes <= target;
        if is_full || NEAR_ENOUGH.contains(&of_target(bytes)) {
            return Ok((model, notes));
        }
        // P6 does not shrink with the books, nor does what was there before.
        let textures = model.stream_bytes().into_iter().skip(8);
        let fixed = before.max(textures.map(|stream| stream.1).sum());
        if target <= fixed || bytes <= fixed {
            bail!("{target} bytes are too few; ask for a lower --ratio");
        }
        let share = (target - fixed) as f64 / (bytes - fixed) as f64;
        Ok((self.build(&surveys, &sizes.times(share), bits)?, notes))
    }

    fn build(
        &self,
        surveys: &[ProjectedTexels],
        sizes: &CodebookSizes,
        bits: ScaleBits,
    ) -> anyhow::Result<BtfModel> {
        let books = self.books(surveys[0].encoding(), Chroma::Relative);
        let encoded = encode_refined(surveys, sizes, books);
        let rows = IndexCodebook { len: 1, index: encoded.index, scale: encoded.scale };
        self.pack(encoded.books, &rows, bits)
    }

    fn paper(&self, sets: &[TexelSet<'_>]) -> anyhow::Result<BtfModel> {
        let progress = Progress::new(2 * self.inputs.texels() as u64);
        progress.step("building books");
        let params = PaperParams { measure: self.measure(), budget: self.sizes.budget };
        let empty = self.books(sets[0].encoding(), Chroma::Absolute);
        let (books, textures) = encode_paper(sets, &params, empty, &|n| progress.done(n as u64))?;
        let mut rows = IndexCodebook { len: 1, ..IndexCodebook::default() };
        for texture in textures {
            rows.index.extend(texture.index);
            rows.scale.extend(texture.scale);
        }
        let bits = ScaleBits::paper(books.encoding);
        self.pack(books, &rows, bits)
    }

    fn lpca(&self, sets: &[TexelSet<'_>]) -> anyhow::Result<(BtfModel, Vec<String>)> {
        let progress = Progress::new(2 * self.inputs.texels() as u64);
        let survey = self.survey(sets, &progress)?;
        let notes = notes(sets, std::slice::from_ref(&survey));
        progress.step("fitting components");
        let fit = fit_lpca(&survey, usize::try_from(self.target())?, 1)?;
        let model = LpcaModel::pack(&survey, &fit, self.inputs.infos.clone())?;
        Ok((BtfModel::Lpca(model), notes))
    }
}

/// What should be said about resampling.
fn notes(sets: &[TexelSet<'_>], surveys: &[ProjectedTexels]) -> Vec<String> {
    let filled: usize = sets.iter().map(TexelSet::filled).sum();
    let clamped: u64 = surveys.iter().map(|survey| survey.clamped).sum();
    let mut notes = Vec::new();
    if filled > 0 {
        notes.push(format!("{filled} pairs of view and light were interpolated"));
    }
    if clamped > 0 {
        notes.push(format!(
            "{clamped} nodes with luminance that interpolation made negative, set to 0"
        ));
    }
    notes
}

impl Made {
    fn report(
        &self,
        output: &Path,
        bytes: usize,
        seconds: f64,
        is_json: bool,
        out: &mut impl Write,
    ) -> anyhow::Result<ExitCode> {
        let raw_bytes = self.record.raw_bytes;
        let ratio = raw_bytes as f64 / bytes as f64;
        let streams = self.model.stream_bytes();
        let stored: usize = streams.iter().map(|s| s.1).sum();
        let books = match &self.model {
            BtfModel::Vq(model) => json!(model.header().rows),
            BtfModel::Lpca(model) => {
                json!({ "clusters": model.header().clusters, "components": model.header().components })
            }
        };
        if is_json {
            let sizes: Map<String, Value> =
                streams.iter().map(|(name, n)| (name.clone(), json!(n))).collect();
            let report = json!({
                "output": output, "bytes": bytes, "header_bytes": bytes - stored,
                "raw_bytes": raw_bytes, "ratio": ratio, "books": books,
                "stream_bytes": sizes, "seconds": seconds, "peak_memory": peak_memory(),
                "notes": self.notes,
            });
            writeln!(out, "{}", serde_json::to_string_pretty(&report)?)?;
            return Ok(ExitCode::SUCCESS);
        }
        writeln!(out, "{}", output.display())?;
        writeln!(out, "  {} (1:{ratio:.0}), in {} s", shown_bytes(bytes), significant(seconds))?;
        writeln!(out, "  rows: {}", books.to_string().replace(['{', '}', '"'], ""))?;
        self.notes.iter().try_for_each(|note| writeln!(out, "  {note}"))?;
        Ok(ExitCode::SUCCESS)
    }
}
