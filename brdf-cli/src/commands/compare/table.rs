//! Comparisons as people read them.

use std::io::Write;

use brdf_fit::{Comparison, Distribution, FolderComparison, ModelMeasures};
use brdf_report::{bytes, or_dash, significant};

/// A line for each model.
pub(super) fn print_basic(comparison: &Comparison, out: &mut impl Write) -> std::io::Result<()> {
    head(comparison, out)?;
    let results = &comparison.results;
    let width = results.iter().map(|r| r.model.chars().count()).max().unwrap_or(0).max(5);
    let columns =
        ["bytes", "log abs", "log sq", "log max", "lin abs", "lin sq", "lin max", "cosine rms"];
    write!(out, "{:width$}", "model")?;
    columns.iter().try_for_each(|column| write!(out, "  {column:>10}"))?;
    writeln!(out)?;
    for row in results {
        write!(out, "{:width$}  {:>10}", row.model, bytes(row.bytes))?;
        for errors in [&row.log, &row.linear] {
            for value in [errors.mean_abs, errors.mean_square, errors.max] {
                write!(out, "  {:>10}", significant(value))?;
            }
        }
        writeln!(out, "  {:>10}", or_dash(row.cosine_rms))?;
    }
    results.iter().try_for_each(|row| remarks(row, &row.model, out))
}

/// A line for each measure, a column for each model.
pub(super) fn print_all(comparison: &Comparison, out: &mut impl Write) -> std::io::Result<()> {
    head(comparison, out)?;
    let columns: Vec<_> = comparison.results.iter().map(ModelMeasures::all).collect();
    let Some(first) = columns.first() else { return Ok(()) };
    let label = first.iter().map(|m| m.name.chars().count()).max().unwrap_or(0);
    for (index, row) in comparison.results.iter().enumerate() {
        writeln!(out, "[{}] {}", index + 1, row.model)?;
    }
    write!(out, "{:label$}", "")?;
    for index in 1..=columns.len() {
        write!(out, "  {:>10}", format!("[{index}]"))?;
    }
    writeln!(out)?;
    for measure in first {
        write!(out, "{:label$}", measure.name)?;
        for column in &columns {
            let same = column.iter().find(|other| other.name == measure.name);
            write!(out, "  {:>10}", or_dash(same.and_then(|m| m.value)))?;
        }
        writeln!(out)?;
    }
    for row in &comparison.results {
        remarks(row, &row.model, out)?;
    }
    Ok(())
}

/// What the figures of a model alone do not say.
fn remarks(row: &ModelMeasures, name: &str, out: &mut impl Write) -> std::io::Result<()> {
    if row.without_data > 0 {
        writeln!(out, "{name}: {} pairs without data left out", row.without_data)?;
    }
    if row.without_logarithm > 0 {
        writeln!(
            out,
            "{name}: {} negative values without a logarithm; log errors take them as 0",
            row.without_logarithm
        )?;
    }
    Ok(())
}

fn head(comparison: &Comparison, out: &mut impl Write) -> std::io::Result<()> {
    let Comparison { reference, samples, seed, .. } = comparison;
    writeln!(out, "reference {reference}, {samples} pairs, seed {seed}")
}

/// The median and the worst of every measure, for each folder.
pub(super) fn print_folders(
    comparison: &FolderComparison,
    out: &mut impl Write,
) -> std::io::Result<()> {
    for distribution in &comparison.distributions {
        let Distribution { models, materials, measures } = distribution;
        writeln!(out, "{models} against {}, {materials} materials", comparison.reference)?;
        let width = measures.iter().map(|m| m.measure.chars().count()).max().unwrap_or(0);
        writeln!(out, "{:width$}  {:>10}  worst {}", "", "median", Distribution::WORST)?;
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
    for reason in &comparison.unmatched {
        writeln!(out, "left out: {reason}")?;
    }
    Ok(())
}
