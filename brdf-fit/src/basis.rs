//! Preinverted matrices.

use brdf_factor::Inverse;

use crate::record::BasisRecord;

/// A preinverted matrix and what it was made for.
#[derive(Clone, Debug)]
pub struct Basis {
    /// The matrix.
    pub inverse: Inverse,
    /// What it was made for.
    pub record: BasisRecord,
}
