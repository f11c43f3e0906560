//! Tables of samples: numbers under a header that names columns and units, separated by commas or
//! by white space. Also the direction tables that commands exchange.

use std::fmt::Write as _;
use std::str::FromStr;

use brdf_model::{Channels, SampleSet};
use brdf_param::{DirectionPair, azimuth, polar_angle, spherical_direction};

use crate::error::{FormatError, quoted};
use crate::note::ReadNote;

/// The meaning of one column of a table, with its unit. In headers each has a name, such as `theta_i_deg` or
/// `value`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    /// Polar angle of the light.
    ThetaI(AngleUnit),
    /// Azimuth of the light.
    PhiI(AngleUnit),
    /// Polar angle of the viewer.
    ThetaO(AngleUnit),
    /// Azimuth of the viewer.
    PhiO(AngleUnit),
    /// Red, sr⁻¹.
    R,
    /// Green, sr⁻¹.
    G,
    /// Blue, sr⁻¹.
    B,
    /// The only channel, sr⁻¹.
    Value,
    /// Wavelength, micrometres.
    Wavelength,
}

/// Unit of the angles in a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AngleUnit {
    /// Degrees.
    Degrees,
    /// Radians.
    Radians,
}

impl AngleUnit {
    fn radians(self, angle: f64) -> f64 {
        match self {
            Self::Degrees => angle.to_radians(),
            Self::Radians => angle,
        }
    }
}

/// Names of the columns that a table may have.
const NAMES: [(&str, Column); 13] = [
    ("theta_i_deg", Column::ThetaI(AngleUnit::Degrees)),
    ("phi_i_deg", Column::PhiI(AngleUnit::Degrees)),
    ("theta_o_deg", Column::ThetaO(AngleUnit::Degrees)),
    ("phi_o_deg", Column::PhiO(AngleUnit::Degrees)),
    ("theta_i_rad", Column::ThetaI(AngleUnit::Radians)),
    ("phi_i_rad", Column::PhiI(AngleUnit::Radians)),
    ("theta_o_rad", Column::ThetaO(AngleUnit::Radians)),
    ("phi_o_rad", Column::PhiO(AngleUnit::Radians)),
    ("r", Column::R),
    ("g", Column::G),
    ("b", Column::B),
    ("value", Column::Value),
    ("wavelength_um", Column::Wavelength),
];

/// The names of all columns, for messages.
fn known_names() -> String {
    NAMES.map(|(name, _)| name).join(", ")
}

/// The meanings of columns, for files whose own names do not say them.
///
/// It is parsed from `meaning=name`, separated by commas.
///
/// ```
/// let map: brdf_io::ColumnMap =
///     "theta_i_deg=a,phi_i_deg=b,theta_o_deg=c,phi_o_deg=d,value=brdf".parse()?;
/// let (samples, _) = brdf_io::read_table("a b c d brdf\n30 0 30 180 0.2\n", Some(&map), None)?;
/// assert_eq!(samples.values(), [[0.2]]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ColumnMap(Vec<(Column, String)>);

impl FromStr for ColumnMap {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let entries: Result<Vec<_>, String> = text
            .split(',')
            .map(|entry| {
                let (meaning, name) = entry
                    .split_once('=')
                    .ok_or_else(|| format!("found {entry:?}; expected meaning=name"))?;
                let column = column_named(meaning.trim()).ok_or_else(|| {
                    format!("unknown meaning {meaning:?}; expected one of {}", known_names())
                })?;
                Ok((column, name.trim().to_owned()))
            })
            .collect();
        entries.map(Self)
    }
}

fn column_named(name: &str) -> Option<Column> {
    NAMES.iter().find(|(known, _)| *known == name).map(|(_, column)| *column)
}

/// Headers that are known although their names carry no units: NIST's Mueller BRDF files.
fn known_header(header: &[String]) -> Option<ColumnMap> {
    let lower: Vec<String> = header.iter().take(6).map(|name| name.to_lowercase()).collect();
    let [lambda, theta_i, phi_i, theta_r, phi_r, f11] = &lower[..] else { return None };
    let is_nist = lambda == "lambda"
        && theta_i == "thetai"
        && (phi_i == "phi" || phi_i == "phii")
        && theta_r == "thetar"
        && phi_r == "phir"
        && (f11 == "f_r11" || f11 == "fr11");
    is_nist.then(|| {
        let columns = [
            Column::Wavelength,
            Column::ThetaI(AngleUnit::Degrees),
            Column::PhiI(AngleUnit::Degrees),
            Column::ThetaO(AngleUnit::Degrees),
            Column::PhiO(AngleUnit::Degrees),
            Column::Value,
        ];
        ColumnMap(columns.into_iter().zip(header.iter().cloned()).collect())
    })
}

/// A header and where its data starts.
struct Table<'a> {
    header: Vec<String>,
    header_line: usize,
    text: &'a str,
}

/// There is a header and a first row of numbers.
pub(crate) fn looks_like_table(text: &str) -> bool {
    Table::new(text).is_ok()
}

impl<'a> Table<'a> {
    /// Finds the header: the last line before the first row of numbers, comment or not, with at
    /// least as many names as that row has numbers.
    fn new(text: &'a str) -> Result<Self, FormatError> {
        let missing = || FormatError::Missing {
            what: "header that names the columns".to_owned(),
            expected: "one line of names, then rows of numbers".to_owned(),
        };
        let mut header = None;
        for (index, line) in text.lines().enumerate() {
            let content = line.trim();
            let fields = split(content.trim_start_matches('#'));
            if fields.is_empty() {
                continue;
            }
            let is_data = !content.starts_with('#') && fields[0].parse::<f64>().is_ok();
            if is_data {
                let (names, header_line): (Vec<String>, usize) = header.ok_or_else(missing)?;
                if names.len() < fields.len() {
                    return Err(missing());
                }
                return Ok(Self { header: names, header_line, text });
            }
            header = Some((fields.into_iter().map(str::to_owned).collect(), index + 1));
        }
        // A header alone is a table without rows.
        let (header, header_line) = header.ok_or_else(missing)?;
        let named = header.iter().any(|name: &String| column_named(name).is_some());
        if named { Ok(Self { header, header_line, text }) } else { Err(missing()) }
    }

    /// Rows after the header, with their line numbers.
    fn rows(&self) -> impl Iterator<Item = (usize, &'a str)> {
        self.text
            .lines()
            .enumerate()
            .map(|(index, line)| (index + 1, line.trim()))
            .skip(self.header_line)
            .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'))
    }

    /// The positions of the columns that mean something.
    fn columns(&self, map: Option<&ColumnMap>) -> Result<Vec<(Column, usize)>, FormatError> {
        let place = |name: &str| {
            self.header.iter().position(|known| known == name).ok_or_else(|| FormatError::Columns {
                line: self.header_line,
                found: self.header.clone(),
                expected: format!("one named {name:?}"),
            })
        };
        match map.cloned().or_else(|| known_header(&self.header)) {
            Some(ColumnMap(entries)) => {
                entries.iter().map(|(column, name)| Ok((*column, place(name)?))).collect()
            }
            None => Ok(self
                .header
                .iter()
                .enumerate()
                .filter_map(|(index, name)| column_named(name).map(|column| (column, index)))
                .collect()),
        }
    }
}

/// Fields separated by commas, or by white space where there are none.
fn split(line: &str) -> Vec<&str> {
    if line.contains(',') {
        line.split(',').map(|field| field.trim().trim_matches('"')).collect()
    } else {
        line.split_whitespace().collect()
    }
}

/// One number of a row.
fn number(fields: &[&str], index: usize, line: usize) -> Result<f64, FormatError> {
    let field = fields.get(index).copied().unwrap_or("");
    field.parse().map_err(|_| FormatError::Line {
        line,
        found: if field.is_empty() { format!("{} fields", fields.len()) } else { quoted(field) },
        expected: format!("a number in column {}", index + 1),
    })
}

/// The places of the four angles and their units.
struct AngleColumns([(AngleUnit, usize); 4]);

impl AngleColumns {
    fn find(table: &Table<'_>, columns: &[(Column, usize)]) -> Result<Self, FormatError> {
        let pick = |wanted: fn(&Column) -> Option<AngleUnit>, name: &str| {
            columns
                .iter()
                .find_map(|(column, index)| wanted(column).map(|unit| (unit, *index)))
                .ok_or_else(|| FormatError::Columns {
                    line: table.header_line,
                    found: table.header.clone(),
                    expected: format!(
                        "one named {name}_deg or {name}_rad; names without a unit are not guessed"
                    ),
                })
        };
        Ok(Self([
            pick(|c| if let Column::ThetaI(u) = c { Some(*u) } else { None }, "theta_i")?,
            pick(|c| if let Column::PhiI(u) = c { Some(*u) } else { None }, "phi_i")?,
            pick(|c| if let Column::ThetaO(u) = c { Some(*u) } else { None }, "theta_o")?,
            pick(|c| if let Column::PhiO(u) = c { Some(*u) } else { None }, "phi_o")?,
        ]))
    }

    fn pair(&self, fields: &[&str], line: usize) -> Result<DirectionPair, FormatError> {
        let mut angles = [0.0; 4];
        for (angle, (unit, index)) in angles.iter_mut().zip(self.0) {
            *angle = unit.radians(number(fields, index, line)?);
        }
        let [theta_i, phi_i, theta_o, phi_o] = angles;
        Ok(DirectionPair::new(
            spherical_direction(theta_i, phi_i),
            spherical_direction(theta_o, phi_o),
        ))
    }
}

/// Reads the samples of a table with a header, and notes on what was chosen.
///
/// `map` says what the columns mean where their names don't. Of a table with wavelengths, the rows nearest to
/// `wavelength_um`, in micrometres, are taken; by default those nearest to 0.55 µm. Negative polar angles are
/// directions on the far side of the normal.
///
/// ```
/// let table = "theta_i_deg phi_i_deg theta_o_deg phi_o_deg value\n-20 0 20 0 0.3\n";
/// let (samples, _) = brdf_io::read_table(table, None, None)?;
/// assert!(samples.pair(0).wi.x < 0.0, "on the far side");
/// # Ok::<(), brdf_io::FormatError>(())
/// ```
///
/// # Errors
///
/// [`FormatError::Line`] for rows and headers that cannot be read.
pub fn read_table(
    text: &str,
    map: Option<&ColumnMap>,
    wavelength_um: Option<f64>,
) -> Result<(SampleSet, Vec<ReadNote>), FormatError> {
    let table = Table::new(text)?;
    let columns = table.columns(map)?;
    let angles = AngleColumns::find(&table, &columns)?;
    let place = |wanted: Column| columns.iter().find(|(c, _)| *c == wanted).map(|(_, i)| *i);
    let rgb = [Column::R, Column::G, Column::B].map(place);
    let values: Vec<usize> = match (rgb, place(Column::Value)) {
        ([Some(r), Some(g), Some(b)], _) => vec![r, g, b],
        (_, Some(value)) => vec![value],
        _ => {
            return Err(FormatError::Columns {
                line: table.header_line,
                found: table.header.clone(),
                expected: "r, g, b or one named value (in sr⁻¹)".to_owned(),
            });
        }
    };
    let mut notes = Vec::new();
    let chosen = match place(Column::Wavelength) {
        Some(index) => Some((index, choose_wavelength(&table, index, wavelength_um, &mut notes)?)),
        None => None,
    };
    let channels = if values.len() == 3 { Channels::Rgb } else { Channels::Luminance };
    let mut samples = SampleSet::new(channels);
    for (line, content) in table.rows() {
        let fields = split(content);
        if let Some((index, wavelength)) = chosen {
            let difference = (number(&fields, index, line)? - wavelength).abs();
            // Written so that a NaN wavelength is another wavelength.
            let same = difference <= 1e-9;
            if !same {
                continue;
            }
        }
        let pair = angles.pair(&fields, line)?;
        let row: Result<Vec<f64>, FormatError> =
            values.iter().map(|&index| number(&fields, index, line)).collect();
        samples.push(&pair, &row?);
    }
    Ok((samples, notes))
}

fn choose_wavelength(
    table: &Table<'_>,
    index: usize,
    wanted: Option<f64>,
    notes: &mut Vec<ReadNote>,
) -> Result<f64, FormatError> {
    let mut wavelengths = Vec::new();
    for (line, content) in table.rows() {
        let wavelength = number(&split(content), index, line)?;
        if !wavelengths.contains(&wavelength) {
            wavelengths.push(wavelength);
        }
    }
    let target = wanted.unwrap_or(0.55);
    let nearest = wavelengths
        .iter()
        .copied()
        .min_by(|a, b| (a - target).abs().total_cmp(&(b - target).abs()))
        .unwrap_or(target);
    notes.push(ReadNote::Wavelength { chosen_um: nearest, all_um: wavelengths });
    Ok(nearest)
}

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
    let angles = AngleColumns::find(&table, &table.columns(None)?)?;
    table
        .rows()
        .map(|(line, content)| {
            let fields = split(content);
            let pair = angles.pair(&fields, line)?;
            if !(pair.wi.is_finite() && pair.wo.is_finite()) {
                return Err(FormatError::Line {
                    line,
                    found: quoted(content),
                    expected: "finite angles".to_owned(),
                });
            }
            let shown = angles.0.map(|(unit, index)| match unit {
                AngleUnit::Degrees => fields[index].to_owned(),
                AngleUnit::Radians => {
                    number(&fields, index, line).unwrap_or(f64::NAN).to_degrees().to_string()
                }
            });
            Ok((pair, shown.join(",")))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commented_headers_and_swapped_names_need_a_map() {
        let text = "# a title of several words here\n# phi_i theta_i phi_o theta_o brdf\n\
                    75.0 -180.0 -20.0 0.0 0.5\n";
        let refused = read_table(text, None, None).unwrap_err().to_string();
        assert!(refused.contains("line 2") && refused.contains("theta_i_deg"), "{refused}");
        let map: ColumnMap = "theta_i_deg=phi_i,phi_i_deg=theta_i,theta_o_deg=phi_o,\
                              phi_o_deg=theta_o,value=brdf"
            .parse()
            .unwrap();
        let (samples, _) = read_table(text, Some(&map), None).unwrap();
        let pair = samples.pair(0);
        assert!((polar_angle(pair.wi).to_degrees() - 75.0).abs() < 1e-9);
        assert!(pair.wi.x < 0.0 && pair.wo.x < 0.0, "both on the far side: {pair:?}");
    }

    #[test]
    fn samples_survive_a_round_trip() {
        let mut samples = SampleSet::new(Channels::Rgb);
        let pair = DirectionPair::from_angles(0.3, 1.0, 1.2, -2.0);
        samples.push(&pair, &[0.1, 0.2, 1e-7]);
        let (read, _) = read_table(&write_samples(&samples), None, None).unwrap();
        assert!(read.pair(0).wi.distance(pair.wi) < 1e-15);
        assert_eq!(read.values(), samples.values());
    }

    #[test]
    fn a_word_among_numbers_is_named_with_its_line() {
        let text = "theta_i_deg,phi_i_deg,theta_o_deg,phi_o_deg,value\n1,2,3,4,5\n1,2,x,4,5\n";
        let message = read_table(text, None, None).unwrap_err().to_string();
        assert!(message.contains("line 3") && message.contains("\"x\""), "{message}");
    }
}
