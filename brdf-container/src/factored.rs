//! The native container: safetensors with one JSON record under the metadata key `brdf`.
//!
//! A factored model: tensors `factor0`, `factor1` … hold log texels in f32: `[v, u, channel]` for two-dimensional
//! factors, `[x, channel]` for one-dimensional ones; the record says how coordinates reach texels,
//! and holds the log maps, the options and the errors of the fit. No time, path or thread count, so
//! that equal runs give equal bytes. The best models of fewer textures follow as `of1.factor0`,
//! `of2.factor0`, `of2.factor1` …
//!
//! A sum of products: `first` and `second`, f32 `[row, column, term, channel]` over the texels of
//! their charts, `first` with one channel where its textures are scalar; where both sides share
//! textures, `signs`, f32 `[term, channel]`, in place of `second`.
//!
//! A painted material: tensors `product0.factor0` … of the factors of each product, as of a factored model,
//! `product0.surface`, `[v, u, channel]`, and `map0`, `[v, u]`, where it has them, all f32.
//!
//! A preinverted matrix: `cholesky`, f64 `[column, row]`, or `vectors`, f64 `[component, unknown]`, and `weights`.
//!
//! Transport of an object: for each part `part0.positions`, `part0.normals` (f32), `part0.triangles` (u32), `part0.light` and
//! `part0.view`, f32 `[row, column, value]`, and the arrays of [`brdf_relight::SparseTransport`]: `part0.scales` (f32),
//! `part0.offsets` (u32), `part0.owners` (u16) and `part0.codes` (u32, or u16 where light maps are scalar).
//!
//! A compressed BTF: packed books as tensors of bytes.
//!
//! A MERL-grid table: one tensor `cells`, f32 `[theta_h, theta_d, phi_d, channel]`, negative where
//! invalid. Scattered samples: `directions`, f64 `[sample, 6]` (wi, then wo), and `values`, f64
//! `[sample, channel]`.

use std::collections::HashMap;

use brdf_factor::{ChannelTransform, Factor, FactorDescription, FactorParams, FactoredBrdf};
use brdf_model::{Channels, Dropped, FitErrors, MerlLookup, MerlTable, SampleSet};
use brdf_param::{DirectionPair, Projection};
use brdf_search::Objective;
use glam::DVec3;
use safetensors::SafeTensors;
use safetensors::tensor::{Dtype, TensorView};
use serde::{Deserialize, Serialize};

mod basis;
mod btf;
mod painted;
mod relight;
mod separable;

pub use basis::{BasisFile, BasisRecord, basis_to_bytes, parse_basis};
pub use btf::{BtfModelFile, BtfRecord, btf_model_to_bytes, open_btf_model, parse_btf_model};
pub use painted::{PaintRecord, PaintedFile, painted_to_bytes, parse_painted};
pub use relight::{
    RelightFile, RelightRecord, chunk_from_bytes, chunk_to_bytes, parse_relight, relight_to_bytes,
};
pub use separable::{
    RankRecord, SeparableFile, SeparableRecord, SeparableSettings, separable_to_bytes,
};

use crate::FormatError;
use crate::bytes::{f32_values, f64_values};

const KEY: &str = "brdf";
const VERSION: u32 = 1;

/// What a container holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Kind {
    Factored,
    Separable,
    Transport,
    MerlTable,
    Samples,
    BtfVq,
    BtfLpca,
    Painted,
    Basis,
}

/// The part of the record that every kind has.
#[derive(Serialize, Deserialize)]
struct Head {
    kind: Kind,
    version: u32,
}

/// The content of a container.
#[derive(Clone, Debug, PartialEq)]
pub enum Contained {
    /// A factored model.
    Model(Box<ModelFile>),
    /// A sum of products.
    Separable(Box<SeparableFile>),
    /// A table on the MERL grid.
    Table(MerlTable),
    /// Scattered samples.
    Samples(SampleSet),
}

/// A model and the record of how it was made.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelFile {
    /// The model.
    pub model: FactoredBrdf,
    /// The best models of fewer textures, smallest first, with the same maps and grazing limit.
    pub smaller: Vec<FactoredBrdf>,
    /// How it was made.
    pub fit: FitRecord,
}

impl ModelFile {
    /// The file with the model of `textures` textures in place of the largest, and those below it;
    /// `None` where there is none.
    pub fn keep(mut self, textures: usize) -> Option<Self> {
        let count = |model: &FactoredBrdf| model.factors().len();
        if count(&self.model) != textures {
            let at = self.smaller.iter().position(|model| count(model) == textures)?;
            self.smaller.truncate(at + 1);
            self.model = self.smaller.pop()?;
        }
        self.fit.terms.retain(|term| term.textures <= textures);
        Some(self)
    }
}

/// How a model was made and how good it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FitRecord {
    /// `search`, `mccool`, `radial` or `projections`.
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
    /// How projections were searched, if they were.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub search: Option<SearchSettings>,
}

/// Options that decide a search.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SearchSettings {
    /// `joint` or `powell`.
    pub strategy: String,
    /// What a Powell search minimized.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub objective: Option<Objective>,
    /// Largest number of projections asked for.
    pub terms: usize,
    /// Random starts.
    pub restarts: usize,
    /// Planes to start from.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub start: Vec<Projection>,
}

/// Errors of the model with a number of terms.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TermRecord {
    /// Textures of the model.
    pub textures: usize,
    /// Its projections, for each factor that has one; conjugates are left out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub projections: Vec<Projection>,
    /// Over the training samples.
    #[serde(flatten)]
    pub training: FitErrors,
    /// Over samples that were not fitted; none where there were too few.
    pub held_out: Option<FitErrors>,
}

#[derive(Serialize, Deserialize)]
struct Record {
    #[serde(flatten)]
    head: Head,
    theta_max: f64,
    maps: Vec<ChannelTransform>,
    factors: Vec<FactorDescription>,
    /// Of the models of fewer textures.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    smaller: Vec<Vec<FactorDescription>>,
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
        head: Head { kind: Kind::Factored, version: VERSION },
        theta_max: model.theta_max(),
        maps: model.maps().to_vec(),
        factors: descriptions(model),
        smaller: file.smaller.iter().map(descriptions).collect(),
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
    let smaller = file.smaller.iter().map(|model| (Some(model.factors().len()), model));
    let tensors: Vec<(String, Vec<usize>, Vec<u8>)> = std::iter::once((None, &file.model))
        .chain(smaller)
        .flat_map(|(part, model)| model.factors().iter().enumerate().map(move |f| (part, f)))
        .map(|(part, (index, factor))| {
            let shape = tensor_shape(factor.description(), channels);
            let bytes = factor.texels().iter().flat_map(|texel| &texel[..channels]);
            (tensor_name(part, index), shape, bytes.flat_map(|v| v.to_le_bytes()).collect())
        })
        .collect();
    let tensors = tensors
        .iter()
        .map(|(name, shape, bytes)| (name.as_str(), Dtype::F32, shape.clone(), bytes.as_slice()));
    serialize(tensors, record_of(file)?)
}

/// The bytes of a table's file.
///
/// # Errors
///
/// [`FormatError::Library`] if they cannot be put together.
pub fn table_to_bytes(table: &MerlTable) -> Result<Vec<u8>, FormatError> {
    let bytes: Vec<u8> = table.cells().iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
    serialize([("cells", Dtype::F32, TABLE_SHAPE.to_vec(), &bytes[..])], head(Kind::MerlTable)?)
}

/// The bytes of a file of samples.
///
/// # Errors
///
/// [`FormatError::Library`] if they cannot be put together.
pub fn samples_to_bytes(samples: &SampleSet) -> Result<Vec<u8>, FormatError> {
    let directions: Vec<u8> = samples
        .pairs()
        .flat_map(|pair| [pair.wi.to_array(), pair.wo.to_array()])
        .flatten()
        .flat_map(f64::to_le_bytes)
        .collect();
    let values: Vec<u8> = (0..samples.len())
        .flat_map(|i| samples.values().iter().map(move |channel| channel[i]))
        .flat_map(f64::to_le_bytes)
        .collect();
    let tensors = [
        ("directions", Dtype::F64, vec![samples.len(), 6], &directions[..]),
        ("values", Dtype::F64, vec![samples.len(), samples.values().len()], &values[..]),
    ];
    serialize(tensors, head(Kind::Samples)?)
}

fn head(kind: Kind) -> Result<String, FormatError> {
    serde_json::to_string(&Head { kind, version: VERSION }).map_err(|e| library("record", &e))
}

fn serialize<'a>(
    tensors: impl IntoIterator<Item = (&'a str, Dtype, Vec<usize>, &'a [u8])>,
    record: String,
) -> Result<Vec<u8>, FormatError> {
    let views: Result<Vec<(&str, TensorView<'_>)>, FormatError> = tensors
        .into_iter()
        .map(|(name, kind, shape, bytes)| {
            let view = TensorView::new(kind, shape, bytes);
            Ok((name, view.map_err(|e| library("safetensors", &e))?))
        })
        .collect();
    let metadata = HashMap::from([(KEY.to_owned(), record)]);
    safetensors::serialize(views?, Some(metadata)).map_err(|e| library("safetensors", &e))
}

const TABLE_SHAPE: [usize; 4] = [MerlTable::THETA_H, MerlTable::THETA_D, MerlTable::PHI_D, 3];

/// Reads a container of any kind; tables are read with this lookup.
///
/// # Errors
///
/// [`FormatError`] for anything that is not whole and consistent.
pub fn read_container(bytes: &[u8], lookup: MerlLookup) -> Result<Contained, FormatError> {
    let (head, record) = read_head(bytes)?;
    let record = record.as_str();
    let tensors = SafeTensors::deserialize(bytes).map_err(|e| library("safetensors", &e))?;
    Ok(match head.kind {
        Kind::Factored => Contained::Model(Box::new(read_factored(record, &tensors)?)),
        Kind::Separable => Contained::Separable(Box::new(separable::read(record, &tensors)?)),
        Kind::MerlTable => Contained::Table(read_cells(&tensors, lookup)?),
        Kind::Samples => Contained::Samples(read_samples(&tensors)?),
        Kind::Painted => {
            return Err(FormatError::Missing {
                what: "BRDF: this is a painted material, which varies over a surface".to_owned(),
                expected: "`brdf paint preview` for it".to_owned(),
            });
        }
        Kind::Transport => {
            return Err(FormatError::Missing {
                what: "BRDF: this is the transport of an object".to_owned(),
                expected: "one of the commands of `brdf relight` for it".to_owned(),
            });
        }
        Kind::Basis => {
            return Err(FormatError::Missing {
                what: "BRDF: this is a preinverted matrix".to_owned(),
                expected: "`brdf factor MODEL --with` for it".to_owned(),
            });
        }
        Kind::BtfVq | Kind::BtfLpca => {
            return Err(FormatError::Missing {
                what: "BRDF: this is a compressed BTF".to_owned(),
                expected: "one of the commands of `brdf btf` for it".to_owned(),
            });
        }
    })
}

/// What kind of container this is, and its record.
fn read_head(bytes: &[u8]) -> Result<(Head, String), FormatError> {
    let (_, metadata) =
        SafeTensors::read_metadata(bytes).map_err(|e| library("safetensors", &e))?;
    let record = metadata.metadata().as_ref().and_then(|m| m.get(KEY)).ok_or_else(|| {
        FormatError::Missing {
            what: format!("metadata key {KEY:?}"),
            expected: "a safetensors file written by brdf".to_owned(),
        }
    })?;
    let head: Head = serde_json::from_str(record).map_err(|e| library("record", &e))?;
    if head.version != VERSION {
        return Err(FormatError::Missing {
            what: format!("version that can be read ({})", head.version),
            expected: format!("version {VERSION}"),
        });
    }
    Ok((head, record.clone()))
}

fn read_factored(record: &str, tensors: &SafeTensors<'_>) -> Result<ModelFile, FormatError> {
    let record: Record = serde_json::from_str(record).map_err(|e| library("model record", &e))?;
    let channels = record.maps.len();
    let model = |part: Option<usize>, descriptions: Vec<FactorDescription>| {
        let name = |index: usize| tensor_name(part, index);
        let factors = read_factors(tensors, descriptions, channels, name)?;
        Ok::<_, FormatError>(FactoredBrdf::new(factors, record.maps.clone(), record.theta_max)?)
    };
    let smaller = record.smaller.into_iter().map(|part| model(Some(part.len()), part));
    Ok(ModelFile {
        smaller: smaller.collect::<Result<_, _>>()?,
        model: model(None, record.factors)?,
        fit: record.fit,
    })
}

/// Factors with their texels.
fn read_factors(
    tensors: &SafeTensors<'_>,
    descriptions: Vec<FactorDescription>,
    channels: usize,
    name: impl Fn(usize) -> String,
) -> Result<Vec<Factor>, FormatError> {
    let described = descriptions.into_iter().enumerate().map(|(index, description)| {
        description.check()?;
        let shape = tensor_shape(&description, channels);
        let data = tensor(tensors, &name(index), Dtype::F32, &shape)?;
        Ok(Factor::new(description, Some(texels(data, channels)))?)
    });
    described.collect()
}

fn read_cells(tensors: &SafeTensors<'_>, lookup: MerlLookup) -> Result<MerlTable, FormatError> {
    let data = tensor(tensors, "cells", Dtype::F32, &TABLE_SHAPE)?;
    Ok(MerlTable::new(f32_values(data).as_chunks::<3>().0.iter().copied(), lookup)?)
}

fn read_samples(tensors: &SafeTensors<'_>) -> Result<SampleSet, FormatError> {
    let shape = |name: &str| {
        tensors
            .tensor(name)
            .map(|view| view.shape().to_vec())
            .map_err(|e| library("safetensors", &e))
    };
    let (count, channels) = match shape("values")?[..] {
        [count, 1] => (count, Channels::Luminance),
        [count, 3] => (count, Channels::Rgb),
        ref other => {
            return Err(FormatError::Missing {
                what: format!("values of one or three channels (shape {other:?})"),
                expected: "shape [samples, 1] or [samples, 3]".to_owned(),
            });
        }
    };
    let directions = tensor(tensors, "directions", Dtype::F64, &[count, 6])?;
    let values = tensor(tensors, "values", Dtype::F64, &[count, channels.count()])?;
    let directions: Vec<f64> = f64_values(directions).collect();
    let values: Vec<f64> = f64_values(values).collect();
    let mut samples = SampleSet::new(channels);
    for (directions, values) in
        directions.as_chunks::<6>().0.iter().zip(values.chunks_exact(channels.count()))
    {
        let [ix, iy, iz, ox, oy, oz] = *directions;
        // Anything but a unit vector is no direction; the set counts it.
        let unit = |w: DVec3| if w.is_normalized() { w } else { DVec3::NAN };
        let pair = DirectionPair::new(unit(DVec3::new(ix, iy, iz)), unit(DVec3::new(ox, oy, oz)));
        samples.push(&pair, values);
    }
    Ok(samples)
}

/// The bytes of a tensor of the expected type and shape.
fn tensor<'a>(
    tensors: &SafeTensors<'a>,
    name: &str,
    kind: Dtype,
    shape: &[usize],
) -> Result<&'a [u8], FormatError> {
    let view = tensors.tensor(name).map_err(|e| library("safetensors", &e))?;
    if view.dtype() == kind && view.shape() == shape {
        return Ok(view.data());
    }
    Err(FormatError::Missing {
        what: format!("tensor {name} in {kind:?} of shape {shape:?}"),
        expected: format!("that instead of {:?} {:?}", view.dtype(), view.shape()),
    })
}

fn descriptions(model: &FactoredBrdf) -> Vec<FactorDescription> {
    model.factors().iter().map(|factor| factor.description().clone()).collect()
}

/// The name of a factor's tensor: of the model itself, or of the one with that many textures.
fn tensor_name(textures: Option<usize>, index: usize) -> String {
    match textures {
        None => format!("factor{index}"),
        Some(count) => format!("of{count}.factor{index}"),
    }
}

fn tensor_shape(description: &FactorDescription, channels: usize) -> Vec<usize> {
    let size = description.grid.size;
    if description.grid.dimensions == 1 { vec![size, channels] } else { vec![size, size, channels] }
}

fn texels(bytes: &[u8], channels: usize) -> Vec<[f32; 4]> {
    f32_values(bytes)
        .chunks_exact(channels.clamp(1, 4))
        .map(|values| std::array::from_fn(|c| values.get(c).copied().unwrap_or(0.0)))
        .collect()
}

fn library(what: &'static str, problem: &dyn std::fmt::Display) -> FormatError {
    FormatError::Library { what, problem: problem.to_string() }
}
