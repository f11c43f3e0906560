//! From textures to a compressed BTF, new or grown.

use brdf_job::Job;
use serde::{Deserialize, Serialize};

use crate::budget::choose_sizes;
use crate::codebooks::{Chroma, Codebooks, CompressedTexture, IndexCodebook};
use crate::error::VqError;
use crate::inputs::TextureInputs;
use crate::lpca::{LpcaModel, fit_lpca};
use crate::model::{ScaleBits, VqModel};
use crate::paper::{Measure, PaperParams, encode_paper};
use crate::projected_texels::{ProjectedTexels, ProjectionParams};
use crate::reader::BtfModel;
use crate::refined::{CodebookSizes, encode_refined};
use crate::source::Encoding;
use crate::texels::TexelSet;

/// The method by which a BTF is compressed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Mode {
    /// Nested codebooks whose rows are centres of clusters, with sizes chosen for a ratio.
    #[default]
    Refined,
    /// Nested codebooks whose rows are exemplars taken in Halton order, as published.
    Paper,
    /// Local principal components in bytes, the paper's rival.
    Lpca,
}

/// The similarity measure of [`Mode::Paper`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Similarity {
    /// Mean squared error.
    Mse,
    /// 98th percentile of 1 − SSIM over light directions.
    Ssim,
}

impl Similarity {
    /// Returns the default threshold: 0.004 for [`Similarity::Mse`], 0.4 for [`Similarity::Ssim`].
    pub fn usual_epsilon(self) -> f32 {
        match self {
            Self::Mse => 0.004,
            Self::Ssim => 0.4,
        }
    }

    /// Returns this measure with the threshold `epsilon`.
    pub fn measure(self, epsilon: f32) -> Measure {
        match self {
            Self::Mse => Measure::Mse(epsilon),
            Self::Ssim => Measure::Ssim(epsilon),
        }
    }
}

/// A record of how a compressed BTF was made, which is stored beside it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BtfRecord {
    /// Method of compression.
    pub mode: Mode,
    /// Similarity measure, in the paper's mode.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measure: Option<Similarity>,
    /// Threshold of the paper's mode.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub epsilon: Option<f32>,
    /// Bytes of the raw images, as the paper counts.
    pub raw_bytes: u64,
}

/// Options of [`compress`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompressSettings {
    /// Method of compression.
    pub mode: Mode,
    /// Raw bytes over bytes of the file, above 0; not used by the paper's mode.
    pub ratio: f64,
    /// Similarity measure of the paper's mode; `None` takes that of the books that grow, or SSIM.
    pub similarity: Option<Similarity>,
    /// Threshold of the paper's mode; `None` takes that of the books that grow, or [`Similarity::usual_epsilon`].
    pub epsilon: Option<f32>,
    /// Most rows of P4 in the paper's mode, as a share of the texels.
    pub budget: f64,
}

impl Default for CompressSettings {
    fn default() -> Self {
        Self { mode: Mode::Refined, ratio: 700.0, similarity: None, epsilon: None, budget: 0.012 }
    }
}

/// A compressed BTF that more textures are added to.
#[derive(Clone, Debug)]
pub struct Base {
    /// Codebooks of the model.
    pub books: Codebooks,
    /// Textures of the model.
    pub textures: Vec<CompressedTexture>,
    /// Record of how it was made.
    pub made: BtfRecord,
    /// Bytes of the model's file.
    pub bytes: usize,
}

/// Counts of what resampling changed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ResamplingCounts {
    /// Pairs of view and light that were interpolated.
    pub interpolated: usize,
    /// Nodes with luminance that interpolation made negative, set to 0.
    pub clamped: u64,
}

/// The result of [`compress`]: the model, how it was made, and what was changed on the way.
#[derive(Clone, Debug)]
pub struct Compressed {
    /// The model.
    pub model: BtfModel,
    /// Record of how it was made, to be stored beside it.
    pub record: BtfRecord,
    /// Counts of what resampling changed.
    pub resampling: ResamplingCounts,
}

/// Shares of the bytes asked for between which a file need not be made again.
const NEAR_ENOUGH: std::ops::RangeInclusive<f64> = 0.97..=1.01;

/// A function that returns the number of bytes that a model takes as a file.
pub type FileBytes<'a> = dyn Fn(&BtfModel, &BtfRecord) -> usize + Sync + 'a;

/// Compresses textures, into new codebooks or into those of `base`.
///
/// Rows that `base` has stay as they are and serve where they fit, and the ratio is that of the new textures to the
/// bytes that they add. The same inputs and settings give the same model on any number of threads.
///
/// ```
/// use brdf_job::Job;
/// use brdf_model::{Brdf, Preset};
/// use btf_vq::{CompressSettings, GridChoice, TextureInputs, compress};
///
/// let plastic = Preset::find("plastic").expect("a built-in material").brdf();
/// let grid = GridChoice { nodes: Some([21, 21, 11, 1]), ..GridChoice::default() };
/// let brdfs = [("plastic".to_owned(), &plastic as &dyn Brdf)];
/// let (inputs, _) = TextureInputs::brdfs(&brdfs, grid, &Job::new())?;
///
/// let settings = CompressSettings { ratio: 10_000.0, ..CompressSettings::default() };
/// let size = |model: &btf_vq::BtfModel, _: &btf_vq::BtfRecord| {
///     model.stream_bytes().iter().map(|(_, bytes)| bytes).sum()
/// };
/// let compressed = compress(&inputs, &settings, None, &size, &Job::new())?;
/// assert_eq!(compressed.model.textures()[0].name, "plastic");
/// # Ok::<(), btf_vq::VqError>(())
/// ```
///
/// # Errors
///
/// [`VqError`]: sources that cannot be read, textures that cannot share codebooks, a ratio that nothing reaches;
/// [`VqError::Stopped`].
pub fn compress(
    inputs: &TextureInputs<'_>,
    settings: &CompressSettings,
    base: Option<&Base>,
    file_bytes: &FileBytes<'_>,
    job: &Job<'_>,
) -> Result<Compressed, VqError> {
    let work = Work { inputs, settings, base, file_bytes };
    inputs.with_sets(|sets| {
        if let Some(base) = base {
            work.check_kind(base, sets)?;
        }
        let (model, resampling) = match settings.mode {
            Mode::Refined => work.refined(sets, job)?,
            Mode::Paper => (work.paper(sets, job)?, ResamplingCounts::default()),
            Mode::Lpca => work.lpca(sets, job)?,
        };
        Ok(Compressed { model, record: work.record(), resampling })
    })
}

/// Packs codebooks and one row of P6 for each texel into a model of one texture or more.
pub(crate) fn pack(
    mut books: Codebooks,
    mut textures: Vec<CompressedTexture>,
    bits: ScaleBits,
) -> Result<BtfModel, VqError> {
    books.normalize(&mut textures);
    Ok(BtfModel::Vq(VqModel::pack(&books, &textures, bits)?))
}

/// What is compressed, and how.
struct Work<'a> {
    inputs: &'a TextureInputs<'a>,
    settings: &'a CompressSettings,
    base: Option<&'a Base>,
    file_bytes: &'a FileBytes<'a>,
}

impl Work<'_> {
    /// Refuses textures that a base cannot hold.
    fn check_kind(&self, base: &Base, sets: &[TexelSet<'_>]) -> Result<(), VqError> {
        let mut names = base.textures.iter().map(|texture| &texture.info.name);
        if let Some(name) =
            names.find(|name| self.inputs.infos.iter().any(|info| info.name == **name))
        {
            return Err(VqError::NameTaken { name: name.clone() });
        }
        match sets.iter().find(|set| set.encoding() != base.books.encoding) {
            Some(set) => Err(VqError::Mixed {
                what: "encodings",
                found: format!("{:?}", set.encoding()),
                expected: format!("{:?}", base.books.encoding),
            }),
            None => Ok(()),
        }
    }

    /// Bytes of the file that the ratio asks for.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a ratio of bytes")]
    fn target(&self) -> u64 {
        (self.inputs.raw_bytes as f64 / self.settings.ratio) as u64
    }

    /// What is similar enough in the paper's mode.
    fn similarity(&self) -> (Similarity, f32) {
        let made = self.base.map(|base| &base.made);
        let similarity = self
            .settings
            .similarity
            .or_else(|| made.and_then(|made| made.measure))
            .unwrap_or(Similarity::Ssim);
        let is_chosen = self.settings.similarity.is_some();
        let earlier = made.filter(|_| !is_chosen).and_then(|made| made.epsilon);
        let epsilon = self.settings.epsilon.or(earlier);
        (similarity, epsilon.unwrap_or_else(|| similarity.usual_epsilon()))
    }

    fn record(&self) -> BtfRecord {
        let (measure, epsilon) = match (self.settings.mode, self.similarity()) {
            (Mode::Paper, (similarity, epsilon)) => (Some(similarity), Some(epsilon)),
            _ => (None, None),
        };
        BtfRecord {
            mode: self.settings.mode,
            measure,
            epsilon,
            raw_bytes: self.inputs.raw_bytes + self.base.map_or(0, |base| base.made.raw_bytes),
        }
    }

    /// The books to begin with.
    fn books(&self, encoding: Encoding, chroma: Chroma) -> Codebooks {
        let grown = self.base.map(|base| base.books.clone());
        grown.unwrap_or_else(|| Codebooks::new(self.inputs.grid, encoding, chroma))
    }

    /// All textures, from a row of P6 for each texel of the new ones.
    fn textures(&self, rows: &IndexCodebook) -> Vec<CompressedTexture> {
        let mut textures = self.base.map_or_else(Vec::new, |base| base.textures.clone());
        let mut first = 0;
        for info in &self.inputs.infos {
            let levels = info.level_lens().map(|texels| {
                let range = first..first + texels;
                first = range.end;
                let (index, scale) = (&rows.index[range.clone()], &rows.scale[range]);
                IndexCodebook { len: 1, index: index.to_vec(), scale: scale.to_vec() }
            });
            let levels = levels.collect();
            textures.push(CompressedTexture { info: info.clone(), levels });
        }
        textures
    }

    fn refined(
        &self,
        sets: &[TexelSet<'_>],
        job: &Job<'_>,
    ) -> Result<(BtfModel, ResamplingCounts), VqError> {
        TexelSet::check_alike(sets)?;
        let [resampling, sizing, building, again] = job.split([1.0, 0.7, 2.0, 2.0]);
        let textures: Vec<&[TexelSet<'_>]> = self.inputs.by_texture(sets).collect();
        let jobs = resampling.split_into(&vec![1.0; textures.len()]);
        let surveys = textures
            .iter()
            .zip(&jobs)
            .map(|(sets, job)| ProjectedTexels::of(sets, ProjectionParams::default(), job))
            .collect::<Result<Vec<_>, _>>()?;
        let counts = resampling_counts(sets, &surveys);
        let bits = ScaleBits::refined(sets[0].encoding());
        let sizes = choose_sizes(&surveys, &bits, self.target(), &sizing)?;
        let model = self.build(&surveys, &sizes, bits, &building)?;
        let bytes = (self.file_bytes)(&model, &self.record());
        let before = self.base.map_or(0, |base| base.bytes);
        let target = usize::try_from(self.target()).unwrap_or(usize::MAX).saturating_add(before);
        let of_target = |bytes: usize| bytes as f64 / target as f64;
        // Where every slice of a BRDF has a row of its own, there is nothing to grow.
        let is_full = self.inputs.grid.phis == 1 && bytes <= target;
        if is_full || NEAR_ENOUGH.contains(&of_target(bytes)) {
            return Ok((model, counts));
        }
        // P6 does not shrink with the books, nor does what was there before.
        let textures = model.stream_bytes().into_iter().skip(8);
        let fixed = before.max(textures.map(|stream| stream.1).sum());
        if target <= fixed || bytes <= fixed {
            return Err(VqError::Budget {
                bytes: target as u64,
                what: "these textures".to_owned(),
                least: fixed as u64,
            });
        }
        let share = (target - fixed) as f64 / (bytes - fixed) as f64;
        Ok((self.build(&surveys, &sizes.times(share), bits, &again)?, counts))
    }

    fn build(
        &self,
        surveys: &[ProjectedTexels],
        sizes: &CodebookSizes,
        bits: ScaleBits,
        job: &Job<'_>,
    ) -> Result<BtfModel, VqError> {
        let books = self.books(surveys[0].encoding(), Chroma::Relative);
        let encoded = encode_refined(surveys, sizes, books, job)?;
        let rows = IndexCodebook { len: 1, index: encoded.index, scale: encoded.scale };
        pack(encoded.books, self.textures(&rows), bits)
    }

    fn paper(&self, sets: &[TexelSet<'_>], job: &Job<'_>) -> Result<BtfModel, VqError> {
        let (similarity, epsilon) = self.similarity();
        let params =
            PaperParams { measure: similarity.measure(epsilon), budget: self.settings.budget };
        let empty = self.books(sets[0].encoding(), Chroma::Absolute);
        let (books, textures) = encode_paper(sets, &params, empty, job)?;
        let mut rows = IndexCodebook { len: 1, ..IndexCodebook::default() };
        for texture in textures {
            rows.index.extend(texture.index);
            rows.scale.extend(texture.scale);
        }
        let bits = ScaleBits::paper(books.encoding);
        pack(books, self.textures(&rows), bits)
    }

    fn lpca(
        &self,
        sets: &[TexelSet<'_>],
        job: &Job<'_>,
    ) -> Result<(BtfModel, ResamplingCounts), VqError> {
        let [resampling, fitting] = job.split([1.0, 1.0]);
        let survey = ProjectedTexels::of(sets, ProjectionParams::default(), &resampling)?;
        let counts = resampling_counts(sets, std::slice::from_ref(&survey));
        let target = usize::try_from(self.target()).unwrap_or(usize::MAX);
        let fit = fit_lpca(&survey, target, 1, &fitting)?;
        let model = LpcaModel::pack(&survey, &fit, self.inputs.infos.clone())?;
        Ok((BtfModel::Lpca(model), counts))
    }
}

fn resampling_counts(sets: &[TexelSet<'_>], surveys: &[ProjectedTexels]) -> ResamplingCounts {
    ResamplingCounts {
        interpolated: sets.iter().map(TexelSet::filled).sum(),
        clamped: surveys.iter().map(|survey| survey.clamped).sum(),
    }
}
