//! Tables on the MERL grid and scattered samples.

use brdf_io::{f32_values, f64_values};
use brdf_model::{Channels, MerlLookup, MerlTable, SampleSet};
use brdf_param::DirectionPair;
use glam::DVec3;
use safetensors::SafeTensors;
use safetensors::tensor::Dtype;

use crate::error::ContainerError;
use crate::head::{Head, library, serialize, tensor};
use crate::kind::Kind;

/// Returns the bytes of a table's file.
///
/// # Errors
///
/// [`ContainerError::Library`] if they cannot be put together.
pub fn write_table(table: &MerlTable) -> Result<Vec<u8>, ContainerError> {
    let bytes: Vec<u8> = table.cells().iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
    serialize([("cells", Dtype::F32, TABLE_SHAPE.to_vec(), &bytes[..])], head(Kind::MerlTable)?)
}

/// Returns the bytes of a file of samples.
///
/// # Errors
///
/// [`ContainerError::Library`] if they cannot be put together.
pub fn write_samples(samples: &SampleSet) -> Result<Vec<u8>, ContainerError> {
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

fn head(kind: Kind) -> Result<String, ContainerError> {
    serde_json::to_string(&Head::of(kind)).map_err(|e| library("record", &e))
}

const TABLE_SHAPE: [usize; 4] = [MerlTable::THETA_H, MerlTable::THETA_D, MerlTable::PHI_D, 3];

pub(crate) fn read_cells(
    tensors: &SafeTensors<'_>,
    lookup: MerlLookup,
) -> Result<MerlTable, ContainerError> {
    let data = tensor(tensors, "cells", Dtype::F32, &TABLE_SHAPE)?;
    Ok(MerlTable::new(f32_values(data).as_chunks::<3>().0.iter().copied(), lookup)?)
}

pub(crate) fn read_samples(tensors: &SafeTensors<'_>) -> Result<SampleSet, ContainerError> {
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
            return Err(ContainerError::Missing {
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
