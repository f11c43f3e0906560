//! Compression of bidirectional texture functions (BTFs; nothing to do with the BPF Type Format).
//!
//! A BTF is a set of images of a material, one for each pair of view and light: gigabytes of them. Here it becomes about a
//! megabyte of nested codebooks. Any texel can be read for any light and view without unpacking the rest, and light
//! directions can be drawn by importance.
//!
//! - [`TextureInputs`] holds what is to be compressed: images from a [`BtfSource`], or BRDFs as textures of one texel.
//! - [`compress()`] makes a [`BtfModel`], or adds textures to one. [`Mode`] chooses between the refined encoder, the paper's,
//!   and local principal components, the rival that the paper compares with.
//! - [`BtfReader`] reads texels and images and draws lights; [`TexturedBtf`] shows the texture on objects.
//! - [`compare_texture`] and [`compare_brdfs`] measure what was lost; [`study_rates`] compares methods at several sizes.
//!
//! The steps can also be taken one by one: a [`Resampler`] brings images to the nodes of an [`AngularGrid`],
//! [`encode_refined`] or [`encode_paper`] makes [`Codebooks`], and [`VqModel`] holds them packed.
//!
//! Source: V. Havran, J. Filip and K. Myszkowski, "Bidirectional Texture Function Compression Based
//! on Multi-Level Vector Quantization", Computer Graphics Forum 29(1), 2010.
//!
//! ```
//! use btf_vq::BtfModel;
//! use glam::DVec3;
//!
//! /// Linear radiance of a texel under a light of irradiance π; 1 for a white diffuser facing it.
//! fn radiance(model: &BtfModel, x: usize, y: usize, wi: DVec3, wo: DVec3) -> Option<[f32; 3]> {
//!     let reader = model.reader(0)?;
//!     let (width, _) = reader.size(0);
//!     let taps = reader.taps(wi, wo); // once for a pair of directions, for any number of texels
//!     Some(reader.linear(0, y * width + x, &taps))
//! }
//! ```
//!
//! Models are stored as plain safetensors: `docs/btf.md` of the project reads a file with NumPy.

pub mod baselines;
mod bits;
mod brdfs;
mod budget;
mod cluster;
mod codebooks;
pub mod colour;
mod compress;
mod decode;
mod draws;
mod error;
mod fidelity;
mod grid;
mod inputs;
mod lpca;
mod mip;
mod model;
mod nearest;
mod paper;
mod projected_texels;
mod quantize;
mod rate_study;
mod rbf;
mod reader;
mod refined;
mod resample;
mod sample;
mod source;
mod ssim;
mod subspace;
mod texels;
mod textured;

pub use bits::index_bits;
pub use brdfs::{RAW_BRDF_BYTES, RadianceBrdf, Tabulated, tabulate};
pub use budget::{choose_sizes, stream_bytes};
pub use codebooks::{
    Chroma, Codebooks, CompressedTexture, IndexCodebook, TextureInfo, ValueBook, level_size,
};
pub use compress::{
    Base, BtfRecord, CompressSettings, Compressed, FileBytes, Mode, ResamplingCounts, Similarity,
    compress,
};
pub use decode::{Decoder, Taps};
pub use draws::{DrawParams, DrawnLight, draw_lights};
pub use error::{SourceError, VqError};
pub use fidelity::{
    BrdfFidelity, Fidelity, compare_brdfs, compare_texture, image_taps, resampling_floor,
};
pub use grid::{AngularGrid, LightParametrization, LightTaps, Pair, ViewTaps};
pub use inputs::{GridChoice, TextureInputs};
pub use lpca::{LocalPca, LpcaDecoder, LpcaHeader, LpcaModel, Steps, fit_lpca, lpca_bytes};
pub use mip::Mipped;
pub use model::{BookRows, Header, ScaleBits, SharedBytes, TextureHeader, VqModel};
pub use nearest::{CodeSet, Match};
pub use paper::{Measure, PaperParams, encode_paper};
pub use projected_texels::{ProjectedTexels, ProjectionParams};
pub use quantize::{Quantizer, Spacing};
pub use rate_study::{RateMethod, RateRow, RateSettings, study_rates};
pub use reader::{BtfModel, BtfReader};
pub use refined::{CodebookSizes, Encoded, LevelErrors, encode_refined};
pub use resample::Resampler;
pub use sample::{LightQuery, LightSampler, SampledLight};
pub use source::{BtfLayout, BtfSource, BtfView, Encoding, TEXEL_BLOCK};
pub use texels::{NodeTable, TexelSet};
pub use textured::TexturedBtf;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDocTests;
