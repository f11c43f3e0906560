//! The native container of factored models: safetensors with one JSON record.
//!
//! Tensors `factor0`, `factor1` … hold log texels in f32: `[v, u, channel]` for two-dimensional
//! factors, `[x, channel]` for one-dimensional ones. The metadata key `brdf` holds the record: how
//! coordinates reach texels, the log maps, the options and the errors of the fit. No time, path or
//! thread count, so that equal runs give equal bytes.

use std::collections::HashMap;

use brdf_factor::{ChannelMap, Factor, FactorDescription, FactorParams, FactoredBrdf};
use brdf_model::{Dropped, FitErrors};
use safetensors::SafeTensors;
use safetensors::tensor::{Dtype, TensorView};
use serde::{Deserialize, Serialize};

use crate::FormatError;

const KEY: &str = "brdf";
const KIND: &str = "factored";
const VERSION: u32 = 1;

/// A model and the record of how it was made.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelFile {
    /// The model.
    pub model: FactoredBrdf,
    /// How it was made.
    pub fit: FitRecord,
}

/// How a model was made and how good it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FitRecord {
    /// `mccool`, `radial` or `projections`.
    pub method: String,
    /// What was fitted: a preset, or the name of a file without its folder.
    pub input: String,
    /// Space of the projections.
    pub space: String,
    /// Options.
    pub settings: FitSettings,
    /// Errors for each number of terms.
    pub terms: Vec<TermRecord>,
    /// Samples fitted, after replication.
    pub samples_used: usize,
    /// Samples left out.
    pub dropped: Dropped,
}

/// Options that decide a fit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FitSettings {
    /// Of the fit itself.
    pub params: FactorParams,
    /// Whether light and viewer share textures.
    pub reciprocal: bool,
    /// Pairs asked for; scattered rows come as they are.
    pub samples: u32,
    /// Which scramble.
    pub seed: u64,
    /// Copies of scattered rows by rotation.
    pub replicate: u32,
}

/// Errors of the model with a number of terms.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TermRecord {
    /// Textures of the model.
    pub textures: usize,
    /// Over the training samples.
    #[serde(flatten)]
    pub training: FitErrors,
    /// Over samples that were not fitted; none where there were too few.
    pub held_out: Option<FitErrors>,
}

#[derive(Serialize, Deserialize)]
struct Record {
    kind: String,
    version: u32,
    theta_max: f64,
    maps: Vec<ChannelMap>,
    factors: Vec<FactorDescription>,
    fit: FitRecord,
}

/// The JSON record of a model, as its file holds it.
///
/// # Errors
///
/// [`FormatError::Library`] if the record cannot be written.
pub fn record_of(file: &ModelFile) -> Result<String, FormatError> {
    let model = &file.model;
    let record = Record {
        kind: KIND.to_owned(),
        version: VERSION,
        theta_max: model.theta_max(),
        maps: model.maps().to_vec(),
        factors: model.factors().iter().map(|f| f.description().clone()).collect(),
        fit: file.fit.clone(),
    };
    serde_json::to_string(&record).map_err(|e| library("model record", &e))
}

/// The bytes of a model's file.
///
/// # Errors
///
/// [`FormatError::Library`] if they cannot be put together.
pub fn model_to_bytes(file: &ModelFile) -> Result<Vec<u8>, FormatError> {
    let channels = file.model.maps().len();
    let tensors: Vec<(String, Vec<usize>, Vec<u8>)> = file
        .model
        .factors()
        .iter()
        .enumerate()
        .map(|(index, factor)| {
            let shape = tensor_shape(factor.description(), channels);
            let bytes = factor.texels().iter().flat_map(|texel| &texel[..channels]);
            (tensor_name(index), shape, bytes.flat_map(|v| v.to_le_bytes()).collect())
        })
        .collect();
    let views: Result<Vec<(&str, TensorView<'_>)>, FormatError> = tensors
        .iter()
        .map(|(name, shape, bytes)| {
            let view = TensorView::new(Dtype::F32, shape.clone(), bytes);
            Ok((name.as_str(), view.map_err(|e| library("safetensors", &e))?))
        })
        .collect();
    let metadata = HashMap::from([(KEY.to_owned(), record_of(file)?)]);
    safetensors::serialize(views?, Some(metadata)).map_err(|e| library("safetensors", &e))
}

/// Reads a model.
///
/// # Errors
///
/// [`FormatError`] for anything that is not a whole and consistent model.
pub fn read_model(bytes: &[u8]) -> Result<ModelFile, FormatError> {
    let (_, metadata) =
        SafeTensors::read_metadata(bytes).map_err(|e| library("safetensors", &e))?;
    let record = metadata.metadata().as_ref().and_then(|m| m.get(KEY)).ok_or_else(|| {
        FormatError::Missing {
            what: format!("metadata key {KEY:?}"),
            expected: "a safetensors file written by brdf".to_owned(),
        }
    })?;
    let record: Record = serde_json::from_str(record).map_err(|e| library("model record", &e))?;
    if record.kind != KIND || record.version != VERSION {
        return Err(FormatError::Missing {
            what: format!("model that can be read ({} version {})", record.kind, record.version),
            expected: format!("{KIND} version {VERSION}"),
        });
    }
    let tensors = SafeTensors::deserialize(bytes).map_err(|e| library("safetensors", &e))?;
    let channels = record.maps.len();
    let factors: Result<Vec<Factor>, FormatError> = record
        .factors
        .into_iter()
        .enumerate()
        .map(|(index, description)| {
            description.check()?;
            let name = tensor_name(index);
            let view = tensors.tensor(&name).map_err(|e| library("safetensors", &e))?;
            let expected = tensor_shape(&description, channels);
            if view.dtype() != Dtype::F32 || view.shape() != expected {
                return Err(FormatError::Missing {
                    what: format!(
                        "tensor {name} in f32 of shape {expected:?} ({:?} {:?})",
                        view.dtype(),
                        view.shape()
                    ),
                    expected: "what the record describes".to_owned(),
                });
            }
            Ok(Factor::new(description, Some(texels(view.data(), channels)))?)
        })
        .collect();
    let model = FactoredBrdf::new(factors?, record.maps, record.theta_max)?;
    Ok(ModelFile { model, fit: record.fit })
}

fn tensor_name(index: usize) -> String {
    format!("factor{index}")
}

fn tensor_shape(description: &FactorDescription, channels: usize) -> Vec<usize> {
    let size = description.grid.size;
    if description.grid.dimensions == 1 { vec![size, channels] } else { vec![size, size, channels] }
}

fn texels(bytes: &[u8], channels: usize) -> Vec<[f32; 4]> {
    crate::bytes::f32_values(bytes)
        .chunks_exact(channels.clamp(1, 4))
        .map(|values| std::array::from_fn(|c| values.get(c).copied().unwrap_or(0.0)))
        .collect()
}

fn library(what: &'static str, problem: &dyn std::fmt::Display) -> FormatError {
    FormatError::Library { what, problem: problem.to_string() }
}
