//! `brdf btf compress`.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use anyhow::bail;
use brdf_io::{Btf, BtfRecord, btf_model_to_bytes, write_atomically};
use btf_vq::{
    AngularGrid, BookSizes, BtfLayout, BtfModel, BtfSource, IndexBook, LightParametrization,
    LpcaMaterial, LpcaModel, Material, Measure, Mipped, PaperParams, Resampler, ScaleBits, Survey,
    SurveyParams, TexelSet, VqModel, choose_sizes, encode_paper, encode_refined, fit_lpca,
};
use clap::ValueEnum;
use serde_json::{Map, Value, json};

use super::loading::{MemoryArgs, load, notes, peak_memory};
use crate::args::{ForceArgs, positive, usage};
use crate::numbers::{bytes as shown_bytes, significant};
use crate::progress::Progress;

/// Compress BTFs into nested codebooks
///
/// `refined` (the default) clusters texels and slices at every level and fills the bytes that --ratio
/// leaves. `paper` is multi-level vector quantization as published: exemplars come in Halton order and
/// --epsilon or --budget decide how many. `lpca` stores local principal components in bytes: a rival
/// that is as randomly readable. Several inputs share one set of books. Equal inputs and options give
/// equal bytes, whatever the number of threads.
///
/// Example: brdf btf compress wool -o wool.btfvq --ratio 700
#[derive(clap::Args)]
pub(in crate::commands) struct Compress {
    /// BTFs: folders or ZIP archives of images, or .btf files
    #[arg(required = true, value_name = "IN")]
    inputs: Vec<PathBuf>,

    /// Compressed BTF to write
    #[arg(short, long, value_name = "FILE", default_value = "material.btfvq")]
    output: PathBuf,

    /// How books are made
    #[arg(long, value_enum, default_value_t = ModeArg::Refined)]
    mode: ModeArg,

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

    /// How light directions are laid out
    #[arg(long, value_enum, default_value_t = ParametrizationArg::Corrected)]
    parametrization: ParametrizationArg,

    /// Store coarser levels too
    #[arg(long)]
    mipmaps: bool,

    #[command(flatten)]
    memory: MemoryArgs,

    #[command(flatten)]
    force: ForceArgs,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ModeArg {
    /// Centres of clusters, sizes for a ratio
    Refined,
    /// As published
    Paper,
    /// Local principal components in bytes
    Lpca,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum MeasureArg {
    /// Mean squared error
    Mse,
    /// 98th percentile of 1 − SSIM over light directions
    Ssim,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ParametrizationArg {
    /// The mirror direction in the middle of every slice
    Corrected,
    /// Equation 3 of the paper as printed
    Eq3,
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
/// How far the file may be from the bytes asked for.
const BYTES_WITHIN: f64 = 0.01;
/// Times that sizes are corrected to come that near.
const CORRECTIONS: usize = 2;

/// An input, decoded, and its coarser levels.
struct Loaded {
    name: String,
    source: Btf,
    levels: usize,
}

impl Compress {
    pub(in crate::commands) fn run(self, out: &mut impl Write) -> anyhow::Result<ExitCode> {
        let start = Instant::now();
        if self.mode == ModeArg::Paper && self.ratio.is_some() {
            return Err(usage("--ratio: the paper's mode takes --epsilon and --budget"));
        }
        if self.mode != ModeArg::Paper && (self.epsilon.is_some() || self.measure.is_some()) {
            return Err(usage("--epsilon and --measure belong to --mode paper"));
        }
        let loaded = self.load()?;
        let grid =
            AngularGrid { parametrization: self.parametrization.into(), ..Default::default() };
        let levels: Vec<Mipped<'_>> = loaded
            .iter()
            .flat_map(|l| (0..l.levels).map(|level| Mipped::new(&l.source, level)))
            .collect();
        let resamplers: Vec<Resampler> = levels
            .iter()
            .map(|level| Resampler::new(level.layout(), grid))
            .collect::<Result<_, _>>()?;
        let finest = loaded.iter().flat_map(|l| (0..l.levels).map(move |level| (l, level)));
        let sets: Vec<TexelSet<'_>> = finest
            .zip(levels.iter().zip(&resamplers))
            .map(|((l, level), (mipped, resampler))| TexelSet {
                // The finest level is the source itself, which reads whole blocks.
                source: if level == 0 { &l.source } else { mipped },
                resampler,
            })
            .collect();
        let job = Job { args: &self, loaded: &loaded, sets: &sets };
        let (model, notes) = match self.mode {
            ModeArg::Refined => job.refined()?,
            ModeArg::Paper => job.paper()?,
            ModeArg::Lpca => job.lpca()?,
        };
        let file = btf_model_to_bytes(&model, &job.record())?;
        write_atomically(&self.output, &file, self.force.overwrite())?;
        let seconds = start.elapsed().as_secs_f64();
        self.report(&model, &job, file.len(), seconds, &notes, out)
    }

    fn load(&self) -> anyhow::Result<Vec<Loaded>> {
        let each = MemoryArgs { memory: self.memory.memory / self.inputs.len() };
        self.inputs
            .iter()
            .map(|path| {
                let name = path.file_stem().unwrap_or(path.as_os_str());
                for note in notes(&brdf_io::open_btf(path)?) {
                    writeln!(std::io::stderr(), "{}: {note}", path.display())?;
                }
                let source = load(path, each)?;
                let levels = if self.mipmaps { Mipped::count(source.layout()) } else { 1 };
                Ok(Loaded { name: name.to_string_lossy().into_owned(), source, levels })
            })
            .collect()
    }

    fn report(
        &self,
        model: &BtfModel,
        job: &Job<'_>,
        bytes: usize,
        seconds: f64,
        notes: &[String],
        out: &mut impl Write,
    ) -> anyhow::Result<ExitCode> {
        #[expect(clippy::cast_precision_loss, reason = "a ratio")]
        let ratio = job.raw_bytes() as f64 / bytes as f64;
        let streams = model.stream_bytes();
        let stored: usize = streams.iter().map(|s| s.1).sum();
        let books = match model {
            BtfModel::Vq(model) => json!(model.header().rows),
            BtfModel::Lpca(model) => {
                json!({ "clusters": model.header().clusters, "components": model.header().components })
            }
        };
        let peak = peak_memory();
        if self.json {
            let sizes: Map<String, Value> =
                streams.iter().map(|(name, n)| (name.clone(), json!(n))).collect();
            let report = json!({
                "output": self.output, "bytes": bytes, "header_bytes": bytes - stored,
                "raw_bytes": job.raw_bytes(), "ratio": ratio, "books": books,
                "stream_bytes": sizes, "seconds": seconds, "peak_memory": peak, "notes": notes,
            });
            writeln!(out, "{}", serde_json::to_string_pretty(&report)?)?;
        } else {
            writeln!(out, "{}", self.output.display())?;
            writeln!(
                out,
                "  {} (1:{ratio:.0}), in {} s",
                shown_bytes(bytes),
                significant(seconds)
            )?;
            writeln!(out, "  rows: {}", books.to_string().replace(['{', '}', '"'], ""))?;
            notes.iter().try_for_each(|note| writeln!(out, "  {note}"))?;
        }
        Ok(ExitCode::SUCCESS)
    }
}

impl From<ParametrizationArg> for LightParametrization {
    fn from(arg: ParametrizationArg) -> Self {
        match arg {
            ParametrizationArg::Corrected => Self::Corrected,
            ParametrizationArg::Eq3 => Self::Eq3,
        }
    }
}

/// What is compressed, and how.
struct Job<'a> {
    args: &'a Compress,
    loaded: &'a [Loaded],
    sets: &'a [TexelSet<'a>],
}

impl Job<'_> {
    fn layout(&self, at: usize) -> &BtfLayout {
        self.loaded[at].source.layout()
    }

    fn raw_bytes(&self) -> u64 {
        (0..self.loaded.len()).map(|at| self.layout(at).raw_bytes()).sum()
    }

    fn texels(&self) -> usize {
        self.sets.iter().map(TexelSet::len).sum()
    }

    /// Bytes of the file that the ratio asks for.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "a ratio of bytes"
    )]
    fn target(&self) -> u64 {
        (self.raw_bytes() as f64 / self.args.ratio.unwrap_or(RATIO)) as u64
    }

    fn epsilon(&self) -> f32 {
        #[expect(clippy::cast_possible_truncation, reason = "a threshold")]
        let given = self.args.epsilon.map(|e| e as f32);
        given.unwrap_or(if self.is_mse() { 0.004 } else { 0.4 })
    }

    fn is_mse(&self) -> bool {
        self.args.measure == Some(MeasureArg::Mse)
    }

    fn record(&self) -> BtfRecord {
        let (mode, is_paper) = match self.args.mode {
            ModeArg::Refined => ("refined", false),
            ModeArg::Paper => ("paper", true),
            ModeArg::Lpca => ("lpca", false),
        };
        let measure = if self.is_mse() { "mse" } else { "ssim" };
        BtfRecord {
            mode: mode.to_owned(),
            measure: is_paper.then(|| measure.to_owned()),
            epsilon: is_paper.then(|| self.epsilon()),
            raw_bytes: self.raw_bytes(),
        }
    }

    fn survey(&self, progress: &Progress) -> anyhow::Result<(Survey, Vec<String>)> {
        progress.step("resampling");
        let survey = Survey::of(self.sets, SurveyParams::default(), &|n| progress.done(n as u64))?;
        let mut notes = Vec::new();
        let filled: usize = self.sets.iter().map(|set| set.resampler.filled()).sum();
        if filled > 0 {
            notes.push(format!("{filled} pairs of view and light were interpolated"));
        }
        notes.push(format!(
            "{} nodes with luminance that interpolation made negative, set to 0",
            survey.clamped
        ));
        Ok((survey, notes))
    }

    fn refined(&self) -> anyhow::Result<(BtfModel, Vec<String>)> {
        let progress = Progress::new(3 * self.texels() as u64);
        let (survey, notes) = self.survey(&progress)?;
        let bits = ScaleBits::refined();
        let target = self.target();
        progress.step("choosing sizes");
        let mut sizes = choose_sizes(&survey, &bits, target)?;
        for correction in 0..=CORRECTIONS {
            progress.step("building books");
            let model = self.build(&survey, &sizes, bits)?;
            progress.done(self.texels() as u64);
            let bytes = btf_model_to_bytes(&model, &self.record())?.len();
            #[expect(clippy::cast_precision_loss, reason = "a ratio of bytes")]
            let excess = bytes as f64 / target as f64;
            if (excess - 1.0).abs() <= BYTES_WITHIN || correction == CORRECTIONS {
                return Ok((model, notes));
            }
            // P6 does not shrink with the books.
            let fixed = model.stream_bytes().iter().skip(8).map(|s| s.1).sum::<usize>();
            #[expect(clippy::cast_precision_loss, reason = "a ratio of bytes")]
            let share = (target as f64 - fixed as f64) / (bytes as f64 - fixed as f64);
            if share <= 0.0 {
                bail!("{target} bytes are too few; ask for a lower --ratio");
            }
            sizes = sizes.times(share);
        }
        bail!("no books of the size asked for")
    }

    fn build(
        &self,
        survey: &Survey,
        sizes: &BookSizes,
        bits: ScaleBits,
    ) -> anyhow::Result<BtfModel> {
        let encoded = encode_refined(survey, sizes);
        let mut textures = Vec::new();
        let mut first = 0;
        for set in self.sets {
            let range = first..first + set.len();
            first = range.end;
            let (index, scale) =
                (encoded.index[range.clone()].to_vec(), encoded.scale[range].to_vec());
            textures.push(IndexBook { len: 1, index, scale });
        }
        let mut books = encoded.books;
        let mut materials = self.materials(textures);
        books.normalise(&mut materials);
        Ok(BtfModel::Vq(VqModel::pack(&books, &materials, bits)?))
    }

    /// Textures of all levels, grouped by input.
    fn materials(&self, textures: Vec<IndexBook>) -> Vec<Material> {
        let mut textures = textures.into_iter();
        self.loaded
            .iter()
            .map(|loaded| {
                let layout = loaded.source.layout();
                Material {
                    name: loaded.name.clone(),
                    width: layout.width,
                    height: layout.height,
                    cosine_included: layout.cosine_included,
                    levels: textures.by_ref().take(loaded.levels).collect(),
                }
            })
            .collect()
    }

    fn paper(&self) -> anyhow::Result<(BtfModel, Vec<String>)> {
        let progress = Progress::new(2 * self.texels() as u64);
        progress.step("building books");
        let epsilon = self.epsilon();
        let measure = if self.is_mse() { Measure::Mse(epsilon) } else { Measure::Ssim(epsilon) };
        let params = PaperParams { measure, budget: self.args.budget };
        let (mut books, textures) = encode_paper(self.sets, &params, &|n| progress.done(n as u64))?;
        let mut materials = self.materials(textures);
        books.normalise(&mut materials);
        let bits = ScaleBits::paper(books.encoding);
        Ok((BtfModel::Vq(VqModel::pack(&books, &materials, bits)?), Vec::new()))
    }

    fn lpca(&self) -> anyhow::Result<(BtfModel, Vec<String>)> {
        let progress = Progress::new(2 * self.texels() as u64);
        let (survey, notes) = self.survey(&progress)?;
        progress.step("fitting components");
        let budget = usize::try_from(self.target())?;
        let fit = fit_lpca(&survey, budget, 1)?;
        let materials = self
            .loaded
            .iter()
            .map(|loaded| {
                let layout = loaded.source.layout();
                LpcaMaterial {
                    name: loaded.name.clone(),
                    width: layout.width,
                    height: layout.height,
                    cosine_included: layout.cosine_included,
                    levels: loaded.levels,
                }
            })
            .collect();
        Ok((BtfModel::Lpca(LpcaModel::pack(&survey, &fit, materials)?), notes))
    }
}
