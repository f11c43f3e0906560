//! `brdf btf study`.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::anyhow;
use brdf_io::{Btf, OutputFolder};
use brdf_plot::{Curves, Scale, Series, plot_curves};
use btf_vq::baselines::{Combinations, ViewPca};
use btf_vq::{
    Books, BtfModel, BtfReader, BtfSource, Chroma, IndexBook, LpcaModel, Material, Measure,
    PaperParams, ScaleBits, Survey, SurveyParams, Taps, TexelSet, VqModel, choose_sizes,
    encode_paper, encode_refined, fit_lpca,
};

use super::fidelity::{Fidelity, all_taps, compare, to_bytes};
use super::inputs::{GridChoice, Inputs};
use super::loading::MemoryArgs;
use crate::args::positive;
use crate::numbers::{bytes as shown_bytes, significant};
use crate::progress::Progress;

/// Measure what compression loses at which size, beside its rivals
///
/// Compresses a BTF to several ratios by refined codebooks, by local principal components in bytes and in
/// f32 and by one level of vector quantization; as published with several thresholds of MSE; and by
/// principal components of each view. Bytes are those of books, bases and texels without headers. f32
/// rivals and those of a view are not rounded: no storage of them does better. Writes study.csv and
/// study.svg.
///
/// Example: brdf btf study wool -o wool-study
#[derive(clap::Args)]
pub(in crate::commands) struct Study {
    /// BTF
    #[arg(value_name = "IN")]
    input: PathBuf,

    /// Folder to write; one that brdf wrote is replaced
    #[arg(short, long, value_name = "FOLDER", default_value = "btf-study")]
    output: PathBuf,

    /// Write into a folder that holds other files
    #[arg(long)]
    force: bool,

    /// Raw bytes over bytes
    #[arg(long, value_delimiter = ',', value_parser = positive, default_values_t = [2000.0, 764.0, 300.0])]
    ratios: Vec<f64>,

    /// Thresholds of the paper's mode
    #[arg(long, value_delimiter = ',', value_parser = positive, default_values_t = [0.012, 0.004, 0.001])]
    epsilons: Vec<f64>,

    /// Components of each view
    #[arg(long, value_delimiter = ',', default_values_t = [1, 2])]
    components: Vec<usize>,

    /// Every how many images are compared
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..), default_value_t = 7)]
    every: u32,

    #[command(flatten)]
    memory: MemoryArgs,

    /// Print the rows as JSON
    #[arg(long)]
    json: bool,
}

/// One point.
#[derive(Clone, Debug, serde::Serialize)]
struct Row {
    method: &'static str,
    bytes: usize,
    ratio: f64,
    #[serde(flatten)]
    fidelity: Fidelity,
}

const REFINED: &str = "refined";
const PAPER: &str = "paper, MSE";
const LPCA: &str = "LPCA, 8 bits";
const LPCA_F32: &str = "LPCA, f32";
const ONE_LEVEL: &str = "one-level VQ";
const VIEW_PCA: &str = "PCA of each view";

impl Study {
    pub(in crate::commands) fn run(self, out: &mut impl Write) -> anyhow::Result<ExitCode> {
        let mut folder = OutputFolder::new(&self.output, self.force)?;
        let grid =
            GridChoice { nodes: None, parametrization: btf_vq::LightParametrization::default() };
        let inputs = Inputs::open(std::slice::from_ref(&self.input), grid, false, self.memory)?;
        let source = inputs
            .only_images()
            .ok_or_else(|| anyhow!("{}: expected the images of a BTF", self.input.display()))?;
        let bench = Bench {
            inputs: &inputs,
            source,
            taps: all_taps(source, &inputs.grid),
            every: self.every as usize,
            progress: Progress::new(1),
        };
        let rows = inputs.with_sets(|sets| {
            let mut rows = bench.codebooks(sets, &self.ratios)?;
            rows.extend(bench.paper(sets, &self.epsilons)?);
            rows.extend(bench.views(&self.components)?);
            Ok(rows)
        })?;
        drop(bench);
        folder.write("study.csv", csv(&rows).as_bytes())?;
        folder.write("study.svg", plot(&rows)?.svg().as_bytes())?;
        let place = folder.finish()?;
        if self.json {
            writeln!(out, "{}", serde_json::to_string_pretty(&rows)?)?;
            return Ok(ExitCode::SUCCESS);
        }
        for Row { method, bytes, ratio, fidelity } in &rows {
            let (psnr, mssim) = (significant(fidelity.psnr), significant(fidelity.mssim));
            writeln!(
                out,
                "{method:18} {:>10}  1:{ratio:<6.0} PSNR {psnr} dB  MSSIM {mssim}",
                shown_bytes(*bytes)
            )?;
        }
        writeln!(out, "{}", place.join("study.svg").display())?;
        Ok(ExitCode::SUCCESS)
    }
}

/// A BTF and how points are measured.
struct Bench<'a> {
    inputs: &'a Inputs,
    source: &'a Btf,
    taps: Vec<Taps>,
    every: usize,
    progress: Progress,
}

impl Bench<'_> {
    fn row(
        &self,
        method: &'static str,
        bytes: usize,
        image: &(dyn Fn(&Taps, &mut [[f32; 3]]) + Sync),
    ) -> anyhow::Result<Row> {
        let layout = self.source.layout();
        let decode = |at: usize, rgb: &mut [u8]| {
            let mut texels = vec![[0.0; 3]; layout.texel_count()];
            image(&self.taps[at], &mut texels);
            to_bytes(&texels, layout.encoding, rgb);
        };
        self.row_of(method, bytes, &decode)
    }

    fn row_of(
        &self,
        method: &'static str,
        bytes: usize,
        decode: &(dyn Fn(usize, &mut [u8]) + Sync),
    ) -> anyhow::Result<Row> {
        let fidelity = compare(self.source, self.every, decode, &self.progress)?;
        #[expect(clippy::cast_precision_loss, reason = "a ratio")]
        let ratio = self.inputs.raw_bytes as f64 / bytes as f64;
        Ok(Row { method, bytes, ratio, fidelity })
    }

    fn model_row(&self, method: &'static str, model: &BtfModel) -> anyhow::Result<Row> {
        let bytes = model.stream_bytes().iter().map(|stream| stream.1).sum();
        let reader: BtfReader<'_> = model.reader(0).ok_or_else(|| anyhow!("no texture"))?;
        self.row(method, bytes, &|taps, texels| reader.image(0, taps, texels))
    }

    fn pack(
        &self,
        mut books: Books,
        texture: IndexBook,
        bits: ScaleBits,
    ) -> anyhow::Result<BtfModel> {
        let mut materials =
            [Material { info: self.inputs.infos[0].clone(), levels: vec![texture] }];
        books.normalise(&mut materials);
        Ok(BtfModel::Vq(VqModel::pack(&books, &materials, bits)?))
    }

    /// All that a survey of the texels serves.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "a ratio of bytes"
    )]
    fn codebooks(&self, sets: &[TexelSet<'_>], ratios: &[f64]) -> anyhow::Result<Vec<Row>> {
        self.progress.step("resampling");
        let survey = Survey::of(sets, SurveyParams::default(), &|_| ())?;
        let mut rows = Vec::new();
        for ratio in ratios {
            self.progress.step(format!("1:{ratio}"));
            let bytes = (self.inputs.raw_bytes as f64 / ratio) as usize;
            let bits = ScaleBits::refined(survey.encoding());
            let sizes = choose_sizes(&survey, &bits, bytes as u64)?;
            let empty = Books::new(self.inputs.grid, survey.encoding(), Chroma::Relative);
            let encoded = encode_refined(&survey, &sizes, empty);
            let texture = IndexBook { len: 1, index: encoded.index, scale: encoded.scale };
            rows.push(self.model_row(REFINED, &self.pack(encoded.books, texture, bits)?)?);

            let fit = fit_lpca(&survey, bytes, 1)?;
            let model = LpcaModel::pack(&survey, &fit, self.inputs.infos.clone())?;
            rows.push(self.model_row(LPCA, &BtfModel::Lpca(model))?);
            // What does not fit has no point.
            if let Ok(fit) = fit_lpca(&survey, bytes, 4) {
                let texels = Combinations::of_lpca(&survey, &fit);
                rows.push(self.row(LPCA_F32, bytes, &|taps, out| texels.image(taps, out))?);
            }
            if let Ok(texels) = Combinations::one_level(&survey, bytes) {
                rows.push(self.row(ONE_LEVEL, bytes, &|taps, out| texels.image(taps, out))?);
            }
        }
        Ok(rows)
    }

    fn paper(&self, sets: &[TexelSet<'_>], epsilons: &[f64]) -> anyhow::Result<Vec<Row>> {
        let mut rows = Vec::new();
        for epsilon in epsilons {
            self.progress.step(format!("as published, {epsilon}"));
            #[expect(clippy::cast_possible_truncation, reason = "a threshold")]
            let params = PaperParams { measure: Measure::Mse(*epsilon as f32), budget: 0.012 };
            let empty = Books::new(self.inputs.grid, sets[0].encoding(), Chroma::Absolute);
            let (books, textures) = encode_paper(sets, &params, empty, &|_| ())?;
            let bits = ScaleBits::paper(books.encoding);
            for texture in textures {
                rows.push(self.model_row(PAPER, &self.pack(books.clone(), texture, bits)?)?);
            }
        }
        Ok(rows)
    }

    fn views(&self, components: &[usize]) -> anyhow::Result<Vec<Row>> {
        let layout = self.source.layout();
        let mut rows = Vec::new();
        for &components in components {
            self.progress.step(format!("components of each view, {components}"));
            let fit = ViewPca::fit(self.source, components)?;
            let images = self.view_pca_images(&fit)?;
            let decode = |at: usize, rgb: &mut [u8]| rgb.copy_from_slice(&images[at / self.every]);
            rows.push(self.row_of(VIEW_PCA, ViewPca::bytes(layout, components), &decode)?);
        }
        Ok(rows)
    }

    /// The images that are compared, in bytes.
    fn view_pca_images(&self, fit: &ViewPca) -> anyhow::Result<Vec<Vec<u8>>> {
        let layout = self.source.layout();
        let mut images = Vec::new();
        let mut first = 0;
        for (view, lights) in layout.views.iter().map(|view| view.lights.len()).enumerate() {
            let values = fit.view(self.source, view)?;
            for (at, image) in values.chunks_exact(3 * layout.texel_count()).enumerate() {
                if (first + at) % self.every == 0 {
                    let mut rgb = vec![0; image.len()];
                    to_bytes(image.as_chunks().0, layout.encoding, &mut rgb);
                    images.push(rgb);
                }
            }
            first += lights;
        }
        Ok(images)
    }
}

fn csv(rows: &[Row]) -> String {
    let mut text = String::from("method,bytes,ratio,psnr_db,mssim\n");
    for Row { method, bytes, ratio, fidelity: Fidelity { psnr, mssim } } in rows {
        text.push_str(&format!("\"{method}\",{bytes},{ratio:.1},{psnr:.3},{mssim:.4}\n"));
    }
    text
}

/// Both measures over bytes.
fn plot(rows: &[Row]) -> anyhow::Result<brdf_plot::Plot> {
    let panel = |title: &str, y: &str, of: fn(&Fidelity) -> f64| Curves {
        title: title.to_owned(),
        x: "log10 of bytes".to_owned(),
        y: y.to_owned(),
        y_scale: Scale::Linear,
        series: [REFINED, PAPER, LPCA, LPCA_F32, ONE_LEVEL, VIEW_PCA]
            .map(|method| {
                let points = rows.iter().filter(|row| row.method == method);
                #[expect(clippy::cast_precision_loss, reason = "a place on an axis")]
                let points = points.map(|r| ((r.bytes as f64).log10(), of(&r.fidelity)));
                let mut points: Vec<(f64, f64)> = points.collect();
                points.sort_by(|a, b| a.0.total_cmp(&b.0));
                Series::new(method, points)
            })
            .into_iter()
            .filter(|series| !series.points.is_empty())
            .collect(),
    };
    let panels = [panel("PSNR", "dB", |f| f.psnr), panel("Mean SSIM", "MSSIM", |f| f.mssim)];
    Ok(plot_curves(&panels, 2)?)
}
