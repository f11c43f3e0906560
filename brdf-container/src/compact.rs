//! Compact models in a container: splines as their stream, lobes in the record.

use brdf_fit::{CompactBrdf, CompactModel, CompactRecord, Makeup};
use brdf_spline::SplineBrdf;
use safetensors::SafeTensors;
use safetensors::tensor::Dtype;
use serde::{Deserialize, Serialize};

use crate::error::ContainerError;
use crate::head::{Head, library, serialize};
use crate::kind::Kind;

/// The tensor of a stream.
const STREAM: &str = "stream";

#[derive(Serialize, Deserialize)]
struct Record {
    #[serde(flatten)]
    head: Head,
    fit: CompactRecord,
}

/// Returns the bytes of a compact model's file.
///
/// # Errors
///
/// [`ContainerError::Library`] if they cannot be put together.
pub fn write_compact(file: &CompactModel) -> Result<Vec<u8>, ContainerError> {
    let (kind, stream) = match &file.model {
        CompactBrdf::Spline(model) => (Kind::Spline, Some(model.as_bytes())),
        CompactBrdf::Ggx(_) => (Kind::Ggx, None),
    };
    let record = Record { head: Head::of(kind), fit: file.record.clone() };
    let record = serde_json::to_string(&record).map_err(|e| library("model record", &e))?;
    serialize(stream.map(|bytes| (STREAM, Dtype::U8, vec![bytes.len()], bytes)), record)
}

pub(crate) fn parse_compact(
    record: &str,
    tensors: &SafeTensors<'_>,
) -> Result<CompactModel, ContainerError> {
    let record: Record = serde_json::from_str(record).map_err(|e| library("model record", &e))?;
    let model = match (record.head.kind, &record.fit.makeup) {
        (Kind::Ggx, Makeup::Lobes(lobes)) => CompactBrdf::Ggx(lobes.clone()),
        (Kind::Spline, _) => {
            let stream = tensors.tensor(STREAM).map_err(|e| library("safetensors", &e))?;
            CompactBrdf::Spline(Box::new(SplineBrdf::from_bytes(stream.data())?))
        }
        _ => {
            return Err(ContainerError::Missing {
                what: "the parameters of the lobes".to_owned(),
                expected: "a record with makeup.lobes".to_owned(),
            });
        }
    };
    Ok(CompactModel { model, record: record.fit })
}
