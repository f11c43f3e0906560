//! The direction tables that commands exchange.

use std::fmt::Write as _;

use brdf_model::{Channels, SampleSet};
use brdf_param::{DirectionPair, azimuth, polar_angle};

use super::angles::AngleColumns;
use super::dialect::Table;
use super::samples::meanings;
use crate::error::{FormatError, quoted};

/// Reads the four angle columns of a table, in the order of its rows, and nothing else.
///
/// Returns each pair of directions with the text of its four angles in degrees, as found.
///
/// ```
/// let table = format!("{}\n30,0,60,180\n", brdf_io::direction_table_header(false));
/// let rows = brdf_io::direction_rows(&table)?;
/// assert_eq!(rows[0].1, "30,0,60,180");
/// assert!((rows[0].0.wo.z - 0.5).abs() < 1e-12);
/// # Ok::<(), brdf_io::FormatError>(())
/// ```
///
/// # Errors
///
/// [`FormatError::Line`]; [`FormatError::Missing`].
pub fn direction_rows(text: &str) -> Result<Vec<(DirectionPair, String)>, FormatError> {
    let table = Table::new(text)?;
    let (columns, guesses) = meanings(&table, None)?;
    // What directions are meant is up to who asks, so that small angles are taken at their word.
    let angles = AngleColumns::find(&table, &columns, &guesses, true, &mut Vec::new())?;
    table
        .rows()
        .map(|row| {
            let pair = angles.pair(&table, &row)?;
            if !(pair.wi.is_finite() && pair.wo.is_finite()) {
                return Err(FormatError::Line {
                    line: row.line,
                    found: quoted(&row.fields.join(",")),
                    expected: "finite angles".to_owned(),
                });
            }
            Ok((pair, angles.degrees(&table, &row)))
        })
        .collect()
}

/// Returns the header of tables that name directions and, where `values` is set, RGB values.
pub fn direction_table_header(values: bool) -> &'static str {
    if values {
        "theta_i_deg,phi_i_deg,theta_o_deg,phi_o_deg,r,g,b"
    } else {
        "theta_i_deg,phi_i_deg,theta_o_deg,phi_o_deg"
    }
}

/// Writes a set of samples as a table, separated by commas, angles in degrees; samples of one channel have one
/// column `value`.
///
/// ```
/// use brdf_model::{Channels, SampleSet};
/// use brdf_param::DirectionPair;
///
/// let mut samples = SampleSet::new(Channels::Luminance);
/// samples.push(&DirectionPair::from_angles(0.0, 0.0, 0.0, 0.0), &[0.25]);
/// let text = brdf_io::write_samples(&samples);
/// assert!(text.starts_with("theta_i_deg,phi_i_deg,theta_o_deg,phi_o_deg,value\n"));
/// ```
pub fn write_samples(samples: &SampleSet) -> String {
    let mut text = String::from(direction_table_header(false));
    text.push_str(match samples.channels() {
        Channels::Rgb => ",r,g,b\n",
        Channels::Luminance => ",value\n",
    });
    for (index, pair) in samples.pairs().enumerate() {
        let angles = [pair.wi, pair.wo].map(|w| [polar_angle(w), azimuth(w)]);
        let degrees = angles.as_flattened().iter().map(|a| a.to_degrees());
        let values = samples.values().iter().map(|channel| channel[index]);
        let row: Vec<String> = degrees.chain(values).map(|v| v.to_string()).collect();
        // Writing into a string cannot fail.
        let _ = writeln!(text, "{}", row.join(","));
    }
    text
}
