//! Products of textures.

use brdf_factor::{
    ChannelTransform, Factor, FactorDescription, FactoredBrdf, Grid, StoredTexels, TexelFormat,
};
use brdf_fit::{FactoredModel, FactoredRecord};
use brdf_io::f32_values;
use safetensors::SafeTensors;
use safetensors::tensor::Dtype;
use serde::{Deserialize, Serialize};

use crate::error::ContainerError;
use crate::head::{Head, library, read_record, serialize, tensor, tensors_of, view};
use crate::kind::Kind;

#[derive(Serialize, Deserialize)]
struct Record {
    #[serde(flatten)]
    head: Head,
    theta_max: f64,
    maps: Vec<ChannelTransform>,
    /// Largest value of each channel; none where models are not held.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    ceilings: Option<Vec<f64>>,
    factors: Vec<FactorDescription>,
    /// Of the models of fewer textures.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    smaller: Vec<Vec<FactorDescription>>,
    fit: FactoredRecord,
}

/// Returns the JSON record of a model, as its file holds it.
///
/// # Errors
///
/// [`ContainerError::Library`] if the record cannot be written.
pub fn factored_record(file: &FactoredModel) -> Result<String, ContainerError> {
    let model = &file.model;
    let record = Record {
        head: Head::of(Kind::Factored),
        theta_max: model.theta_max(),
        maps: model.maps().to_vec(),
        ceilings: model.ceilings().iter().all(|c| c.is_finite()).then(|| model.ceilings().to_vec()),
        factors: descriptions(model),
        smaller: file.smaller.iter().map(descriptions).collect(),
        fit: file.record.clone(),
    };
    serde_json::to_string(&record).map_err(|e| library("model record", &e))
}

/// Returns the bytes of a model's file.
///
/// # Errors
///
/// [`ContainerError::Library`] if they cannot be put together.
pub fn write_factored(file: &FactoredModel) -> Result<Vec<u8>, ContainerError> {
    let channels = file.model.maps().len();
    let smaller = file.smaller.iter().map(|model| (Some(model.factors().len()), model));
    let mut tensors: Vec<(String, Dtype, Vec<usize>, Vec<u8>)> = Vec::new();
    for (part, model) in std::iter::once((None, &file.model)).chain(smaller) {
        for (index, factor) in model.factors().iter().enumerate() {
            let name = tensor_name(part, index);
            let StoredTexels { format, bytes, ranges } = factor.stored(channels);
            if !ranges.is_empty() {
                let ends = ranges.iter().flatten().flat_map(|end| end.to_le_bytes());
                tensors.push((range_name(&name), Dtype::F32, vec![channels, 2], ends.collect()));
            }
            tensors.push((
                name,
                dtype(format),
                tensor_shape(factor.description(), channels),
                bytes,
            ));
        }
    }
    let tensors = tensors
        .iter()
        .map(|(name, kind, shape, bytes)| (name.as_str(), *kind, shape.clone(), bytes.as_slice()));
    serialize(tensors, factored_record(file)?)
}

/// Returns the factored model of a container's bytes.
///
/// # Errors
///
/// [`ContainerError`] for another kind, or anything that is not whole and consistent.
pub fn read_factored(bytes: &[u8]) -> Result<FactoredModel, ContainerError> {
    parse_factored(&read_record(bytes, Kind::Factored)?, &tensors_of(bytes)?)
}

pub(crate) fn parse_factored(
    record: &str,
    tensors: &SafeTensors<'_>,
) -> Result<FactoredModel, ContainerError> {
    let record: Record = serde_json::from_str(record).map_err(|e| library("model record", &e))?;
    let channels = record.maps.len();
    let model = |part: Option<usize>, descriptions: Vec<FactorDescription>| {
        let name = |index: usize| tensor_name(part, index);
        let factors = read_factors(tensors, descriptions, channels, name)?;
        let model = FactoredBrdf::new(factors, record.maps.clone(), record.theta_max)?;
        Ok::<_, ContainerError>(match &record.ceilings {
            Some(ceilings) => model.with_ceilings(ceilings.clone())?,
            None => model,
        })
    };
    let smaller = record.smaller.into_iter().map(|part| model(Some(part.len()), part));
    Ok(FactoredModel {
        smaller: smaller.collect::<Result<_, _>>()?,
        model: model(None, record.factors)?,
        record: record.fit,
    })
}

/// Factors with their texels.
pub(crate) fn read_factors(
    tensors: &SafeTensors<'_>,
    descriptions: Vec<FactorDescription>,
    channels: usize,
    name: impl Fn(usize) -> String,
) -> Result<Vec<Factor>, ContainerError> {
    let described = descriptions.into_iter().enumerate().map(|(index, description)| {
        description.check()?;
        let shape = tensor_shape(&description, channels);
        let name = name(index);
        let found = view(tensors, &name)?;
        let known = TexelFormat::ALL.into_iter().find(|format| dtype(*format) == found.dtype());
        let Some(format) = known.filter(|_| found.shape() == shape) else {
            return Err(ContainerError::Missing {
                what: format!("tensor {name} in F32, F16 or U8 of shape {shape:?}"),
                expected: format!("that instead of {:?} {:?}", found.dtype(), found.shape()),
            });
        };
        let ranges = match format {
            TexelFormat::U8 => {
                let ends = tensor(tensors, &range_name(&name), Dtype::F32, &[channels, 2])?;
                f32_values(ends).as_chunks::<2>().0.to_vec()
            }
            TexelFormat::F32 | TexelFormat::F16 => Vec::new(),
        };
        let stored = StoredTexels { format, bytes: found.data().to_vec(), ranges };
        Ok(Factor::from_stored(description, &stored, channels)?)
    });
    described.collect()
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

/// The name of the tensor of the ends of a texture's values in eight bits.
fn range_name(texture: &str) -> String {
    format!("{texture}.range")
}

fn dtype(format: TexelFormat) -> Dtype {
    match format {
        TexelFormat::F32 => Dtype::F32,
        TexelFormat::F16 => Dtype::F16,
        TexelFormat::U8 => Dtype::U8,
    }
}

pub(crate) fn tensor_shape(description: &FactorDescription, channels: usize) -> Vec<usize> {
    let Grid { columns, rows } = description.grid;
    match description.grid.dimensions() {
        1 => vec![columns, channels],
        _ => vec![rows, columns, channels],
    }
}

pub(crate) fn texels(bytes: &[u8], channels: usize) -> Vec<[f32; 4]> {
    f32_values(bytes)
        .chunks_exact(channels.clamp(1, 4))
        .map(|values| std::array::from_fn(|c| values.get(c).copied().unwrap_or(0.0)))
        .collect()
}
