//! `brdf btf study`.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::anyhow;
use brdf_io::{Btf, OutputFolder};
use brdf_plot::{Curves, Scale, Series, plot_curves};
use btf_vq::baselines::{Combinations, ViewPca};
use btf_vq::{
    BtfModel, BtfReader, BtfSource, Chroma, Codebooks, IndexCodebook, LpcaModel, Material, Measure,
    PaperParams, ProjectedTexels, ProjectionParams, ScaleBits, Taps, TexelSet, VqModel,
    choose_sizes, encode_paper, encode_refined, fit_lpca,
};
use clap::ValueEnum;

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
/// study.svg. Larger books take longer: with the defaults it is about half an hour for 256² texels.
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

    /// What is measured [default: everything]
    #[arg(long, value_enum, value_delimiter = ',')]
    methods: Vec<Method>,

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
    method: Method,
    bytes: usize,
    ratio: f64,
    #[serde(flatten)]
    fidelity: Fidelity,
}

/// What is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
enum Method {
    /// Refined codebooks
    Refined,
    /// As published, with a threshold of MSE
    Paper,
    /// Local principal components in bytes
    Lpca,
    /// The same in f32
    LpcaF32,
    /// One level of vector quantization
    OneLevel,
    /// Principal components of each view
    ViewPca,
}

impl Method {
    const ALL: [Self; 6] =
        [Self::Refined, Self::Paper, Self::Lpca, Self::LpcaF32, Self::OneLevel, Self::ViewPca];

    fn label(self) -> &'static str {
        match self {
            Self::Refined => "refined",
            Self::Paper => "paper, MSE",
            Self::Lpca => "LPCA, 8 bits",
            Self::LpcaF32 => "LPCA, f32",
            Self::OneLevel => "one-level VQ",
            Self::ViewPca => "PCA of each view",
        }
    }
}

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
            methods: if self.methods.is_empty() { &Method::ALL } else { &self.methods },
            progress: Progress::new(1),
        };
        let rows = inputs.with_sets(|sets| {
            let mut rows = bench.surveyed(sets, &self.ratios)?;
            if bench.wants(Method::Paper) {
                rows.extend(bench.paper(sets, &self.epsilons)?);
            }
            if bench.wants(Method::ViewPca) {
                rows.extend(bench.views(&self.components)?);
            }
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
                "{:18} {:>10}  1:{ratio:<6.0} PSNR {psnr} dB  MSSIM {mssim}",
                method.label(),
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
    methods: &'a [Method],
    progress: Progress,
}

impl Bench<'_> {
    fn wants(&self, method: Method) -> bool {
        self.methods.contains(&method)
    }

    fn row(
        &self,
        method: Method,
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
        method: Method,
        bytes: usize,
        decode: &(dyn Fn(usize, &mut [u8]) + Sync),
    ) -> anyhow::Result<Row> {
        let fidelity = compare(self.source, self.every, decode, &self.progress)?;
        let ratio = self.inputs.raw_bytes as f64 / bytes as f64;
        Ok(Row { method, bytes, ratio, fidelity })
    }

    fn model_row(&self, method: Method, model: &BtfModel) -> anyhow::Result<Row> {
        let bytes = model.stream_bytes().iter().map(|stream| stream.1).sum();
        let reader: BtfReader<'_> = model.reader(0).ok_or_else(|| anyhow!("no texture"))?;
        self.row(method, bytes, &|taps, texels| reader.image(0, taps, texels))
    }

    fn pack(
        &self,
        mut books: Codebooks,
        texture: IndexCodebook,
        bits: ScaleBits,
    ) -> anyhow::Result<BtfModel> {
        let mut materials =
            [Material { info: self.inputs.infos[0].clone(), levels: vec![texture] }];
        books.normalize(&mut materials);
        Ok(BtfModel::Vq(VqModel::pack(&books, &materials, bits)?))
    }

    /// What starts from a survey of the texels.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a ratio of bytes")]
    fn surveyed(&self, sets: &[TexelSet<'_>], ratios: &[f64]) -> anyhow::Result<Vec<Row>> {
        let of_survey = [Method::Refined, Method::Lpca, Method::LpcaF32, Method::OneLevel];
        if !of_survey.iter().any(|method| self.wants(*method)) {
            return Ok(Vec::new());
        }
        self.progress.step("resampling");
        let survey = ProjectedTexels::of(sets, ProjectionParams::default(), &|_| ())?;
        let mut rows = Vec::new();
        for ratio in ratios {
            self.progress.step(format!("1:{ratio}"));
            let bytes = (self.inputs.raw_bytes as f64 / ratio) as usize;
            for method in of_survey.into_iter().filter(|method| self.wants(*method)) {
                rows.extend(self.surveyed_row(&survey, method, bytes)?);
            }
        }
        Ok(rows)
    }

    /// A point of a method; none where the bytes do not hold even its least.
    fn surveyed_row(
        &self,
        survey: &ProjectedTexels,
        method: Method,
        bytes: usize,
    ) -> anyhow::Result<Option<Row>> {
        let row = match method {
            Method::Refined => {
                let bits = ScaleBits::refined(survey.encoding());
                let surveys = std::slice::from_ref(survey);
                let sizes = choose_sizes(surveys, &bits, bytes as u64)?;
                let empty = Codebooks::new(self.inputs.grid, survey.encoding(), Chroma::Relative);
                let encoded = encode_refined(surveys, &sizes, empty);
                let texture = IndexCodebook { len: 1, index: encoded.index, scale: encoded.scale };
                self.model_row(method, &self.pack(encoded.books, texture, bits)?)?
            }
            Method::Lpca => {
                let fit = fit_lpca(survey, bytes, 1)?;
                let model = LpcaModel::pack(survey, &fit, self.inputs.infos.clone())?;
                self.model_row(method, &BtfModel::Lpca(model))?
            }
            Method::LpcaF32 => {
                let Ok(fit) = fit_lpca(survey, bytes, 4) else { return Ok(None) };
                let texels = Combinations::of_lpca(survey, &fit);
                self.row(method, bytes, &|taps, out| texels.image(taps, out))?
            }
            _ => {
                let Ok(texels) = Combinations::one_level(survey, bytes) else { return Ok(None) };
                self.row(method, bytes, &|taps, out| texels.image(taps, out))?
            }
        };
        Ok(Some(row))
    }

    fn paper(&self, sets: &[TexelSet<'_>], epsilons: &[f64]) -> anyhow::Result<Vec<Row>> {
        let mut rows = Vec::new();
        for epsilon in epsilons {
            self.progress.step(format!("as published, {epsilon}"));
            #[expect(clippy::cast_possible_truncation, reason = "a threshold")]
            let params = PaperParams { measure: Measure::Mse(*epsilon as f32), budget: 0.012 };
            let empty = Codebooks::new(self.inputs.grid, sets[0].encoding(), Chroma::Absolute);
            let (books, textures) = encode_paper(sets, &params, empty, &|_| ())?;
            let bits = ScaleBits::paper(books.encoding);
            for texture in textures {
                rows.push(
                    self.model_row(Method::Paper, &self.pack(books.clone(), texture, bits)?)?,
                );
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
            rows.push(self.row_of(Method::ViewPca, ViewPca::bytes(layout, components), &decode)?);
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
        let method = method.label();
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
        series: Method::ALL
            .map(|method| {
                let points = rows.iter().filter(|row| row.method == method);
                let points = points.map(|r| ((r.bytes as f64).log10(), of(&r.fidelity)));
                let mut points: Vec<(f64, f64)> = points.collect();
                points.sort_by(|a, b| a.0.total_cmp(&b.0));
                Series::new(method.label(), points)
            })
            .into_iter()
            .filter(|series| !series.points.is_empty())
            .collect(),
    };
    let panels = [panel("PSNR", "dB", |f| f.psnr), panel("Mean SSIM", "MSSIM", |f| f.mssim)];
    Ok(plot_curves(&panels, 2)?)
}
