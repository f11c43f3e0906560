//! What all containers have in common: safetensors with one JSON record under the metadata key `brdf`.

use std::collections::HashMap;

use safetensors::SafeTensors;
use safetensors::tensor::{Dtype, TensorView};
use serde::{Deserialize, Serialize};

use crate::error::ContainerError;
use crate::kind::Kind;

pub(crate) const KEY: &str = "brdf";
pub(crate) const VERSION: u32 = 1;

/// The part of the record that every kind has.
#[derive(Serialize, Deserialize)]
pub(crate) struct Head {
    pub(crate) kind: Kind,
    version: u32,
}

impl Head {
    pub(crate) fn of(kind: Kind) -> Self {
        Self { kind, version: VERSION }
    }

    pub(crate) fn version(&self) -> u32 {
        self.version
    }
}

/// Returns whether bytes are those of a safetensors file, whole or cut short.
pub fn looks_like_container(bytes: &[u8]) -> bool {
    let Some((length, rest)) = bytes.split_first_chunk::<8>() else { return false };
    // One that was cut short still starts as it should.
    rest.starts_with(b"{\"")
        || rest.first() == Some(&b'{') && u64::from_le_bytes(*length) <= rest.len() as u64
}

/// Returns the kind of a container.
///
/// # Errors
///
/// [`ContainerError`] for a file that is no container of this project, or of another version.
pub fn kind_of(bytes: &[u8]) -> Result<Kind, ContainerError> {
    Ok(read_head(bytes)?.0.kind)
}

pub(crate) fn serialize<'a>(
    tensors: impl IntoIterator<Item = (&'a str, Dtype, Vec<usize>, &'a [u8])>,
    record: String,
) -> Result<Vec<u8>, ContainerError> {
    let views: Result<Vec<(&str, TensorView<'_>)>, ContainerError> = tensors
        .into_iter()
        .map(|(name, kind, shape, bytes)| {
            let view = TensorView::new(kind, shape, bytes);
            Ok((name, view.map_err(|e| library("safetensors", &e))?))
        })
        .collect();
    let metadata = HashMap::from([(KEY.to_owned(), record)]);
    safetensors::serialize(views?, Some(metadata)).map_err(|e| library("safetensors", &e))
}

/// What kind of container this is, and its record.
pub(crate) fn read_head(bytes: &[u8]) -> Result<(Head, String), ContainerError> {
    let (_, metadata) =
        SafeTensors::read_metadata(bytes).map_err(|e| library("safetensors", &e))?;
    let record = metadata.metadata().as_ref().and_then(|m| m.get(KEY)).ok_or_else(|| {
        ContainerError::Missing {
            what: format!("metadata key {KEY:?}"),
            expected: "a safetensors file written by brdf".to_owned(),
        }
    })?;
    let head: Head = serde_json::from_str(record).map_err(|e| library("record", &e))?;
    if head.version != VERSION {
        return Err(ContainerError::Version { found: head.version, expected: VERSION });
    }
    Ok((head, record.clone()))
}

/// The record of a container of one kind.
pub(crate) fn read_record(bytes: &[u8], expected: Kind) -> Result<String, ContainerError> {
    let (head, record) = read_head(bytes)?;
    if head.kind != expected {
        return Err(ContainerError::Kind { found: head.kind, expected });
    }
    Ok(record)
}

pub(crate) fn tensors_of(bytes: &[u8]) -> Result<SafeTensors<'_>, ContainerError> {
    SafeTensors::deserialize(bytes).map_err(|e| library("safetensors", &e))
}

/// A tensor of any type and shape.
pub(crate) fn view<'a>(
    tensors: &SafeTensors<'a>,
    name: &str,
) -> Result<TensorView<'a>, ContainerError> {
    tensors.tensor(name).map_err(|e| library("safetensors", &e))
}

/// The bytes of a tensor of the expected type and shape.
pub(crate) fn tensor<'a>(
    tensors: &SafeTensors<'a>,
    name: &str,
    kind: Dtype,
    shape: &[usize],
) -> Result<&'a [u8], ContainerError> {
    let view = view(tensors, name)?;
    if view.dtype() == kind && view.shape() == shape {
        return Ok(view.data());
    }
    Err(ContainerError::Missing {
        what: format!("tensor {name} in {kind:?} of shape {shape:?}"),
        expected: format!("that instead of {:?} {:?}", view.dtype(), view.shape()),
    })
}

pub(crate) fn library(what: &'static str, problem: &dyn std::fmt::Display) -> ContainerError {
    ContainerError::Library { what, problem: problem.to_string() }
}
