//! Files that list projections: JSON or TOML.

use brdf_param::{Projection, Space};
use serde::Deserialize;

use crate::error::ContainerError;
use crate::factored::read_factored;
use crate::head::{library, looks_like_container};

/// What a projection file says.
#[derive(Clone, Debug, PartialEq)]
pub struct ProjectionFile {
    /// The space that is projected, if the file names one.
    pub space: Option<Space>,
    /// One projection per factor.
    pub projections: Vec<Projection>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Raw {
    space: Option<Space>,
    projections: Vec<[[f64; 4]; 2]>,
}

/// Most projections in a file.
const MAX_PROJECTIONS: usize = 64;

/// Returns the projections of a factored model's file, or of a list as [`read_projections`] takes it.
///
/// # Errors
///
/// As [`read_projections`]; [`ContainerError`] for a container that is no factored model, or has no projections in
/// one space.
pub fn read_projection_source(bytes: &[u8]) -> Result<ProjectionFile, ContainerError> {
    if !looks_like_container(bytes) {
        return read_projections(&String::from_utf8_lossy(bytes));
    }
    let (space, projections) =
        read_factored(bytes)?.projections().ok_or_else(|| ContainerError::Missing {
            what: "usable projections in this model".to_owned(),
            expected: "at least one, all in one space".to_owned(),
        })?;
    Ok(ProjectionFile { space: Some(space), projections })
}

/// Returns the projections of `{"space": "standard", "projections": [[[a, b, c, d], [e, f, g, h]], …]}`, or the same in
/// TOML. Rows need not be orthonormal, but must be independent.
///
/// # Errors
///
/// [`ContainerError::Library`] for wrong syntax; [`ContainerError::Projection`] for rows that span no
/// plane; [`ContainerError::Missing`] for an empty or endless list.
pub fn read_projections(text: &str) -> Result<ProjectionFile, ContainerError> {
    let raw: Raw = if text.trim_start().starts_with('{') {
        serde_json::from_str(text).map_err(|e| library("JSON of projections", &e))?
    } else {
        toml::from_str(text).map_err(|e| library("TOML of projections", &e.message()))?
    };
    if raw.projections.is_empty() || raw.projections.len() > MAX_PROJECTIONS {
        return Err(ContainerError::Missing {
            what: format!("usable list of projections ({} of them)", raw.projections.len()),
            expected: format!("1 to {MAX_PROJECTIONS}, each two rows of four numbers"),
        });
    }
    let projections: Result<Vec<_>, _> = raw
        .projections
        .iter()
        .enumerate()
        .map(|(index, &[first, second])| {
            Projection::from_rows(first, second)
                .map_err(|problem| ContainerError::Projection { index: index + 1, problem })
        })
        .collect();
    Ok(ProjectionFile { space: raw.space, projections: projections? })
}
