//! The samples of a table.

use std::collections::BTreeSet;

use brdf_model::{Channels, SampleSet};

use super::angles::{AngleColumns, number};
use super::columns::{
    Column, ColumnMap, Guess, LengthUnit, RowChoice, Source, guess, known_header,
};
use super::dialect::{Row, Table};
use super::repeats::{Repeats, telling_apart};
use crate::error::FormatError;
use crate::note::ReadNote;
use crate::spectrum::SpectrumToRgb;

/// What a table itself may not say.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TableOptions {
    /// What the columns mean; by default as their names say.
    pub columns: Option<ColumnMap>,
    /// Which rows are taken; by default all.
    pub rows: Vec<RowChoice>,
    /// Of a table of several wavelengths, the one to take, in micrometres: the nearest, by default to 0.55 µm where
    /// each row has its own, and all together as a colour where each has a column.
    pub wavelength_um: Option<f64>,
}

/// Reads the samples of a table, and notes on what was assumed.
///
/// Separators, decimal marks, comments, the header and a line of units below it are found by what is there. Angles have
/// the unit that their name says, or degrees where they have none and are too large for radians. Negative polar angles
/// are directions on the far side of the normal; where there are some and no azimuths, all rows are in one plane.
/// Columns of several wavelengths become colours.
///
/// ```
/// use brdf_io::{TableOptions, read_table};
///
/// let table = "theta_i_deg phi_i_deg theta_o_deg phi_o_deg value\n-20 0 20 0 0.3\n";
/// let (samples, _) = read_table(table, &TableOptions::default())?;
/// assert!(samples.pair(0).wi.x < 0.0, "on the far side");
/// # Ok::<(), brdf_io::FormatError>(())
/// ```
///
/// # Errors
///
/// [`FormatError::Line`] for rows and headers that cannot be read, [`FormatError::Columns`] for columns without a
/// meaning, [`FormatError::SeveralMaterials`] for rows that only a column without a meaning tells apart.
pub fn read_table(
    text: &str,
    options: &TableOptions,
) -> Result<(SampleSet, Vec<ReadNote>), FormatError> {
    let table = Table::new(text)?;
    let mut notes: Vec<ReadNote> = table.dialect.note().into_iter().collect();
    let (columns, guesses) = meanings(&table, options.columns.as_ref())?;
    let is_told = options.columns.is_some();
    let angles = AngleColumns::find(&table, &columns, &guesses, is_told, &mut notes)?;
    let values = Values::find(&table, &columns, &guesses, options.wavelength_um)?;
    let chosen = Chosen::new(&table, &options.rows)?;
    let wavelength = columns.iter().find_map(|(column, source)| match column {
        Column::Wavelength(unit) => Some((*unit, *source)),
        _ => None,
    });
    let wavelength = match wavelength {
        Some((unit, source)) => {
            let picked = choose_wavelength(&table, &chosen, (unit, source), options.wavelength_um)?;
            notes.push(picked.1);
            Some((unit, source, picked.0))
        }
        None => None,
    };
    if let (Some(wanted), None, false) = (options.wavelength_um, wavelength, values.has_bands()) {
        return Err(FormatError::Missing {
            what: format!("wavelengths, of which {wanted} µm could be one"),
            expected: "a column of wavelengths, or one for each of them".to_owned(),
        });
    }

    let mut samples = SampleSet::new(values.channels());
    let mut repeats = Repeats::default();
    let mut kept: Vec<Row<'_>> = Vec::new();
    let mut moved = 0;
    for row in table.rows().filter(|row| chosen.takes(&table, row)) {
        if let Some((unit, source, wanted)) = wavelength {
            let difference = (unit.micrometres(number(&table, &row, source)?) - wanted).abs();
            // Written so that a NaN wavelength is another wavelength.
            let same = difference <= 1e-9;
            if !same {
                continue;
            }
        }
        let pair = angles.pair(&table, &row)?;
        let (value, was_moved) = values.read(&table, &row, pair.wo.z)?;
        moved += usize::from(was_moved);
        repeats.add(&pair, &value, kept.len());
        samples.push(&pair, &value);
        kept.push(row);
    }
    let used = used_columns(&columns, &guesses, &options.rows, &table);
    if let Some(apart) = telling_apart(&table, &kept, &repeats, &used) {
        return Err(apart);
    }
    notes.extend(values.note());
    if moved > 0 {
        notes.push(ReadNote::MovedIntoGamut { moved, colours: kept.len() });
    }
    notes.extend(repeats.note());
    Ok((samples, notes))
}

/// Columns with their meanings.
type Meanings = Vec<(Column, Source)>;

/// Returns where each meaning stands, and what every column of the header is taken for.
pub(crate) fn meanings(
    table: &Table<'_>,
    map: Option<&ColumnMap>,
) -> Result<(Meanings, Vec<Option<Guess>>), FormatError> {
    let told = map.cloned().or_else(|| known_header(&table.header));
    if let Some(map) = told {
        return Ok((map.places(table)?, vec![None; table.header.len()]));
    }
    if table.header.is_empty() {
        return Err(FormatError::Missing {
            what: "header that names the columns".to_owned(),
            expected: "one line of names, or columns by number, such as theta_i_deg=#1".to_owned(),
        });
    }
    let unit = |index: usize| table.units.get(index).map_or("", String::as_str);
    let names = table.header.iter().enumerate();
    let guesses: Vec<Option<Guess>> = names.map(|(index, name)| guess(name, unit(index))).collect();
    let columns: Meanings = guesses
        .iter()
        .enumerate()
        .filter_map(|(index, guess)| match guess {
            Some(Guess::Column(column)) => Some((*column, Source::At(index))),
            _ => None,
        })
        .collect();
    for (index, (column, _)) in columns.iter().enumerate() {
        if columns[..index].iter().any(|(other, _)| other == column) {
            return Err(FormatError::Columns {
                line: table.header_line,
                found: table.header.clone(),
                expected: "every meaning once".to_owned(),
            });
        }
    }
    Ok((columns, guesses))
}

/// Where the values of a row stand.
enum Values {
    /// One channel, or three.
    Channels(Vec<Source>),
    /// One channel times the cosine of the viewer.
    Cosine(Source),
    /// One for each wavelength, in ascending order.
    Bands { places: Vec<usize>, nanometres: Vec<f64>, to_rgb: SpectrumToRgb },
    /// The one of several wavelengths that was asked for.
    Band { place: usize, chosen: f64, all: Vec<f64>, wanted: f64 },
}

impl Values {
    fn find(
        table: &Table<'_>,
        columns: &[(Column, Source)],
        guesses: &[Option<Guess>],
        wavelength_um: Option<f64>,
    ) -> Result<Self, FormatError> {
        let place = |wanted: Column| columns.iter().find(|(c, _)| *c == wanted).map(|(_, s)| *s);
        if let [Some(r), Some(g), Some(b)] = [Column::R, Column::G, Column::B].map(place) {
            return Ok(Self::Channels(vec![r, g, b]));
        }
        if let Some(value) = place(Column::Value) {
            return Ok(Self::Channels(vec![value]));
        }
        if let Some(value) = place(Column::ValueCosine) {
            return Ok(Self::Cosine(value));
        }
        let mut bands: Vec<(f64, usize)> = guesses
            .iter()
            .enumerate()
            .filter_map(|(index, guess)| match guess {
                Some(Guess::Band(nanometres)) => Some((*nanometres, index)),
                _ => None,
            })
            .collect();
        bands.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (nanometres, places): (Vec<f64>, Vec<usize>) = bands.iter().copied().unzip();
        if let Some(wanted) = wavelength_um.filter(|_| !bands.is_empty()) {
            let near = |band: &&(f64, usize)| (band.0 * 1e-3 - wanted).abs();
            let nearest = bands.iter().min_by(|a, b| near(a).total_cmp(&near(b)));
            let (chosen, place) = nearest.copied().unwrap_or_default();
            let micrometres = |nanometres: f64| nanometres * 1e-3;
            let all = nanometres.into_iter().map(micrometres).collect();
            return Ok(Self::Band { place, chosen: micrometres(chosen), all, wanted });
        }
        match SpectrumToRgb::new(&nanometres) {
            Some(to_rgb) => Ok(Self::Bands { places, nanometres, to_rgb }),
            None if bands.len() == 1 => Ok(Self::Channels(vec![Source::At(places[0])])),
            None => Err(FormatError::Columns {
                line: table.header_line,
                found: table.header.clone(),
                expected: "r, g, b or one named value (in sr⁻¹), or one for each wavelength, such as \"550 nm\""
                    .to_owned(),
            }),
        }
    }

    fn channels(&self) -> Channels {
        match self {
            Self::Channels(places) if places.len() == 3 => Channels::Rgb,
            Self::Bands { .. } => Channels::Rgb,
            _ => Channels::Luminance,
        }
    }

    fn has_bands(&self) -> bool {
        matches!(self, Self::Bands { .. } | Self::Band { .. })
    }

    /// Returns the values of a row, and whether its colour was moved into the gamut.
    fn read(
        &self,
        table: &Table<'_>,
        row: &Row<'_>,
        cos_theta_o: f64,
    ) -> Result<(Vec<f64>, bool), FormatError> {
        Ok(match self {
            Self::Channels(places) => {
                let values = places.iter().map(|&source| number(table, row, source));
                (values.collect::<Result<_, _>>()?, false)
            }
            Self::Cosine(source) => (vec![number(table, row, *source)? / cos_theta_o], false),
            Self::Band { place, .. } => (vec![table.number(row, *place)?], false),
            Self::Bands { places, to_rgb, .. } => {
                let spectrum = places.iter().map(|&index| table.number(row, index));
                let spectrum: Vec<f64> = spectrum.collect::<Result<_, _>>()?;
                let (colour, was_moved) = to_rgb.rgb_in_gamut(&spectrum);
                (colour.channels().to_vec(), was_moved)
            }
        })
    }

    fn note(&self) -> Option<ReadNote> {
        match self {
            Self::Channels(_) => None,
            Self::Cosine(_) => Some(ReadNote::CosineDividedOut),
            Self::Bands { nanometres, .. } => Some(ReadNote::Spectra {
                wavelengths: nanometres.len(),
                range_nm: [nanometres[0], nanometres[nanometres.len() - 1]],
            }),
            Self::Band { chosen, all, wanted, .. } => Some(ReadNote::Wavelength {
                chosen_um: *chosen,
                all_um: all.clone(),
                wanted_um: Some(*wanted),
            }),
        }
    }
}

/// Rows that are taken.
struct Chosen<'a> {
    by: Vec<(usize, &'a str)>,
}

impl<'a> Chosen<'a> {
    fn new(table: &Table<'_>, choices: &'a [RowChoice]) -> Result<Self, FormatError> {
        let place = |choice: &'a RowChoice| {
            let named = |same: fn(&str, &str) -> bool| {
                table.header.iter().position(|name| same(name, &choice.column))
            };
            let index = named(|a, b| a == b).or_else(|| named(|a, b| a.eq_ignore_ascii_case(b)));
            let index = index.ok_or_else(|| FormatError::Columns {
                line: table.header_line,
                found: table.header.clone(),
                expected: format!("one named {:?}", choice.column),
            })?;
            Ok((index, choice.value.as_str()))
        };
        let by = choices.iter().map(place).collect::<Result<Vec<_>, FormatError>>()?;
        let chosen = Self { by };
        for &(index, value) in &chosen.by {
            let has_some = table.rows().any(|row| matches(table, &row, index, value));
            if !has_some {
                let fields = table.rows().filter_map(|row| {
                    row.fields.get(index).map(|field| field.clone().into_owned())
                });
                let all: BTreeSet<String> = fields.collect();
                return Err(FormatError::Missing {
                    what: format!("row with {value} in column {:?}", table.header[index]),
                    expected: listed(all.into_iter().collect()),
                });
            }
        }
        Ok(chosen)
    }

    fn takes(&self, table: &Table<'_>, row: &Row<'_>) -> bool {
        self.by.iter().all(|&(index, value)| matches(table, row, index, value))
    }
}

fn matches(table: &Table<'_>, row: &Row<'_>, index: usize, wanted: &str) -> bool {
    let Some(field) = row.fields.get(index) else { return false };
    let numbers = [field.as_ref(), wanted].map(|text| table.dialect.parse(text));
    match numbers {
        _ if wanted == "any" => true,
        [Some(a), Some(b)] => (a - b).abs() <= 1e-6 * a.abs().max(b.abs()),
        _ => field == wanted,
    }
}

/// One of some values, as a message says it.
pub(crate) fn listed(mut values: Vec<String>) -> String {
    const SHOWN: usize = 8;
    let more = values.len().saturating_sub(SHOWN);
    values.truncate(SHOWN);
    let list = values.join(", ");
    if more > 0 { format!("one of {list} and {more} more") } else { format!("one of {list}") }
}

/// Indices of the columns that something is made of, or that rows were chosen by.
fn used_columns(
    columns: &[(Column, Source)],
    guesses: &[Option<Guess>],
    rows: &[RowChoice],
    table: &Table<'_>,
) -> Vec<usize> {
    let meant = columns.iter().filter_map(|(_, source)| match source {
        Source::At(index) => Some(*index),
        Source::Constant(_) => None,
    });
    let guessed = guesses.iter().enumerate().filter(|(_, guess)| guess.is_some());
    let chosen = table
        .header
        .iter()
        .enumerate()
        .filter(|(_, name)| rows.iter().any(|choice| choice.column.eq_ignore_ascii_case(name)));
    let chosen = chosen.map(|(index, _)| index);
    meant.chain(guessed.map(|(index, _)| index)).chain(chosen).collect()
}

/// The wavelength nearest to the wanted one, and what is to be said of it.
fn choose_wavelength(
    table: &Table<'_>,
    chosen: &Chosen<'_>,
    (unit, source): (LengthUnit, Source),
    wanted: Option<f64>,
) -> Result<(f64, ReadNote), FormatError> {
    let mut wavelengths: Vec<f64> = Vec::new();
    for row in table.rows().filter(|row| chosen.takes(table, row)) {
        let found = number(table, &row, source)?;
        let range = match unit {
            LengthUnit::Micrometres => 0.1..=100.0,
            LengthUnit::Nanometres => 100.0..=1e5,
        };
        if !range.contains(&found) && !found.is_nan() {
            let (name, other) = match unit {
                LengthUnit::Micrometres => ("µm", "nm"),
                LengthUnit::Nanometres => ("nm", "µm"),
            };
            return Err(FormatError::Line {
                line: row.line,
                found: format!("a wavelength of {found} {name}"),
                expected: format!(
                    "{} to {} {name}; are these {other}?",
                    range.start(),
                    range.end()
                ),
            });
        }
        let found = unit.micrometres(found);
        if !wavelengths.contains(&found) {
            wavelengths.push(found);
        }
    }
    let target = wanted.unwrap_or(0.55);
    let nearest = wavelengths
        .iter()
        .copied()
        .min_by(|a, b| (a - target).abs().total_cmp(&(b - target).abs()))
        .unwrap_or(target);
    let note = ReadNote::Wavelength { chosen_um: nearest, all_um: wavelengths, wanted_um: wanted };
    Ok((nearest, note))
}

#[cfg(test)]
mod tests {
    use brdf_param::{DirectionPair, polar_angle};

    use super::*;
    use crate::write_samples;

    fn with_columns(columns: &str) -> TableOptions {
        TableOptions { columns: Some(columns.parse().unwrap()), ..TableOptions::default() }
    }

    #[test]
    fn commented_headers_and_swapped_names_need_a_map() {
        let text = "# a title of several words here\n# phi_i theta_i phi_o theta_o brdf\n\
                    75.0 -180.0 -20.0 0.0 0.5\n";
        let refused = read_table(text, &TableOptions::default()).unwrap_err().to_string();
        assert!(refused.contains("line 2") && refused.contains("theta_i_deg"), "{refused}");
        let map =
            "theta_i_deg=phi_i,phi_i_deg=theta_i,theta_o_deg=phi_o,phi_o_deg=theta_o,value=brdf";
        let (samples, _) = read_table(text, &with_columns(map)).unwrap();
        let pair = samples.pair(0);
        assert!((polar_angle(pair.wi).to_degrees() - 75.0).abs() < 1e-9);
        assert!(pair.wi.x < 0.0 && pair.wo.x < 0.0, "both on the far side: {pair:?}");
    }

    #[test]
    fn samples_survive_a_round_trip() {
        let mut samples = SampleSet::new(Channels::Rgb);
        let pair = DirectionPair::from_angles(0.3, 1.0, 1.2, -2.0);
        samples.push(&pair, &[0.1, 0.2, 1e-7]);
        let (read, _) = read_table(&write_samples(&samples), &TableOptions::default()).unwrap();
        assert!(read.pair(0).wi.distance(pair.wi) < 1e-15);
        assert_eq!(read.values(), samples.values());
    }

    #[test]
    fn a_word_among_numbers_is_named_with_its_line() {
        let text = "theta_i_deg,phi_i_deg,theta_o_deg,phi_o_deg,value\n1,2,3,4,5\n1,2,x,4,5\n";
        let message = read_table(text, &TableOptions::default()).unwrap_err().to_string();
        assert!(message.contains("line 3") && message.contains("\"x\""), "{message}");
    }
}
