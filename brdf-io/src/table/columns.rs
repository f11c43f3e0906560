//! What the columns of a table mean, by their names or as a user says.

use std::str::FromStr;

use super::dialect::Table;
use crate::error::FormatError;

/// The meaning of one column of a table, with its unit. In headers each has a name, such as `theta_i_deg` or
/// `value`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    /// An angle.
    Angle(Angle, AngleUnit),
    /// Red, sr⁻¹.
    R,
    /// Green, sr⁻¹.
    G,
    /// Blue, sr⁻¹.
    B,
    /// The only channel, sr⁻¹.
    Value,
    /// The only channel, times the cosine of the viewer.
    ValueCosine,
    /// Wavelength.
    Wavelength(LengthUnit),
}

/// One of the angles of a pair of directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Angle {
    /// Polar angle of the light.
    ThetaI,
    /// Azimuth of the light.
    PhiI,
    /// Polar angle of the viewer.
    ThetaO,
    /// Azimuth of the viewer.
    PhiO,
}

/// Unit of the angles in a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AngleUnit {
    /// Degrees.
    Degrees,
    /// Radians.
    Radians,
}

/// Unit of wavelengths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LengthUnit {
    /// Micrometres.
    Micrometres,
    /// Nanometres.
    Nanometres,
}

impl AngleUnit {
    pub(crate) fn radians(self, angle: f64) -> f64 {
        match self {
            Self::Degrees => angle.to_radians(),
            Self::Radians => angle,
        }
    }

    /// Half a turn.
    pub(crate) fn half_turn(self) -> f64 {
        match self {
            Self::Degrees => 180.0,
            Self::Radians => std::f64::consts::PI,
        }
    }

    pub(crate) fn other(self) -> Self {
        match self {
            Self::Degrees => Self::Radians,
            Self::Radians => Self::Degrees,
        }
    }

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Degrees => "degrees",
            Self::Radians => "radians",
        }
    }
}

impl LengthUnit {
    pub(crate) fn micrometres(self, length: f64) -> f64 {
        match self {
            Self::Micrometres => length,
            Self::Nanometres => length * 1e-3,
        }
    }
}

impl Angle {
    pub(crate) const ALL: [Self; 4] = [Self::ThetaI, Self::PhiI, Self::ThetaO, Self::PhiO];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::ThetaI => "theta_i",
            Self::PhiI => "phi_i",
            Self::ThetaO => "theta_o",
            Self::PhiO => "phi_o",
        }
    }

    pub(crate) fn is_polar(self) -> bool {
        matches!(self, Self::ThetaI | Self::ThetaO)
    }

    /// Names that people give it, without separators and unit.
    fn others(self) -> &'static [&'static str] {
        match self {
            Self::ThetaI => {
                &["thetai", "thetain", "incidentangle", "incidenceangle", "angleofincidence"]
            }
            Self::PhiI => &["phii", "phiin"],
            Self::ThetaO => &[
                "thetao",
                "thetaout",
                "thetar",
                "thetas",
                "thetav",
                "measureangle",
                "measurementangle",
                "scatterangle",
                "viewangle",
            ],
            Self::PhiO => &["phio", "phiout", "phir", "phis", "phiv"],
        }
    }
}

/// Names of the columns that a table may have.
const NAMES: [(&str, Column); 15] = {
    use AngleUnit::{Degrees, Radians};
    [
        ("theta_i_deg", Column::Angle(Angle::ThetaI, Degrees)),
        ("phi_i_deg", Column::Angle(Angle::PhiI, Degrees)),
        ("theta_o_deg", Column::Angle(Angle::ThetaO, Degrees)),
        ("phi_o_deg", Column::Angle(Angle::PhiO, Degrees)),
        ("theta_i_rad", Column::Angle(Angle::ThetaI, Radians)),
        ("phi_i_rad", Column::Angle(Angle::PhiI, Radians)),
        ("theta_o_rad", Column::Angle(Angle::ThetaO, Radians)),
        ("phi_o_rad", Column::Angle(Angle::PhiO, Radians)),
        ("r", Column::R),
        ("g", Column::G),
        ("b", Column::B),
        ("value", Column::Value),
        ("value_cos", Column::ValueCosine),
        ("wavelength_um", Column::Wavelength(LengthUnit::Micrometres)),
        ("wavelength_nm", Column::Wavelength(LengthUnit::Nanometres)),
    ]
};

/// The names of all columns, for messages.
pub(crate) fn known_names() -> String {
    NAMES.map(|(name, _)| name).join(", ")
}

/// Whether a name is one of those that say everything.
pub(crate) fn is_exact(name: &str) -> bool {
    column_named(name).is_some()
}

fn column_named(name: &str) -> Option<Column> {
    NAMES.iter().find(|(known, _)| *known == name).map(|(_, column)| *column)
}

/// What a column of a header is taken for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Guess {
    Column(Column),
    /// An angle whose unit its name does not say.
    Unitless(Angle),
    /// Values at a wavelength, nanometres.
    Band(f64),
}

/// What a name means, with the unit of a line of units, if there is one.
pub(crate) fn guess(name: &str, unit: &str) -> Option<Guess> {
    if let Some(column) = column_named(name) {
        return Some(Guess::Column(column));
    }
    let lower = name.to_lowercase();
    if let Some(nanometres) = band(&lower) {
        return Some(Guess::Band(nanometres));
    }
    let (stem, own_unit) = without_unit(&lower);
    let unit = if own_unit.is_empty() { unit.trim().to_lowercase() } else { own_unit };
    let stem: String = stem.chars().filter(|c| c.is_alphanumeric()).collect();
    if let Some(angle) = Angle::ALL.into_iter().find(|a| a.others().contains(&stem.as_str())) {
        return Some(match unit.trim_matches(|c: char| !c.is_alphanumeric() && c != '°') {
            "deg" | "degree" | "degrees" | "°" => {
                Guess::Column(Column::Angle(angle, AngleUnit::Degrees))
            }
            "rad" | "radian" | "radians" => Guess::Column(Column::Angle(angle, AngleUnit::Radians)),
            _ => Guess::Unitless(angle),
        });
    }
    let column = match (stem.as_str(), unit.as_str()) {
        ("r" | "red", _) => Column::R,
        ("g" | "green", _) => Column::G,
        ("b" | "blue", _) => Column::B,
        ("value" | "brdf" | "bsdf" | "fr", _) => Column::Value,
        ("wavelength" | "lambda", "nm") => Column::Wavelength(LengthUnit::Nanometres),
        ("wavelength" | "lambda", "um" | "µm" | "μm") => {
            Column::Wavelength(LengthUnit::Micrometres)
        }
        _ => return None,
    };
    Some(Guess::Column(column))
}

/// A name and the unit behind it: in parentheses or brackets, or after an underscore.
fn without_unit(name: &str) -> (&str, String) {
    if let Some((stem, unit)) = name.split_once(['(', '[']) {
        return (stem, unit.trim_matches(|c| matches!(c, ')' | ']' | ' ')).to_owned());
    }
    for unit in ["deg", "rad", "nm", "um", "µm"] {
        if let Some(stem) = name.strip_suffix(unit).and_then(|stem| stem.strip_suffix(['_', ' '])) {
            return (stem, unit.to_owned());
        }
    }
    (name, String::new())
}

/// The nanometres of names such as `450 nm` and `0.45um`.
fn band(name: &str) -> Option<f64> {
    let of = |unit: &str, factor: f64| {
        let number: f64 = name.trim().strip_suffix(unit)?.trim().parse().ok()?;
        Some(number * factor)
    };
    let found = of("nm", 1.0).or_else(|| of("um", 1e3)).or_else(|| of("µm", 1e3));
    found.filter(|length| (100.0..1e5).contains(length))
}

/// The meanings of columns, for files whose own names do not say them.
///
/// It is parsed from `meaning=name`, separated by commas. In place of a name, `#3` is the third column, and a number that
/// no column is named by is the value of an angle in all rows.
///
/// ```
/// let columns: brdf_io::ColumnMap = "theta_i_deg=a,theta_o_deg=#2,phi_i_deg=0,phi_o_deg=180,value=brdf".parse()?;
/// let options = brdf_io::TableOptions { columns: Some(columns), ..Default::default() };
/// let (samples, _) = brdf_io::read_table("a b brdf\n30 40 0.2\n", &options)?;
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

/// Where a number of each row comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Source {
    /// A column.
    At(usize),
    /// The same number in all rows.
    Constant(f64),
}

impl ColumnMap {
    /// Returns where each meaning stands in a table.
    pub(crate) fn places(&self, table: &Table<'_>) -> Result<Vec<(Column, Source)>, FormatError> {
        let place = |column: Column, name: &str| {
            let by_number = name.strip_prefix('#').and_then(|number| number.parse::<usize>().ok());
            if let Some(number) = by_number.filter(|number| *number > 0) {
                return Ok(Source::At(number - 1));
            }
            if let Some(index) = table.header.iter().position(|known| known == name) {
                return Ok(Source::At(index));
            }
            match (column, name.parse::<f64>()) {
                (Column::Angle(..), Ok(constant)) if constant.is_finite() => {
                    Ok(Source::Constant(constant))
                }
                _ => Err(FormatError::Columns {
                    line: table.header_line,
                    found: table.header.clone(),
                    expected: format!("one named {name:?}"),
                }),
            }
        };
        self.0.iter().map(|(column, name)| Ok((*column, place(*column, name)?))).collect()
    }
}

/// Which rows of a table are taken: those with a value in a column, or with any value there.
///
/// It is parsed from `name=value`; numbers are compared as numbers. The value `any` takes all rows.
///
/// ```
/// let rows: brdf_io::RowChoice = "wavelength_nm=550".parse()?;
/// assert_eq!(rows.column, "wavelength_nm");
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RowChoice {
    /// Name of the column.
    pub column: String,
    /// What stands there, or `any`.
    pub value: String,
}

impl FromStr for RowChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (column, value) =
            text.split_once('=').ok_or_else(|| format!("found {text:?}; expected name=value"))?;
        Ok(Self { column: column.trim().to_owned(), value: value.trim().to_owned() })
    }
}

/// Headers that are known although their names carry no units: NIST's Mueller BRDF files.
pub(crate) fn known_header(header: &[String]) -> Option<ColumnMap> {
    let lower: Vec<String> = header.iter().take(6).map(|name| name.to_lowercase()).collect();
    let [lambda, theta_i, phi_i, theta_r, phi_r, f11] = &lower[..] else { return None };
    let is_nist = lambda == "lambda"
        && theta_i == "thetai"
        && (phi_i == "phi" || phi_i == "phii")
        && theta_r == "thetar"
        && phi_r == "phir"
        && (f11 == "f_r11" || f11 == "fr11");
    is_nist.then(|| {
        let angles = Angle::ALL.map(|angle| Column::Angle(angle, AngleUnit::Degrees));
        let columns = [Column::Wavelength(LengthUnit::Micrometres)].into_iter();
        let columns = columns.chain(angles).chain([Column::Value]);
        ColumnMap(columns.zip(header.iter().cloned()).collect())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_people_write_are_known() {
        let degrees = |angle| Some(Guess::Column(Column::Angle(angle, AngleUnit::Degrees)));
        for (name, unit, meaning) in [
            ("theta_i_deg", "", degrees(Angle::ThetaI)),
            ("Theta I (deg)", "", degrees(Angle::ThetaI)),
            ("theta_r", "deg", degrees(Angle::ThetaO)),
            ("PhiS [°]", "", degrees(Angle::PhiO)),
            ("Incident_angle", "", Some(Guess::Unitless(Angle::ThetaI))),
            ("Red", "1/sr", Some(Guess::Column(Column::R))),
            ("BSDF [1/sr]", "", Some(Guess::Column(Column::Value))),
            ("450 nm", "", Some(Guess::Band(450.0))),
            ("0.45um", "", Some(Guess::Band(450.0))),
            ("Lambda", "nm", Some(Guess::Column(Column::Wavelength(LengthUnit::Nanometres)))),
            ("sigma", "", None),
            ("450", "", None),
        ] {
            assert_eq!(guess(name, unit), meaning, "{name} {unit}");
        }
    }
}
