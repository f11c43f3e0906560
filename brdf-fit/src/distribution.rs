//! How measures are distributed over many materials.

use serde::{Deserialize, Serialize};

use crate::compare::Comparison;

/// Models of many materials beside their references.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FolderComparison {
    /// The folder of references.
    pub reference: String,
    /// One for each material.
    pub materials: Vec<Comparison>,
    /// Of every model folder, in order.
    pub distributions: Vec<Distribution>,
    /// References without a model in a folder, and models without a reference.
    pub unmatched: Vec<String>,
}

/// The measures of one folder of models.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Distribution {
    /// The folder.
    pub models: String,
    /// How many materials.
    pub materials: usize,
    /// One for each measure.
    pub measures: Vec<MeasureDistribution>,
}

/// One measure over all materials.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MeasureDistribution {
    /// Its name.
    pub measure: String,
    /// The value in the middle.
    pub median: f64,
    /// Up to five materials with their values, worst first.
    pub worst: Vec<(String, f64)>,
}

impl Distribution {
    /// Materials that are named for each measure.
    pub const WORST: usize = 5;

    /// Returns the distributions of the model at `index` of every comparison, which stands in a folder of this name.
    ///
    /// # Panics
    ///
    /// If a comparison has no such model.
    pub fn of(folder: &str, index: usize, materials: &[Comparison]) -> Self {
        let rows: Vec<_> =
            materials.iter().map(|m| (m.reference.clone(), m.results[index].all())).collect();
        let names = rows.first().map_or(&[][..], |(_, measures)| measures);
        let measures = names
            .iter()
            .filter_map(|named| {
                let mut values: Vec<(String, f64)> = rows
                    .iter()
                    .filter_map(|(material, measures)| {
                        let same = measures.iter().find(|m| m.name == named.name)?;
                        Some((material.clone(), same.value?))
                    })
                    .collect();
                values.sort_by(|a, b| {
                    if named.larger_is_better { a.1.total_cmp(&b.1) } else { b.1.total_cmp(&a.1) }
                });
                let count = values.len();
                if count == 0 {
                    return None;
                }
                let median = 0.5 * (values[(count - 1) / 2].1 + values[count / 2].1);
                values.truncate(Self::WORST);
                Some(MeasureDistribution { measure: named.name.clone(), median, worst: values })
            })
            .collect();
        Self { models: folder.to_owned(), materials: materials.len(), measures }
    }
}
