//! Folders of models against folders of references.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context as _, bail};
use serde::Serialize;

use super::{Compare, Comparison};
use crate::numbers::significant;

/// Materials that a distribution names.
const WORST: usize = 5;

/// What `compare --json` prints of folders.
#[derive(Serialize)]
struct FolderComparison {
    reference: String,
    materials: Vec<Comparison>,
    /// Of every model folder, in order.
    distributions: Vec<Distribution>,
    /// References without a model in a folder, and models without a reference.
    unmatched: Vec<String>,
}

#[derive(Serialize)]
struct Distribution {
    models: String,
    materials: usize,
    measures: Vec<MeasureDistribution>,
}

#[derive(Serialize)]
struct MeasureDistribution {
    measure: String,
    median: f64,
    /// Worst first.
    worst: Vec<(String, f64)>,
}

impl Compare {
    pub(super) fn compare_folders(&self, out: &mut impl Write) -> anyhow::Result<ExitCode> {
        let references = materials_in(Path::new(&self.reference))?;
        let mut materials = Vec::new();
        let mut unmatched = Vec::new();
        let folders: Vec<Vec<(String, PathBuf)>> = self
            .models
            .iter()
            .map(|folder| {
                if !Path::new(folder).is_dir() {
                    bail!("{folder}: not a folder; the reference is one, so every model must be");
                }
                materials_in(Path::new(folder))
            })
            .collect::<anyhow::Result<_>>()?;
        for (name, reference) in &references {
            let found: Option<Vec<String>> = folders
                .iter()
                .map(|folder| {
                    let entry = folder.iter().find(|(other, _)| other == name);
                    entry.map(|(_, path)| path.to_string_lossy().into_owned())
                })
                .collect();
            match found {
                Some(models) => {
                    let mut comparison = self.compare(&reference.to_string_lossy(), &models)?;
                    name.clone_into(&mut comparison.reference);
                    materials.push(comparison);
                }
                None => unmatched.push(format!("{}: no model", reference.display())),
            }
        }
        for (name, path) in folders.iter().flatten() {
            if !references.iter().any(|(other, _)| other == name) {
                unmatched.push(format!("{}: no reference", path.display()));
            }
        }
        if materials.is_empty() {
            bail!(
                "{}: none of {} references has a model of the same name in every folder",
                self.reference,
                references.len()
            );
        }
        let distributions = self
            .models
            .iter()
            .enumerate()
            .map(|(index, folder)| Distribution::new(folder, index, &materials))
            .collect();
        let comparison = FolderComparison {
            reference: self.reference.clone(),
            materials,
            distributions,
            unmatched,
        };
        if self.json {
            writeln!(out, "{}", serde_json::to_string_pretty(&comparison)?)?;
        } else {
            comparison.print(out)?;
        }
        Ok(ExitCode::SUCCESS)
    }
}

/// Names and files of the materials in a folder: plain files by their stem, folders by the model in
/// them; in alphabetical order.
fn materials_in(folder: &Path) -> anyhow::Result<Vec<(String, PathBuf)>> {
    let entries = std::fs::read_dir(folder).with_context(|| folder.display().to_string())?;
    let mut found = Vec::new();
    for entry in entries {
        let path = entry.with_context(|| folder.display().to_string())?.path();
        let model = path.join("model.safetensors");
        let name = |part: Option<&std::ffi::OsStr>| part.map(|n| n.to_string_lossy().into_owned());
        if model.is_file() {
            found.extend(name(path.file_name()).map(|name| (name, model)));
        } else if path.is_file() {
            found.extend(name(path.file_stem()).map(|name| (name, path.clone())));
        }
    }
    found.sort();
    Ok(found)
}

impl Distribution {
    fn new(folder: &str, index: usize, materials: &[Comparison]) -> Self {
        let rows: Vec<_> =
            materials.iter().map(|m| (m.reference.clone(), m.results[index].measures())).collect();
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
                values.truncate(WORST);
                Some(MeasureDistribution { measure: named.name.clone(), median, worst: values })
            })
            .collect();
        Self { models: folder.to_owned(), materials: materials.len(), measures }
    }
}

impl FolderComparison {
    fn print(&self, out: &mut impl Write) -> std::io::Result<()> {
        for distribution in &self.distributions {
            let Distribution { models, materials, measures } = distribution;
            writeln!(out, "{models} against {}, {materials} materials", self.reference)?;
            let width = measures.iter().map(|m| m.measure.chars().count()).max().unwrap_or(0);
            writeln!(out, "{:width$}  {:>10}  worst {WORST}", "", "median")?;
            for measure in measures {
                let worst: Vec<String> = measure
                    .worst
                    .iter()
                    .map(|(name, value)| format!("{name} {}", significant(*value)))
                    .collect();
                let median = significant(measure.median);
                writeln!(out, "{:width$}  {median:>10}  {}", measure.measure, worst.join(", "))?;
            }
        }
        for reason in &self.unmatched {
            writeln!(out, "left out: {reason}")?;
        }
        Ok(())
    }
}
