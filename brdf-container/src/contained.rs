//! Containers of BRDFs, whatever their kind.

use brdf_fit::{CompactModel, FactoredModel, SeparableModel};
use brdf_model::{MerlLookup, MerlTable, SampleSet};

use crate::compact::parse_compact;
use crate::error::ContainerError;
use crate::factored::parse_factored;
use crate::head::{read_head, tensors_of};
use crate::kind::Kind;
use crate::separable::parse_separable;
use crate::table::{read_cells, read_samples};

/// The BRDF of a container.
#[derive(Clone, Debug, PartialEq)]
pub enum Contained {
    /// A product of textures.
    Factored(Box<FactoredModel>),
    /// A sum of products.
    Separable(Box<SeparableModel>),
    /// A compact model.
    Compact(Box<CompactModel>),
    /// A table on the MERL grid.
    Table(MerlTable),
    /// Scattered samples.
    Samples(SampleSet),
}

/// Returns the BRDF of a container of any kind that is one; tables are read with this lookup.
///
/// # Errors
///
/// [`ContainerError::NoBrdf`] for other kinds; [`ContainerError`] for anything that is not whole and consistent.
pub fn read_container(bytes: &[u8], lookup: MerlLookup) -> Result<Contained, ContainerError> {
    let (head, record) = read_head(bytes)?;
    let tensors = tensors_of(bytes)?;
    match head.kind {
        Kind::Factored => Ok(Contained::Factored(Box::new(parse_factored(&record, &tensors)?))),
        Kind::Separable => Ok(Contained::Separable(Box::new(parse_separable(&record, &tensors)?))),
        Kind::Spline | Kind::Ggx => {
            Ok(Contained::Compact(Box::new(parse_compact(&record, &tensors)?)))
        }
        Kind::MerlTable => Ok(Contained::Table(read_cells(&tensors, lookup)?)),
        Kind::Samples => Ok(Contained::Samples(read_samples(&tensors)?)),
        found => Err(ContainerError::NoBrdf { found }),
    }
}
