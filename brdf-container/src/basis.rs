//! Preinverted matrices.

use brdf_factor::{CholeskyFactor, Inverse, Plan, Solver, SpectralBasis};
use safetensors::SafeTensors;
use safetensors::tensor::Dtype;
use serde::{Deserialize, Serialize};

use super::{FitSettings, Head, Kind, VERSION, library, read_head, serialize, tensor};
use crate::FormatError;
use crate::bytes::f64_values;

/// A preinverted matrix and what it was made for.
#[derive(Clone, Debug)]
pub struct BasisFile {
    /// The matrix.
    pub inverse: Inverse,
    /// What it was made for.
    pub record: BasisRecord,
}

/// What a preinverted matrix was made for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BasisRecord {
    /// `mccool`, `radial` or `projections`.
    pub method: String,
    /// The factors.
    pub plan: Plan,
    /// How samples were drawn and fitted.
    pub settings: FitSettings,
    /// Hash of the samples' places and all else that the matrix depends on.
    pub key: String,
    /// Texels solved for.
    pub unknowns: usize,
    /// Vectors of a basis; none for a Cholesky factor.
    pub components: Option<usize>,
}

/// Most samples that a file may ask to be drawn.
const MOST_SAMPLES: u64 = 1 << 27;

#[derive(Serialize, Deserialize)]
struct Record {
    #[serde(flatten)]
    head: Head,
    basis: BasisRecord,
}

/// The bytes of a preinverted matrix's file.
///
/// # Errors
///
/// [`FormatError::Library`] if they cannot be put together.
pub fn basis_to_bytes(file: &BasisFile) -> Result<Vec<u8>, FormatError> {
    let head = Head { kind: Kind::Basis, version: VERSION };
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

/// Reads a preinverted matrix.
///
/// # Errors
///
/// [`FormatError`] for anything that is not whole and consistent.
pub fn parse_basis(bytes: &[u8]) -> Result<BasisFile, FormatError> {
    let (head, record) = read_head(bytes)?;
    if !matches!(head.kind, Kind::Basis) {
        return Err(FormatError::Missing {
            what: "preinverted matrix: this is a container of another kind".to_owned(),
            expected: "what `brdf factor --preinvert` wrote".to_owned(),
        });
    }
    let Record { basis: record, .. } =
        serde_json::from_str(&record).map_err(|e| library("basis record", &e))?;
    let refuse = || FormatError::Missing {
        what: format!("sound matrix of {} unknowns", record.unknowns),
        expected: "finite numbers, as `brdf factor --preinvert` writes them".to_owned(),
    };
    if record.unknowns == 0 || record.unknowns > Solver::MAX_DENSE {
        return Err(refuse());
    }
    let FitSettings { samples, replicate, .. } = record.settings;
    if replicate > 360 || u64::from(samples) * u64::from(replicate) > MOST_SAMPLES {
        return Err(FormatError::Missing {
            what: format!("usable number of samples ({samples}, turned {replicate} times)"),
            expected: format!("at most 360 turns and {MOST_SAMPLES} samples in all"),
        });
    }
    let tensors = SafeTensors::deserialize(bytes).map_err(|e| library("safetensors", &e))?;
    let values = |name: &str, shape: &[usize]| -> Result<Vec<f64>, FormatError> {
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
    Ok(BasisFile { inverse, record })
}
