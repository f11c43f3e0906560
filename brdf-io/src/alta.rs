//! ALTA text: a header of `#KEY value` lines, then rows of inputs and outputs.
//!
//! What can be read: isotropic directions as `ISOTROPIC_TL_TV_PROJ_DPHI`, that is, the angle of the
//! light, and the angle of the viewer split into its parts along and across the plane of the light,
//! θv cosΔφ and θv sinΔφ, in radians; one output or three.

use std::collections::HashMap;

use brdf_model::{Channels, SampleSet};
use brdf_param::{DirectionPair, spherical_direction};

use crate::error::{FormatError, quoted};
use crate::note::ReadNote;

const PARAM_IN: &str = "ISOTROPIC_TL_TV_PROJ_DPHI";

/// Reads the samples of an ALTA text file, and notes on what the file does not say.
///
/// Values are in sr⁻¹ without the cosine; where the header says that they hold the cosine of the viewer, it is
/// divided out.
///
/// ```
/// let text = "#DIM 3 1\n#PARAM_IN ISOTROPIC_TL_TV_PROJ_DPHI\n#PARAM_OUT INV_STERADIAN\n0.5 0.5 0.0 0.2\n";
/// let (samples, notes) = brdf_io::read_alta(text)?;
/// assert_eq!(samples.values(), [[0.2]]);
/// assert!(notes.is_empty());
/// # Ok::<(), brdf_io::FormatError>(())
/// ```
///
/// # Errors
///
/// [`FormatError::Missing`] for another parametrization or the binary form; [`FormatError::Line`].
pub fn read_alta(text: &str) -> Result<(SampleSet, Vec<ReadNote>), FormatError> {
    let header = header(text);
    if header.get("FORMAT").is_some_and(|format| format.eq_ignore_ascii_case("binary")) {
        return Err(FormatError::Missing {
            what: "text: this is ALTA's binary form".to_owned(),
            expected: "the text form".to_owned(),
        });
    }
    let outputs = match header.get("DIM").map(|dim| dim.split_whitespace().collect::<Vec<_>>()) {
        Some(dim) if dim == ["3", "1"] => 1,
        Some(dim) if dim == ["3", "3"] => 3,
        other => {
            return Err(FormatError::Missing {
                what: format!("usable #DIM ({})", other.unwrap_or_default().join(" ")),
                expected: "#DIM 3 1 or #DIM 3 3".to_owned(),
            });
        }
    };
    let param_in = header.get("PARAM_IN").copied().unwrap_or("nothing");
    if param_in != PARAM_IN {
        return Err(FormatError::Missing {
            what: format!("directions that can be read (#PARAM_IN {param_in})"),
            expected: format!("#PARAM_IN {PARAM_IN}"),
        });
    }
    let mut notes = Vec::new();
    let divide_by_cosine = match header.get("PARAM_OUT").copied() {
        Some("INV_STERADIAN" | "RGB_COLOR") => false,
        Some("INV_STERADIAN_COSINE_FACTOR") => {
            notes.push(ReadNote::CosineDividedOut);
            true
        }
        None => {
            notes.push(ReadNote::UnitAssumed);
            false
        }
        Some(other) => {
            return Err(FormatError::Missing {
                what: format!("values that can be read (#PARAM_OUT {other})"),
                expected: "INV_STERADIAN, INV_STERADIAN_COSINE_FACTOR or RGB_COLOR".to_owned(),
            });
        }
    };
    let channels = if outputs == 1 { Channels::Luminance } else { Channels::Rgb };
    let mut samples = SampleSet::new(channels);
    for (line, content) in data_lines(text) {
        let row = parse_row(line, content, 3 + outputs)?;
        let viewer = spherical_direction(row[1].hypot(row[2]), row[2].atan2(row[1]));
        let pair = DirectionPair::new(spherical_direction(row[0], 0.0), viewer);
        let cosine = if divide_by_cosine { viewer.z } else { 1.0 };
        let values: Vec<f64> = row[3..3 + outputs].iter().map(|v| v / cosine).collect();
        samples.push(&pair, &values);
    }
    Ok((samples, notes))
}

/// `#KEY value` lines; `# text` is a comment.
fn header(text: &str) -> HashMap<&str, &str> {
    text.lines()
        .filter_map(|line| line.strip_prefix('#'))
        .filter(|line| line.starts_with(|c: char| c.is_ascii_uppercase()))
        .map(|line| line.split_once(char::is_whitespace).unwrap_or((line, "")))
        .map(|(key, value)| (key, value.trim()))
        .collect()
}

fn data_lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let lines = text.lines().enumerate().map(|(index, line)| (index + 1, line.trim()));
    lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'))
}

fn parse_row(line: usize, content: &str, length: usize) -> Result<Vec<f64>, FormatError> {
    let numbers: Result<Vec<f64>, _> = content.split_whitespace().map(str::parse).collect();
    match numbers {
        // Some files append measures of spread (#VS); they are not read.
        Ok(numbers) if numbers.len() >= length => Ok(numbers),
        _ => Err(FormatError::Line {
            line,
            found: quoted(content),
            expected: format!("{length} numbers"),
        }),
    }
}
