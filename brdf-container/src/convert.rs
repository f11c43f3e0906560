//! Materials on MERL's grid, and as containers.

use brdf_io::Measured;
use brdf_model::MerlTable;

use crate::compact::write_compact;
use crate::error::ContainerError;
use crate::factored::write_factored;
use crate::open::{Content, MaterialFile};
use crate::separable::write_separable;
use crate::table::{write_samples, write_table};

/// How a material came onto MERL's grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tabulated {
    /// Cell by cell: it stood there.
    Copied,
    /// Evaluated at the cell centres, negative values set to 0, and made reciprocal.
    Evaluated {
        /// Angle beyond which a product of textures holds its value, radians.
        held_beyond: Option<f64>,
    },
}

/// What a container of a material holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Converted {
    /// The rows of a scattered measurement.
    Rows,
    /// The model, unchanged.
    Model,
    /// A table on MERL's grid.
    Table(Tabulated),
}

impl MaterialFile {
    /// Returns the material on MERL's grid, which is isotropic and reciprocal; none of scattered samples, which do not
    /// fill it.
    pub fn merl_table(&self) -> Option<(MerlTable, Tabulated)> {
        if self.samples().is_some() {
            return None;
        }
        if let Content::Measured(Measured::Merl(table)) = &self.content {
            return Some((table.clone(), Tabulated::Copied));
        }
        let held_beyond = match &self.content {
            Content::Factored(file) => Some(file.model.theta_max()),
            _ => None,
        };
        Some((MerlTable::tabulate(self.brdf()), Tabulated::Evaluated { held_beyond }))
    }

    /// Returns the bytes of the material's own file: a model or rows as they are, anything else on MERL's grid.
    ///
    /// # Errors
    ///
    /// [`ContainerError::Library`] if they cannot be put together.
    pub fn to_container(&self) -> Result<(Vec<u8>, Converted), ContainerError> {
        if let Some(rows) = self.samples() {
            return Ok((write_samples(rows)?, Converted::Rows));
        }
        match &self.content {
            Content::Factored(file) => Ok((write_factored(file)?, Converted::Model)),
            Content::Separable(file) => Ok((write_separable(file)?, Converted::Model)),
            Content::Compact(file) => Ok((write_compact(file)?, Converted::Model)),
            Content::Preset(_) | Content::Measured(_) => {
                let table = match &self.content {
                    Content::Measured(Measured::Merl(table)) => (table.clone(), Tabulated::Copied),
                    _ => {
                        let how = Tabulated::Evaluated { held_beyond: None };
                        (MerlTable::tabulate(self.brdf()), how)
                    }
                };
                Ok((write_table(&table.0)?, Converted::Table(table.1)))
            }
        }
    }
}
