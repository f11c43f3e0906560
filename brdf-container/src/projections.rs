//! Files that list projections: JSON or TOML.

use brdf_param::{Projection, Space};
use serde::Deserialize;

use crate::FormatError;

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

/// Reads `{"space": "standard", "projections": [[[a, b, c, d], [e, f, g, h]], …]}`, or the same in
/// TOML. Rows need not be orthonormal, but must be independent.
///
/// # Errors
///
/// [`FormatError::Library`] for wrong syntax; [`FormatError::Projection`] for rows that span no
/// plane; [`FormatError::Missing`] for an empty or endless list.
pub fn read_projections(text: &str) -> Result<ProjectionFile, FormatError> {
    let raw: Raw = if text.trim_start().starts_with('{') {
        serde_json::from_str(text).map_err(|e| library("JSON of projections", &e))?
    } else {
        toml::from_str(text).map_err(|e| library("TOML of projections", &e.message()))?
    };
    if raw.projections.is_empty() || raw.projections.len() > MAX_PROJECTIONS {
        return Err(FormatError::Missing {
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
                .map_err(|problem| FormatError::Projection { index: index + 1, problem })
        })
        .collect();
    Ok(ProjectionFile { space: raw.space, projections: projections? })
}

fn library(what: &'static str, problem: &dyn std::fmt::Display) -> FormatError {
    FormatError::Library { what, problem: problem.to_string() }
}
