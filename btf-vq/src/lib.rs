//! Bidirectional *texture* functions (not BPF Type Format) in nested codebooks.

mod bits;
mod books;
mod budget;
mod cluster;
pub mod colour;
mod decode;
mod error;
mod grid;
mod lpca;
mod mip;
mod model;
mod nearest;
mod paper;
mod quantise;
mod rbf;
mod reader;
mod refined;
mod resample;
mod sample;
mod source;
mod ssim;
mod subspace;
mod survey;

pub use bits::index_bits;
pub use books::{Books, Chroma, IndexBook, Material, ValueBook, level_size};
pub use budget::{choose_sizes, stream_bytes};
pub use decode::{Decoder, Taps};
pub use error::VqError;
pub use grid::{AngularGrid, LightParametrization, LightTaps, Pair, ViewTaps};
pub use lpca::{
    LocalPca, LpcaDecoder, LpcaHeader, LpcaMaterial, LpcaModel, Steps, fit_lpca, lpca_bytes,
};
pub use mip::Mipped;
pub use model::{Header, MaterialHeader, Rows, ScaleBits, SharedBytes, VqModel};
pub use nearest::{CodeSet, Match};
pub use paper::{Measure, PaperParams, encode_paper};
pub use quantise::{Law, Quantiser};
pub use reader::{BtfModel, BtfReader, TextureInfo};
pub use refined::{BookSizes, Encoded, LevelErrors, encode_refined};
pub use resample::{BLOCK, Resampler};
pub use sample::{LightSampler, SampledLight};
pub use source::{BtfLayout, BtfSource, Encoding, SourceError, View};
pub use survey::{Survey, SurveyParams, TexelSet};
