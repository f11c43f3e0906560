//! Sums of products in a container.

use brdf_fit::{SeparableModel, SeparableRecord};
use brdf_separable::{Layout, SecondSide, SeparableBrdf, ValueTransform};
use safetensors::SafeTensors;
use safetensors::tensor::Dtype;
use serde::{Deserialize, Serialize};

use crate::error::ContainerError;
use crate::head::{Head, library, serialize, tensor};
use crate::kind::Kind;
use brdf_io::f32_values;

#[derive(Serialize, Deserialize)]
struct Record {
    #[serde(flatten)]
    head: Head,
    layout: Layout,
    maps: Vec<ValueTransform>,
    rank: usize,
    first_channels: usize,
    fit: SeparableRecord,
}

/// Returns the bytes of a sum of products' file.
///
/// # Errors
///
/// [`ContainerError::Library`] if they cannot be put together.
pub fn write_separable(file: &SeparableModel) -> Result<Vec<u8>, ContainerError> {
    let model = &file.model;
    let record = Record {
        head: Head::of(Kind::Separable),
        layout: *model.layout(),
        maps: model.maps().to_vec(),
        rank: model.rank(),
        first_channels: model.first_channels(),
        fit: file.record.clone(),
    };
    let shapes = side_shapes(&record);
    let record = serde_json::to_string(&record).map_err(|e| library("model record", &e))?;
    let le_bytes =
        |values: &[f32]| -> Vec<u8> { values.iter().flat_map(|v| v.to_le_bytes()).collect() };
    let first = le_bytes(model.first());
    let (name, shape, second) = match (model.second(), model.signs()) {
        (Some(textures), _) => ("second", shapes.second, le_bytes(textures)),
        (None, signs) => ("signs", shapes.signs, le_bytes(signs.unwrap_or_default())),
    };
    let tensors = [
        ("first", Dtype::F32, shapes.first, first.as_slice()),
        (name, Dtype::F32, shape, second.as_slice()),
    ];
    serialize(tensors, record)
}

/// Shapes of the tensors of a sum of products.
struct SideShapes {
    first: Vec<usize>,
    second: Vec<usize>,
    signs: Vec<usize>,
}

fn side_shapes(record: &Record) -> SideShapes {
    let (rank, channels) = (record.rank, record.maps.len());
    let [columns, rows] = record.layout.first.size();
    let [second_columns, second_rows] = record.layout.second.size();
    SideShapes {
        first: vec![rows, columns, rank, record.first_channels],
        second: vec![second_rows, second_columns, rank, channels],
        signs: vec![rank, channels],
    }
}

pub(crate) fn parse_separable(
    record: &str,
    tensors: &SafeTensors<'_>,
) -> Result<SeparableModel, ContainerError> {
    let record: Record = serde_json::from_str(record).map_err(|e| library("model record", &e))?;
    record.layout.check()?;
    let shapes = side_shapes(&record);
    let values = |name: &str, shape: &[usize]| -> Result<Vec<f32>, ContainerError> {
        Ok(f32_values(tensor(tensors, name, Dtype::F32, shape)?))
    };
    let second = if tensors.names().contains(&"signs") {
        SecondSide::Signs(values("signs", &shapes.signs)?)
    } else {
        SecondSide::Textures(values("second", &shapes.second)?)
    };
    let first = values("first", &shapes.first)?;
    let model = SeparableBrdf::new(record.layout, record.maps, record.rank, first, second)?;
    Ok(SeparableModel { model, record: record.fit })
}
