//! The four angles of a row.

use brdf_param::{DirectionPair, spherical_direction};

use super::columns::{Angle, AngleUnit, Column, Guess, Source};
use super::dialect::{Row, Table};
use crate::error::FormatError;
use crate::note::ReadNote;

/// Places of the angles and their units.
pub(crate) struct AngleColumns([(AngleUnit, Source); 4]);

/// Fewest rows that tell a unit.
const ROWS: usize = 8;
/// What rounding may add to half a turn.
const SLACK: f64 = 1e-4;

impl AngleColumns {
    /// Returns the places of the angles among columns with a meaning, and in `guesses` those without a unit.
    pub(crate) fn find(
        table: &Table<'_>,
        columns: &[(Column, Source)],
        guesses: &[Option<Guess>],
        is_told: bool,
        notes: &mut Vec<ReadNote>,
    ) -> Result<Self, FormatError> {
        let known = |wanted: Angle| {
            columns.iter().find_map(|(column, source)| match column {
                Column::Angle(angle, unit) if *angle == wanted => Some((*unit, *source)),
                _ => None,
            })
        };
        let unitless: Vec<(Angle, usize)> = guesses
            .iter()
            .enumerate()
            .filter_map(|(index, guess)| match guess {
                Some(Guess::Unitless(angle)) if known(*angle).is_none() => Some((*angle, index)),
                _ => None,
            })
            .collect();
        let missing = |angle: Angle| {
            let name = angle.name();
            FormatError::Columns {
                line: table.header_line,
                found: table.header.clone(),
                expected: format!(
                    "one named {name}_deg or {name}_rad; names without a unit are not guessed"
                ),
            }
        };
        if !unitless.is_empty() {
            if !are_degrees(table, &unitless)? {
                let has_none = |angle: &Angle| unitless.iter().any(|(other, _)| other == angle);
                return Err(missing(
                    Angle::ALL.into_iter().find(has_none).unwrap_or(Angle::ThetaI),
                ));
            }
            notes.push(ReadNote::DegreesAssumed);
        }
        let place = |angle: Angle| {
            let guessed = unitless.iter().find(|(other, _)| *other == angle);
            known(angle).or(guessed.map(|(_, index)| (AngleUnit::Degrees, Source::At(*index))))
        };
        let azimuths = [Angle::PhiI, Angle::PhiO].map(place);
        let mut found = Angle::ALL.map(place);
        if azimuths.iter().all(Option::is_none)
            && let Some((unit, Source::At(index))) = place(Angle::ThetaO)
            && let Some(_) = place(Angle::ThetaI)
            && any_is_negative(table, index)?
        {
            for azimuth in [1, 3] {
                found[azimuth] = Some((unit, Source::Constant(0.0)));
            }
            notes.push(ReadNote::InPlane);
        }
        let mut places = [(AngleUnit::Degrees, Source::Constant(0.0)); 4];
        for ((place, found), angle) in places.iter_mut().zip(found).zip(Angle::ALL) {
            *place = found.ok_or_else(|| missing(angle))?;
        }
        let made = Self(places);
        if !is_told {
            made.check_not_radians(table)?;
        }
        Ok(made)
    }

    /// Returns the directions of a row.
    pub(crate) fn pair(
        &self,
        table: &Table<'_>,
        row: &Row<'_>,
    ) -> Result<DirectionPair, FormatError> {
        let mut radians = [0.0; 4];
        for ((radians, (unit, source)), angle) in radians.iter_mut().zip(self.0).zip(Angle::ALL) {
            let found = number(table, row, source)?;
            let most = unit.half_turn() * if angle.is_polar() { 1.0 } else { 4.0 };
            if found.abs() > most * (1.0 + SLACK) {
                let fits = found.abs() <= unit.other().half_turn() && unit == AngleUnit::Radians;
                return Err(FormatError::Line {
                    line: row.line,
                    found: format!("{} of {found} {}", angle.name(), unit.name()),
                    expected: format!(
                        "at most {most:.4}{}",
                        if fits { "; are these degrees?" } else { "" }
                    ),
                });
            }
            *radians = unit.radians(found);
        }
        let [theta_i, phi_i, theta_o, phi_o] = radians;
        Ok(DirectionPair::new(
            spherical_direction(theta_i, phi_i),
            spherical_direction(theta_o, phi_o),
        ))
    }

    /// Returns the angles of a row in degrees, as text.
    pub(crate) fn degrees(&self, table: &Table<'_>, row: &Row<'_>) -> String {
        let shown = self.0.map(|(unit, source)| match (unit, source) {
            (AngleUnit::Degrees, Source::At(index)) if !table.dialect.decimal_comma => {
                row.fields[index].clone().into_owned()
            }
            (AngleUnit::Degrees, source) => {
                number(table, row, source).unwrap_or(f64::NAN).to_string()
            }
            (AngleUnit::Radians, source) => {
                number(table, row, source).unwrap_or(f64::NAN).to_degrees().to_string()
            }
        });
        shown.join(",")
    }

    /// Radians in columns that are called degrees: all angles are tiny then.
    fn check_not_radians(&self, table: &Table<'_>) -> Result<(), FormatError> {
        use std::f64::consts::{FRAC_PI_2, TAU};
        let is_called_degrees = |(unit, source): &(AngleUnit, Source)| {
            *unit == AngleUnit::Degrees && matches!(source, Source::At(_))
        };
        if !self.0.iter().all(is_called_degrees) {
            return Ok(());
        }
        let (mut rows, mut largest) = (0, [0.0_f64; 4]);
        for row in table.rows() {
            for (largest, (_, source)) in largest.iter_mut().zip(self.0) {
                *largest = largest.max(number(table, &row, source)?.abs());
            }
            rows += 1;
        }
        let [theta_i, phi_i, theta_o, phi_o] = largest;
        let is_tiny = theta_i.max(theta_o) <= FRAC_PI_2 * (1.0 + SLACK)
            && phi_i.max(phi_o) <= TAU * (1.0 + SLACK);
        // What lies within a degree and a half of the normal could be meant; then azimuths are large.
        if rows >= ROWS && is_tiny && theta_i.min(theta_o) > 0.2 {
            return Err(FormatError::Columns {
                line: table.header_line,
                found: table.header.clone(),
                expected: format!(
                    "polar angles beyond {:.3} degrees, which is the largest; are these radians?",
                    theta_i.max(theta_o)
                ),
            });
        }
        Ok(())
    }
}

/// The number of a row from where it comes.
pub(crate) fn number(table: &Table<'_>, row: &Row<'_>, source: Source) -> Result<f64, FormatError> {
    match source {
        Source::At(index) => table.number(row, index),
        Source::Constant(value) => Ok(value),
    }
}

/// Angles without a unit are degrees where they are too large for radians. Some call the polar angle φ: azimuths have to be
/// too large for that.
fn are_degrees(table: &Table<'_>, columns: &[(Angle, usize)]) -> Result<bool, FormatError> {
    /// Beyond any polar angle above the horizon.
    const BEYOND: f64 = 90.5;
    let (mut polar, mut azimuth) = (0.0_f64, 0.0_f64);
    for row in table.rows() {
        for &(angle, index) in columns {
            let largest = if angle.is_polar() { &mut polar } else { &mut azimuth };
            *largest = largest.max(table.number(&row, index)?.abs());
        }
    }
    let has_azimuths = columns.iter().any(|(angle, _)| !angle.is_polar());
    let are_told_apart = !has_azimuths || azimuth > BEYOND;
    Ok(are_told_apart && polar <= BEYOND && polar.max(azimuth) > 4.0 * std::f64::consts::PI)
}

fn any_is_negative(table: &Table<'_>, index: usize) -> Result<bool, FormatError> {
    for row in table.rows() {
        if table.number(&row, index)? < 0.0 {
            return Ok(true);
        }
    }
    Ok(false)
}
