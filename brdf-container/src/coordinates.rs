//! Files that list factors by their coordinates: JSON or TOML.

use brdf_factor::FactorSpec;
use serde::Deserialize;

use crate::error::ContainerError;
use crate::head::library;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Raw {
    factors: Vec<FactorSpec>,
}

/// Most factors in a file.
const MAX_FACTORS: usize = 64;

/// Returns the factors of `{"factors": [{"coordinates": […], "grid": {"columns": 40, "rows": 28}}, …]}`, or the same in
/// TOML; coordinates and grid as [`FactorSpec`] has them, the grid optional.
///
/// ```
/// let text = r#"{"factors": [{"coordinates": [{"kind": "isotropic", "axes":
///     [{"angle": "theta-h", "spacing": {"kind": "power", "exponent": 0.5}}, {"angle": "theta-d"}]}],
///     "grid": {"columns": 40, "rows": 28}}, {"coordinates": [{"kind": "wi"}, {"kind": "wo"}]}]}"#;
/// assert_eq!(brdf_container::read_coordinates(text)?.len(), 2);
/// # Ok::<(), brdf_container::ContainerError>(())
/// ```
///
/// # Errors
///
/// [`ContainerError::Library`] for wrong syntax; [`ContainerError::Missing`] for an empty or endless list.
pub fn read_coordinates(text: &str) -> Result<Vec<FactorSpec>, ContainerError> {
    let Raw { factors } = if text.trim_start().starts_with('{') {
        serde_json::from_str(text).map_err(|e| library("JSON of factors", &e))?
    } else {
        toml::from_str(text).map_err(|e| library("TOML of factors", &e.message()))?
    };
    if factors.is_empty() || factors.len() > MAX_FACTORS {
        return Err(ContainerError::Missing {
            what: format!("usable list of factors ({} of them)", factors.len()),
            expected: format!("1 to {MAX_FACTORS}, each with its coordinates"),
        });
    }
    Ok(factors)
}
