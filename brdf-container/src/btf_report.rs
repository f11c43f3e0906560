//! What compressed BTFs hold, and what compressing them came to.

use std::collections::BTreeMap;

use btf_vq::{
    BookRows, BrdfFidelity, BtfModel, Compressed, Encoding, Fidelity, LightParametrization, Mode,
    RAW_BRDF_BYTES,
};
use serde::Serialize;

use crate::btf::CompressedBtf;

/// What a compression came to.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CompressReport {
    /// The file that was written.
    pub output: String,
    /// Bytes of the file.
    pub bytes: usize,
    /// Bytes of it that are no codebooks.
    pub header_bytes: usize,
    /// Bytes of the raw images, or tables, as the paper counts.
    pub raw_bytes: u64,
    /// Raw bytes over bytes of the file.
    pub ratio: f64,
    /// Sizes of the codebooks.
    pub books: BookSizes,
    /// Bytes of each stream.
    pub stream_bytes: BTreeMap<String, usize>,
    /// Time it took.
    pub seconds: f64,
    /// Most memory that the process had in use, bytes, where the system says.
    pub peak_memory: Option<u64>,
    /// What a reader should know, in sentences.
    pub notes: Vec<String>,
}

/// Sizes of codebooks.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(untagged)]
pub enum BookSizes {
    /// Rows of nested codebooks.
    Rows(BookRows),
    /// Of local principal components.
    Components {
        /// Number of clusters.
        clusters: usize,
        /// Components of each.
        components: usize,
    },
}

impl BookSizes {
    fn of(model: &BtfModel) -> Self {
        match model {
            BtfModel::Vq(model) => Self::Rows(model.header().rows),
            BtfModel::Lpca(model) => Self::Components {
                clusters: model.header().clusters,
                components: model.header().components,
            },
        }
    }
}

impl CompressReport {
    /// Returns the report of a model that takes `bytes` in the file `output` and took so many seconds.
    pub fn new(compressed: &Compressed, output: &str, bytes: usize, seconds: f64) -> Self {
        let streams = compressed.model.stream_bytes();
        let stored: usize = streams.iter().map(|stream| stream.1).sum();
        let raw_bytes = compressed.record.raw_bytes;
        let mut notes = Vec::new();
        let counts = compressed.resampling;
        if counts.interpolated > 0 {
            notes
                .push(format!("{} pairs of view and light were interpolated", counts.interpolated));
        }
        if counts.clamped > 0 {
            notes.push(format!(
                "{} nodes with luminance that interpolation made negative, set to 0",
                counts.clamped
            ));
        }
        Self {
            output: output.to_owned(),
            bytes,
            header_bytes: bytes - stored,
            raw_bytes,
            ratio: raw_bytes as f64 / bytes as f64,
            books: BookSizes::of(&compressed.model),
            stream_bytes: streams.into_iter().collect(),
            seconds,
            peak_memory: None,
            notes,
        }
    }
}

/// What a compressed BTF holds.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CompressedBtfInfo {
    /// `compressed BTF`.
    pub kind: &'static str,
    /// How it was compressed.
    pub mode: Mode,
    /// Bytes of the file.
    pub bytes: usize,
    /// Bytes of it that are no codebooks.
    pub header_bytes: usize,
    /// Raw bytes over bytes of the file.
    pub ratio: f64,
    /// What values are: `sRGB, 8 bits` or `linear radiance`.
    pub encoding: &'static str,
    /// How lights are laid out.
    pub parametrization: LightParametrization,
    /// Nodes of the grid of directions, in words.
    pub nodes: String,
    /// The textures.
    pub textures: Vec<TextureSummary>,
    /// Name and size of each stream.
    pub streams: Vec<String>,
    /// Rows of nested codebooks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rows: Option<BookRows>,
}

/// A texture of a compressed BTF.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TextureSummary {
    /// Its name.
    pub name: String,
    /// Texels in a row.
    pub width: usize,
    /// Rows of texels.
    pub height: usize,
    /// Resolutions that are stored.
    pub levels: usize,
}

impl CompressedBtf {
    /// Returns what the file holds. `size_in_words` says how many bytes a stream takes.
    pub fn info(&self, size_in_words: impl Fn(usize) -> String) -> CompressedBtfInfo {
        let streams = self.model.stream_bytes();
        let stored: usize = streams.iter().map(|stream| stream.1).sum();
        let (grid, values) = match &self.model {
            BtfModel::Vq(model) => (model.header().grid, model.header().encoding),
            BtfModel::Lpca(model) => (model.header().grid, model.header().encoding),
        };
        let textures = self.model.textures().into_iter().map(|texture| TextureSummary {
            name: texture.name,
            width: texture.width,
            height: texture.height,
            levels: texture.levels,
        });
        let stream = |(name, bytes): &(String, usize)| format!("{name} {}", size_in_words(*bytes));
        CompressedBtfInfo {
            kind: "compressed BTF",
            mode: self.made.mode,
            bytes: self.bytes,
            header_bytes: self.bytes - stored,
            ratio: self.made.raw_bytes as f64 / self.bytes as f64,
            encoding: match values {
                Encoding::Srgb => "sRGB, 8 bits",
                Encoding::Linear => "linear radiance",
            },
            parametrization: grid.parametrization,
            nodes: format!(
                "{} alpha, {} beta, {} theta, {} phi",
                grid.alphas, grid.betas, grid.thetas, grid.phis
            ),
            textures: textures.collect(),
            streams: streams.iter().map(stream).collect(),
            rows: match &self.model {
                BtfModel::Vq(model) => Some(model.header().rows),
                BtfModel::Lpca(_) => None,
            },
        }
    }
}

/// How near a compressed BTF is to its images.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TextureComparison {
    /// The images.
    pub input: String,
    /// The file of the compressed BTF.
    pub model: String,
    /// Of the decoded images.
    #[serde(flatten)]
    pub fidelity: Fidelity,
    /// Of the resampling alone, where it was asked for.
    pub floor: Option<Fidelity>,
    /// Bytes of the compressed BTF's file.
    pub bytes: usize,
    /// Raw bytes of these images over those of the file.
    pub ratio: f64,
}

/// How near compressed BRDFs are to the originals.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BrdfComparison {
    /// The BRDFs.
    pub input: String,
    /// The file of the compressed BTF.
    pub model: String,
    /// Root mean square error, mean over BRDFs, sr⁻¹.
    pub rms: f64,
    /// The same over the root mean square of each BRDF.
    pub relative: f64,
    /// Relative error on the grid, not compressed, where it was asked for.
    pub floor: Option<f64>,
    /// Bytes of the compressed BTF's file.
    pub bytes: usize,
    /// Raw bytes of these BRDFs over those of the file.
    pub ratio: f64,
    /// One for each.
    pub brdfs: Vec<BrdfFidelity>,
}

impl BrdfComparison {
    /// Returns the comparison of BRDFs of an input with a model's file of so many bytes.
    pub fn new(input: &str, model: &str, brdfs: Vec<BrdfFidelity>, bytes: usize) -> Self {
        let mean = |values: Vec<f64>| values.iter().sum::<f64>() / values.len().max(1) as f64;
        let floors: Option<Vec<f64>> = brdfs.iter().map(|brdf| brdf.floor).collect();
        Self {
            input: input.to_owned(),
            model: model.to_owned(),
            rms: mean(brdfs.iter().map(|brdf| brdf.rms).collect()),
            relative: mean(brdfs.iter().map(|brdf| brdf.relative).collect()),
            floor: floors.map(mean),
            bytes,
            ratio: (RAW_BRDF_BYTES * brdfs.len() as u64) as f64 / bytes as f64,
            brdfs,
        }
    }
}
