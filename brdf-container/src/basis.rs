//! Preinverted matrices.

use brdf_factor::{CholeskyFactor, Inverse, Solver, SpectralBasis};
use brdf_fit::{Basis, BasisRecord, FitSettingsRecord};
use safetensors::tensor::Dtype;
use serde::{Deserialize, Serialize};

use crate::error::ContainerError;
use crate::head::{Head, library, read_record, serialize, tensor, tensors_of};
use crate::kind::Kind;
use brdf_io::f64_values;

/// Most samples that a file may ask to be drawn.
const MOST_SAMPLES: u64 = 1 << 27;

#[derive(Serialize, Deserialize)]
struct Record {
    #[serde(flatten)]
    head: Head,
    basis: BasisRecord,
}

/// Returns the bytes of a preinverted matrix's file.
///
/// # Errors
///
/// [`ContainerError::Library`] if they cannot be put together.
pub fn write_basis(file: &Basis) -> Result<Vec<u8>, ContainerError> {
    let head = Head::of(Kind::Basis);
    let record = serde_json::to_string(&Record { head, basis: file.record.clone() })
        .map_err(|e| library("basis record", &e))?;
    let bytes =
        |values: &[f64]| -> Vec<u8> { values.iter().flat_map(|v| v.to_le_bytes()).collect() };
    let unknowns = file.record.unknowns;
    let tensors = match &file.inverse {
        Inverse::Cholesky(factor) => {
            vec![("cholesky", vec![unknowns, unknowns], bytes(factor.values()))]
        }
        Inverse::Svd(basis) => vec![
            ("vectors", vec![basis.components(), unknowns], bytes(basis.vectors())),
            ("weights", vec![basis.components()], bytes(basis.weights())),
        ],
    };
    let views = tensors
        .iter()
        .map(|(name, shape, bytes)| (*name, Dtype::F64, shape.clone(), bytes.as_slice()));
    serialize(views, record)
}

/// Returns a preinverted matrix.
///
/// # Errors
///
/// [`ContainerError`] for anything that is not whole and consistent.
pub fn read_basis(bytes: &[u8]) -> Result<Basis, ContainerError> {
    let record = read_record(bytes, Kind::Basis)?;
    let Record { basis: record, .. } =
        serde_json::from_str(&record).map_err(|e| library("basis record", &e))?;
    let refuse = || ContainerError::Missing {
        what: format!("sound matrix of {} unknowns", record.unknowns),
        expected: "finite numbers".to_owned(),
    };
    if record.unknowns == 0 || record.unknowns > Solver::MAX_DENSE {
        return Err(refuse());
    }
    let FitSettingsRecord { samples, replicate, .. } = record.settings;
    if replicate > 360 || u64::from(samples) * u64::from(replicate) > MOST_SAMPLES {
        return Err(ContainerError::Missing {
            what: format!("usable number of samples ({samples}, turned {replicate} times)"),
            expected: format!("at most 360 turns and {MOST_SAMPLES} samples in all"),
        });
    }
    let tensors = tensors_of(bytes)?;
    let values = |name: &str, shape: &[usize]| -> Result<Vec<f64>, ContainerError> {
        Ok(f64_values(tensor(&tensors, name, Dtype::F64, shape)?).collect())
    };
    let unknowns = record.unknowns;
    let inverse = match record.components {
        None => {
            let values = values("cholesky", &[unknowns, unknowns])?;
            Inverse::Cholesky(CholeskyFactor::from_values(values).ok_or_else(refuse)?)
        }
        Some(count) => {
            let (vectors, weights) =
                (values("vectors", &[count, unknowns])?, values("weights", &[count])?);
            let basis = SpectralBasis::from_parts(unknowns, vectors, weights);
            Inverse::Svd(basis.ok_or_else(refuse)?)
        }
    };
    Ok(Basis { inverse, record })
}
