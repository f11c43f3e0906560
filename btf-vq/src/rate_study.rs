//! What compression loses at which size, beside its rivals.

use brdf_job::Job;
use serde::{Deserialize, Serialize};

use crate::baselines::{Combinations, ViewPca};
use crate::budget::choose_sizes;
use crate::codebooks::{Chroma, Codebooks, CompressedTexture, IndexCodebook};
use crate::compress::pack;
use crate::decode::Taps;
use crate::error::VqError;
use crate::fidelity::{Fidelity, compare_images, image_taps, to_bytes};
use crate::inputs::{GridChoice, TextureInputs};
use crate::lpca::{LpcaModel, fit_lpca};
use crate::model::ScaleBits;
use crate::paper::{Measure, PaperParams, encode_paper};
use crate::projected_texels::{ProjectedTexels, ProjectionParams};
use crate::reader::BtfModel;
use crate::refined::encode_refined;
use crate::source::BtfSource;
use crate::texels::TexelSet;

/// A method of compression whose loss is measured at several sizes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum RateMethod {
    /// Refined codebooks.
    Refined,
    /// Codebooks as published, with a threshold of MSE.
    Paper,
    /// Local principal components in bytes.
    Lpca,
    /// Local principal components in `f32`.
    LpcaF32,
    /// One level of vector quantization.
    OneLevel,
    /// Principal components of each view.
    ViewPca,
}

impl RateMethod {
    /// All methods.
    pub const ALL: [Self; 6] =
        [Self::Refined, Self::Paper, Self::Lpca, Self::LpcaF32, Self::OneLevel, Self::ViewPca];

    /// Returns the name of the method in tables and plots.
    pub fn label(self) -> &'static str {
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

/// The points that [`study_rates`] measures.
#[derive(Clone, Debug, PartialEq)]
pub struct RateSettings {
    /// Methods to measure.
    pub methods: Vec<RateMethod>,
    /// Ratios of raw bytes to bytes at which methods with a choice of size are measured.
    pub ratios: Vec<f64>,
    /// Thresholds of the paper's mode.
    pub epsilons: Vec<f64>,
    /// Numbers of components at which principal components of each view are measured.
    pub components: Vec<usize>,
    /// Every how many images are compared, 1 or more.
    pub every: usize,
}

impl Default for RateSettings {
    fn default() -> Self {
        Self {
            methods: RateMethod::ALL.to_vec(),
            ratios: vec![2000.0, 764.0, 300.0],
            epsilons: vec![0.012, 0.004, 0.001],
            components: vec![1, 2],
            every: 7,
        }
    }
}

/// One measured point: a method, its size and its fidelity.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RateRow {
    /// Method of compression.
    pub method: RateMethod,
    /// Bytes of books, bases and texels, without headers.
    pub bytes: usize,
    /// Raw bytes over these.
    pub ratio: f64,
    /// Fidelity of its images.
    #[serde(flatten)]
    pub fidelity: Fidelity,
}

/// Compresses a BTF by every method to several sizes and measures what is lost. Rivals in `f32` and those of single
/// views are not rounded: no storage of them does better.
///
/// # Errors
///
/// [`VqError`]; [`VqError::Stopped`].
pub fn study_rates(
    name: &str,
    source: &dyn BtfSource,
    settings: &RateSettings,
    job: &Job<'_>,
) -> Result<Vec<RateRow>, VqError> {
    let inputs =
        TextureInputs::images(vec![(name.to_owned(), source)], GridChoice::default(), false);
    let bench = Bench { inputs: &inputs, source, taps: image_taps(source, &inputs.grid), settings };
    let [surveyed, paper, views] = job.split([2.0, 4.0, 1.0]);
    inputs.with_sets(|sets| {
        let mut rows = bench.surveyed(sets, &surveyed)?;
        if bench.wants(RateMethod::Paper) {
            rows.extend(bench.paper(sets, &paper)?);
        }
        if bench.wants(RateMethod::ViewPca) {
            rows.extend(bench.views(&views)?);
        }
        Ok(rows)
    })
}

/// A BTF and how points are measured.
struct Bench<'a> {
    inputs: &'a TextureInputs<'a>,
    source: &'a dyn BtfSource,
    taps: Vec<Taps>,
    settings: &'a RateSettings,
}

impl Bench<'_> {
    fn wants(&self, method: RateMethod) -> bool {
        self.settings.methods.contains(&method)
    }

    fn row(
        &self,
        method: RateMethod,
        bytes: usize,
        image: &(dyn Fn(&Taps, &mut [[f32; 3]]) + Sync),
        job: &Job<'_>,
    ) -> Result<RateRow, VqError> {
        let layout = self.source.layout();
        let decode = |at: usize, rgb: &mut [u8]| {
            let mut texels = vec![[0.0; 3]; layout.texel_count()];
            image(&self.taps[at], &mut texels);
            to_bytes(&texels, layout.encoding, rgb);
        };
        self.row_of(method, bytes, &decode, job)
    }

    fn row_of(
        &self,
        method: RateMethod,
        bytes: usize,
        decode: &(dyn Fn(usize, &mut [u8]) + Sync),
        job: &Job<'_>,
    ) -> Result<RateRow, VqError> {
        let fidelity = compare_images(self.source, self.settings.every, decode, job)?;
        let ratio = self.inputs.raw_bytes as f64 / bytes as f64;
        Ok(RateRow { method, bytes, ratio, fidelity })
    }

    fn model_row(
        &self,
        method: RateMethod,
        model: &BtfModel,
        job: &Job<'_>,
    ) -> Result<RateRow, VqError> {
        let bytes = model.stream_bytes().iter().map(|stream| stream.1).sum();
        let reader = model.reader(0).ok_or_else(|| VqError::NoTexture { name: "1".to_owned() })?;
        self.row(method, bytes, &|taps, texels| reader.image(0, taps, texels), job)
    }

    fn packed(
        &self,
        books: Codebooks,
        texture: IndexCodebook,
        bits: ScaleBits,
    ) -> Result<BtfModel, VqError> {
        let info = self.inputs.infos[0].clone();
        pack(books, vec![CompressedTexture { info, levels: vec![texture] }], bits)
    }

    /// What starts from projected texels.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a ratio of bytes")]
    fn surveyed(&self, sets: &[TexelSet<'_>], job: &Job<'_>) -> Result<Vec<RateRow>, VqError> {
        let of_survey =
            [RateMethod::Refined, RateMethod::Lpca, RateMethod::LpcaF32, RateMethod::OneLevel];
        let methods: Vec<RateMethod> =
            of_survey.into_iter().filter(|method| self.wants(*method)).collect();
        if methods.is_empty() {
            return Ok(Vec::new());
        }
        let ratios = &self.settings.ratios;
        let jobs = job.split_into(&vec![1.0; 1 + ratios.len() * methods.len()]);
        let survey = ProjectedTexels::of(sets, ProjectionParams::default(), &jobs[0])?;
        let mut rows = Vec::new();
        let points =
            ratios.iter().flat_map(|ratio| methods.iter().map(move |method| (ratio, *method)));
        for ((ratio, method), job) in points.zip(&jobs[1..]) {
            let bytes = (self.inputs.raw_bytes as f64 / ratio) as usize;
            rows.extend(self.surveyed_row(&survey, method, bytes, job)?);
        }
        Ok(rows)
    }

    /// A point of a method; none where the bytes do not hold even its least.
    fn surveyed_row(
        &self,
        survey: &ProjectedTexels,
        method: RateMethod,
        bytes: usize,
        job: &Job<'_>,
    ) -> Result<Option<RateRow>, VqError> {
        let [sizing, fitting, comparing] = job.split([0.5, 2.0, 1.0]);
        let row = match method {
            RateMethod::Refined => {
                let bits = ScaleBits::refined(survey.encoding());
                let surveys = std::slice::from_ref(survey);
                let sizes = choose_sizes(surveys, &bits, bytes as u64, &sizing)?;
                let empty = Codebooks::new(self.inputs.grid, survey.encoding(), Chroma::Relative);
                let encoded = encode_refined(surveys, &sizes, empty, &fitting)?;
                let texture = IndexCodebook { len: 1, index: encoded.index, scale: encoded.scale };
                self.model_row(method, &self.packed(encoded.books, texture, bits)?, &comparing)?
            }
            RateMethod::Lpca => {
                let fit = fit_lpca(survey, bytes, 1, &fitting)?;
                let model = LpcaModel::pack(survey, &fit, self.inputs.infos.clone())?;
                self.model_row(method, &BtfModel::Lpca(model), &comparing)?
            }
            RateMethod::LpcaF32 => {
                let fit = match fit_lpca(survey, bytes, 4, &fitting) {
                    Err(VqError::Budget { .. }) => return Ok(None),
                    fit => fit?,
                };
                let texels = Combinations::of_lpca(survey, &fit);
                self.row(method, bytes, &|taps, out| texels.image(taps, out), &comparing)?
            }
            _ => {
                let Ok(texels) = Combinations::one_level(survey, bytes) else { return Ok(None) };
                self.row(method, bytes, &|taps, out| texels.image(taps, out), &comparing)?
            }
        };
        Ok(Some(row))
    }

    fn paper(&self, sets: &[TexelSet<'_>], job: &Job<'_>) -> Result<Vec<RateRow>, VqError> {
        let epsilons = &self.settings.epsilons;
        let mut rows = Vec::new();
        for (epsilon, job) in epsilons.iter().zip(&job.split_into(&vec![1.0; epsilons.len()])) {
            let [encoding, comparing] = job.split([3.0, 1.0]);
            #[expect(clippy::cast_possible_truncation, reason = "a threshold")]
            let params = PaperParams { measure: Measure::Mse(*epsilon as f32), budget: 0.012 };
            let empty = Codebooks::new(self.inputs.grid, sets[0].encoding(), Chroma::Absolute);
            let (books, textures) = encode_paper(sets, &params, empty, &encoding)?;
            let bits = ScaleBits::paper(books.encoding);
            for texture in textures {
                let model = self.packed(books.clone(), texture, bits)?;
                rows.push(self.model_row(RateMethod::Paper, &model, &comparing)?);
            }
        }
        Ok(rows)
    }

    fn views(&self, job: &Job<'_>) -> Result<Vec<RateRow>, VqError> {
        let (layout, every) = (self.source.layout(), self.settings.every);
        let components = &self.settings.components;
        let mut rows = Vec::new();
        for (&components, job) in
            components.iter().zip(&job.split_into(&vec![1.0; components.len()]))
        {
            job.check()?;
            let fit = ViewPca::fit(self.source, components)?;
            let images = self.view_pca_images(&fit)?;
            let decode = |at: usize, rgb: &mut [u8]| rgb.copy_from_slice(&images[at / every]);
            let bytes = ViewPca::bytes(layout, components);
            rows.push(self.row_of(RateMethod::ViewPca, bytes, &decode, job)?);
        }
        Ok(rows)
    }

    /// The images that are compared, in bytes.
    fn view_pca_images(&self, fit: &ViewPca) -> Result<Vec<Vec<u8>>, VqError> {
        let layout = self.source.layout();
        let mut images = Vec::new();
        let mut first = 0;
        for (view, lights) in layout.views.iter().map(|view| view.lights.len()).enumerate() {
            let values = fit.view(self.source, view)?;
            for (at, image) in values.chunks_exact(3 * layout.texel_count()).enumerate() {
                if (first + at) % self.settings.every == 0 {
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
