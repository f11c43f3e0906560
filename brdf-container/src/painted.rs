//! Painted materials.

use brdf_factor::{
    ChannelTransform, FactorDescription, FactoredBrdf, SurfaceProduct, SurfaceTexture,
};
use brdf_paint::{CoefficientMap, Component, PaintRecord, PaintedMaterial};
use safetensors::tensor::Dtype;
use serde::{Deserialize, Serialize};

use crate::error::ContainerError;
use crate::factored::{read_factors, tensor_shape, texels};
use crate::head::{Head, library, read_record, serialize, tensor, tensors_of};
use crate::kind::Kind;
use brdf_io::f32_values;

/// A painted material and how it came about.
#[derive(Clone, Debug, PartialEq)]
pub struct PaintedFile {
    /// The material.
    pub material: PaintedMaterial,
    /// How it was made.
    pub record: PaintRecord,
}

#[derive(Serialize, Deserialize)]
struct Record {
    #[serde(flatten)]
    head: Head,
    products: Vec<ProductRecord>,
    limit: [f64; 3],
    paint: PaintRecord,
}

#[derive(Serialize, Deserialize)]
struct ProductRecord {
    theta_max: f64,
    maps: Vec<ChannelTransform>,
    factors: Vec<FactorDescription>,
    /// Texels a side and whether u wraps around.
    surface: Option<(usize, bool)>,
    map: Option<(usize, bool)>,
}

/// Returns the bytes of a painted material's file.
///
/// # Errors
///
/// [`ContainerError::Library`] if they cannot be put together.
pub fn write_painted(file: &PaintedFile) -> Result<Vec<u8>, ContainerError> {
    let mut tensors: Vec<(String, Vec<usize>, Vec<u8>)> = Vec::new();
    let mut products = Vec::new();
    for (index, Component { coefficients, product }) in file.material.components.iter().enumerate()
    {
        let angular = product.angular();
        let channels = angular.maps().len();
        let bytes = |texels: &[[f32; 4]]| -> Vec<u8> {
            texels.iter().flat_map(|t| &t[..channels]).flat_map(|v| v.to_le_bytes()).collect()
        };
        for (at, factor) in angular.factors().iter().enumerate() {
            let shape = tensor_shape(factor.description(), channels);
            tensors.push((factor_name(index, at), shape, bytes(factor.texels())));
        }
        if let Some(SurfaceTexture { size, texels, .. }) = product.surface() {
            tensors.push((surface_name(index), vec![*size, *size, channels], bytes(texels)));
        }
        if let Some(CoefficientMap { size, values, .. }) = coefficients {
            let bytes = values.iter().flat_map(|v| v.to_le_bytes()).collect();
            tensors.push((map_name(index), vec![*size, *size], bytes));
        }
        products.push(ProductRecord {
            theta_max: angular.theta_max(),
            maps: angular.maps().to_vec(),
            factors: angular.factors().iter().map(|f| f.description().clone()).collect(),
            surface: product.surface().map(|surface| (surface.size, surface.wraps)),
            map: coefficients.as_ref().map(|map| (map.size, map.wraps)),
        });
    }
    let head = Head::of(Kind::Painted);
    let limit = file.material.limit;
    let record = Record { head, products, limit, paint: file.record.clone() };
    let record = serde_json::to_string(&record).map_err(|e| library("material record", &e))?;
    let views = tensors
        .iter()
        .map(|(name, shape, bytes)| (name.as_str(), Dtype::F32, shape.clone(), bytes.as_slice()));
    serialize(views, record)
}

/// Returns a painted material.
///
/// # Errors
///
/// [`ContainerError`] for anything that is not whole and consistent.
pub fn read_painted(bytes: &[u8]) -> Result<PaintedFile, ContainerError> {
    let record = read_record(bytes, Kind::Painted)?;
    let record: Record =
        serde_json::from_str(&record).map_err(|e| library("material record", &e))?;
    let tensors = tensors_of(bytes)?;
    let components = record.products.into_iter().enumerate().map(|(index, product)| {
        let channels = product.maps.len();
        let name = |at: usize| factor_name(index, at);
        let factors = read_factors(&tensors, product.factors, channels, name)?;
        let angular = FactoredBrdf::new(factors, product.maps, product.theta_max)?;
        let surface = match product.surface {
            None => None,
            Some((size, wraps)) => {
                let shape = [size, size, channels];
                let data = tensor(&tensors, &surface_name(index), Dtype::F32, &shape)?;
                Some(SurfaceTexture { size, wraps, texels: texels(data, channels) })
            }
        };
        let coefficients = match product.map {
            None => None,
            Some((size, wraps)) => {
                let data = tensor(&tensors, &map_name(index), Dtype::F32, &[size, size])?;
                Some(CoefficientMap { size, wraps, values: f32_values(data) })
            }
        };
        let is_sound = |map: &CoefficientMap| {
            map.size > 0 && map.values.iter().all(|v| v.is_finite() && *v >= 0.0)
        };
        if !coefficients.as_ref().is_none_or(is_sound) {
            return Err(ContainerError::Missing {
                what: format!("sound texels of {}", map_name(index)),
                expected: "a map of finite numbers of 0 and above".to_owned(),
            });
        }
        Ok(Component { coefficients, product: SurfaceProduct::new(angular, surface)? })
    });
    let components = components.collect::<Result<Vec<_>, ContainerError>>()?;
    if record.limit.iter().any(|limit| !(limit.is_finite() && *limit >= 0.0)) {
        return Err(ContainerError::Missing {
            what: "brightest painted value".to_owned(),
            expected: "`limit` of three finite numbers of 0 and above".to_owned(),
        });
    }
    Ok(PaintedFile {
        material: PaintedMaterial { components, limit: record.limit },
        record: record.paint,
    })
}

fn factor_name(product: usize, factor: usize) -> String {
    format!("product{product}.factor{factor}")
}

fn surface_name(product: usize) -> String {
    format!("product{product}.surface")
}

fn map_name(product: usize) -> String {
    format!("map{product}")
}
