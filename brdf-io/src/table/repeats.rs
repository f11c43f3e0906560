//! Rows of the same directions: repeats that contradict each other, and columns that tell materials apart.

use std::collections::{BTreeMap, BTreeSet};

use brdf_param::DirectionPair;

use super::dialect::{Row, Table};
use super::samples::listed;
use crate::error::FormatError;
use crate::note::ReadNote;

/// Values that differ by less are repeats of one measurement.
const SAME: f64 = 1.01;
/// Names of columns that tell materials or measurements apart, whatever rows there are.
const TELLING: [&str; 9] =
    ["wavelength", "lambda", "polari", "sample", "material", "repeat", "run", "channel", "band"];

/// What was measured more than once.
#[derive(Default)]
pub(crate) struct Repeats {
    /// Smallest and largest values of each pair of directions, and the rows that have it.
    pairs: BTreeMap<[i64; 6], Repeated>,
}

#[derive(Default)]
struct Repeated {
    ranges: Vec<[f64; 2]>,
    rows: Vec<usize>,
}

impl Repeats {
    pub(crate) fn add(&mut self, pair: &DirectionPair, values: &[f64], row: usize) {
        if !(pair.wi.is_finite() && pair.wo.is_finite()) {
            return;
        }
        #[expect(clippy::cast_possible_truncation, reason = "within ±1e9")]
        let rounded = |v: f64| (v * 1e9).round() as i64;
        let place = [pair.wi, pair.wo].map(|w| w.to_array().map(rounded));
        let key = std::array::from_fn(|index| place.as_flattened()[index]);
        let own = self.pairs.entry(key).or_default();
        own.ranges.resize(values.len(), [f64::INFINITY, f64::NEG_INFINITY]);
        for (range, value) in own.ranges.iter_mut().zip(values).filter(|(_, v)| v.is_finite()) {
            *range = [range[0].min(*value), range[1].max(*value)];
        }
        own.rows.push(row);
    }

    fn repeated(&self) -> impl Iterator<Item = &Repeated> {
        self.pairs.values().filter(|own| own.rows.len() > 1)
    }

    /// What is to be said of pairs whose repeats differ.
    pub(crate) fn note(&self) -> Option<ReadNote> {
        let ratio = |own: &Repeated| {
            let known = own.ranges.iter().filter(|[min, max]| *max > 0.0 && *min >= 0.0);
            known
                .map(|[min, max]| if *min > 0.0 { max / min } else { f64::INFINITY })
                .fold(1.0, f64::max)
        };
        let ratios: Vec<f64> = self.repeated().map(ratio).filter(|ratio| *ratio > SAME).collect();
        let largest = ratios.iter().copied().fold(1.0, f64::max);
        (!ratios.is_empty()).then_some(ReadNote::Contradictions { pairs: ratios.len(), largest })
    }
}

/// Returns what is wrong if rows of several materials are mixed: a column without a meaning has several values, and its
/// name says that these are different things, or rows of the same directions differ in it.
pub(crate) fn telling_apart(
    table: &Table<'_>,
    rows: &[Row<'_>],
    repeats: &Repeats,
    used: &[usize],
) -> Option<FormatError> {
    for (index, name) in table.header.iter().enumerate().filter(|(index, _)| !used.contains(index))
    {
        let field = |row: &Row<'_>| {
            row.fields.get(index).map(|field| field.clone().into_owned()).unwrap_or_default()
        };
        let values: BTreeSet<String> = rows.iter().map(field).collect();
        // What is different in every row is a number of the row, or a measurement.
        if values.len() < 2 || 2 * values.len() > rows.len() {
            continue;
        }
        let lower = name.to_lowercase();
        let is_telling = TELLING.iter().any(|word| lower.contains(word));
        let differs = |own: &&Repeated| {
            let own_values: BTreeSet<String> =
                own.rows.iter().map(|&row| field(&rows[row])).collect();
            own_values.len() == own.rows.len()
        };
        let count = repeats.repeated().count();
        let is_split = count > 0
            && 10 * repeats.repeated().filter(differs).count() >= 9 * count
            && 2 * repeats.repeated().map(|own| own.rows.len()).sum::<usize>() >= rows.len();
        if is_telling || is_split {
            let mut values: Vec<String> = values.into_iter().collect();
            let number = |text: &String| table.dialect.parse(text).unwrap_or(f64::NAN);
            values.sort_by(|a, b| number(a).total_cmp(&number(b)));
            return Some(FormatError::SeveralMaterials {
                line: table.header_line,
                column: name.clone(),
                values: listed(values),
            });
        }
    }
    None
}
