//! Sums of products in a container.

use brdf_model::FitErrors;
use brdf_separable::{
    CellCounts, ChannelSpectrum, Decomposition, Fill, Layout, RankError, SecondSide, SeparableBrdf,
    ValueTransform,
};
use safetensors::SafeTensors;
use safetensors::tensor::Dtype;
use serde::{Deserialize, Serialize};

use super::{Head, Kind, VERSION, library, serialize, tensor};
use crate::FormatError;
use crate::bytes::f32_values;

/// A sum of products and the record of how it was made.
#[derive(Clone, Debug, PartialEq)]
pub struct SeparableFile {
    /// The model.
    pub model: SeparableBrdf,
    /// How it was made.
    pub fit: SeparableRecord,
}

/// How a sum of products was made and how good it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SeparableRecord {
    /// `svd`, `log-svd`, `eigen`, `nmf` or `normalized`.
    pub method: String,
    /// What was factored: a preset, or the name of a file without its folder.
    pub input: String,
    /// Options.
    pub settings: SeparableSettings,
    /// What became of the cells of the matrix.
    pub cells: CellCounts,
    /// ‖M − Mᵀ‖ / ‖M‖ before the matrix was made symmetric, if it was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub asymmetry: Option<f64>,
    /// Singular values, eigenvalues or norms, for each channel or for all together.
    pub spectra: Vec<ChannelSpectrum>,
    /// Errors for each number of terms.
    pub terms: Vec<RankRecord>,
}

/// Options that decide a sum of products.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SeparableSettings {
    /// Which decomposition.
    pub decomposition: Decomposition,
    /// Number of terms asked for.
    pub rank: usize,
    /// All channels together, scalar textures on the first side.
    pub joint_rgb: bool,
    /// Grazing limit of the matrix, radians.
    pub theta_max: f64,
    /// What stands in cells without data.
    pub fill: Fill,
    /// Power of the cosine in the weights.
    pub weight_power: f64,
    /// Grazing limit of the held-out pairs, radians.
    pub held_out_theta_max: f64,
    /// Which scramble they come from.
    pub seed: u64,
}

/// Errors of a sum of products with a number of terms.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RankRecord {
    /// Over the cells of the matrix.
    #[serde(flatten)]
    pub matrix: RankError,
    /// Over pairs between its nodes; none for scattered rows, of which all were used.
    pub held_out: Option<FitErrors>,
}

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

/// The bytes of a sum of products' file.
///
/// # Errors
///
/// [`FormatError::Library`] if they cannot be put together.
pub fn separable_to_bytes(file: &SeparableFile) -> Result<Vec<u8>, FormatError> {
    let model = &file.model;
    let record = Record {
        head: Head { kind: Kind::Separable, version: VERSION },
        layout: *model.layout(),
        maps: model.maps().to_vec(),
        rank: model.rank(),
        first_channels: model.first_channels(),
        fit: file.fit.clone(),
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

pub(super) fn read(record: &str, tensors: &SafeTensors<'_>) -> Result<SeparableFile, FormatError> {
    let record: Record = serde_json::from_str(record).map_err(|e| library("model record", &e))?;
    record.layout.check()?;
    let shapes = side_shapes(&record);
    let values = |name: &str, shape: &[usize]| -> Result<Vec<f32>, FormatError> {
        Ok(f32_values(tensor(tensors, name, Dtype::F32, shape)?))
    };
    let second = if tensors.names().contains(&"signs") {
        SecondSide::Signs(values("signs", &shapes.signs)?)
    } else {
        SecondSide::Textures(values("second", &shapes.second)?)
    };
    let first = values("first", &shapes.first)?;
    let model = SeparableBrdf::new(record.layout, record.maps, record.rank, first, second)?;
    Ok(SeparableFile { model, fit: record.fit })
}
