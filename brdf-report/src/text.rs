//! Results as lines of text, for terminals and logs.

use std::fmt::{self, Write as _};

use brdf_container::MaterialInfo;
use brdf_factor::TexelFormat;
use brdf_fit::{
    CompactReport, Comparison, Distribution, FactoredModel, FactoredReport, FolderComparison,
    Method, ModelMeasures, SeparableReport, TermRecord,
};
use brdf_model::{Channels, FitErrors, MerlTable};
use brdf_paint::PaintReport;
use brdf_study::{STUDIED, StudyReport};

use crate::compact::makeup_text;
use crate::fidelity::fidelity_line;
use crate::numbers::{bytes, or_dash, percent, significant};

/// Returns what was written.
pub(crate) fn text(write: impl FnOnce(&mut String) -> fmt::Result) -> String {
    let mut out = String::new();
    // A string takes whatever is written.
    let _ = write(&mut out);
    out
}

/// Returns what is known of a material: a line with its name, and indented ones.
pub fn info_text(info: &MaterialInfo) -> String {
    text(|out| write_info(info, out))
}

/// Returns a comparison as a table with a line for each model.
pub fn comparison_table(comparison: &Comparison) -> String {
    text(|out| write_table(comparison, out))
}

/// Returns a comparison with a line for each measure and a column for each model.
pub fn comparison_measures(comparison: &Comparison) -> String {
    text(|out| write_measures(comparison, out))
}

/// Returns the median and the worst of every measure, for each folder of models.
pub fn folder_comparison_text(comparison: &FolderComparison) -> String {
    text(|out| write_folders(comparison, out))
}

/// Returns the errors of a product of textures and the notes on it; `name` is that of the material.
pub fn factored_text(name: &str, report: &FactoredReport) -> String {
    text(|out| write_factored(name, report, out))
}

/// Returns the errors of a sum of products and the notes on it; `name` is that of the material.
pub fn separable_text(name: &str, report: &SeparableReport) -> String {
    text(|out| write_separable(name, report, out))
}

/// Returns the verdict of a study.
pub fn study_text(report: &StudyReport) -> String {
    text(|out| write_study(report, out))
}

fn write_info(info: &MaterialInfo, out: &mut String) -> fmt::Result {
    let channels = match info.channels {
        Channels::Rgb => "RGB",
        Channels::Luminance => "one channel",
    };
    writeln!(out, "{}: {}, {}, {channels}", info.file, info.format, bytes(info.bytes))?;
    if let Some(invalid) = info.invalid_cells {
        writeln!(out, "  {invalid} of {} cells invalid", MerlTable::CELLS)?;
    }
    if let Some(summary) = &info.samples {
        writeln!(
            out,
            "  {} samples, {} directions of light up to {:.1}°, viewers up to {:.1}°",
            summary.count, summary.incidences, summary.max_theta_i_deg, summary.max_theta_o_deg
        )?;
        writeln!(
            out,
            "  values {} to {} sr⁻¹, {} exactly 0",
            significant(summary.min_value),
            significant(summary.max_value),
            percent(summary.zero_share)
        )?;
    }
    if let Some(dropped) = &info.dropped
        && dropped.total() > 0
    {
        writeln!(out, "  dropped: {dropped}")?;
    }
    if let Some(checks) = &info.checks {
        writeln!(
            out,
            "  reciprocity error {}, largest albedo {} at {:.0}°, data for {} of pairs within \
             {:.0}°",
            percent(checks.reciprocity_error),
            significant(checks.largest_albedo),
            checks.largest_albedo_theta_deg,
            percent(checks.coverage.share),
            checks.coverage.max_theta_deg
        )?;
        if checks.largest_albedo > 1.0 {
            writeln!(out, "  more light leaves than arrives: an albedo above 1")?;
        }
    }
    if let Some(model) = &info.model {
        writeln!(out, "  {} of {}, {} space", model.method, model.input, model.space.name())?;
        for term in &model.terms {
            writeln!(
                out,
                "  {} textures: mean square log error {}, held out {}{}",
                term.textures,
                significant(term.training.log.mean_square),
                or_dash(term.held_out.as_ref().map(|e| e.log.mean_square)),
                as_stored(term, model.settings.texels)
            )?;
        }
    }
    if let Some(fit) = &info.separable {
        let terms = fit.terms.last().map_or(0, |term| term.matrix.rank);
        writeln!(out, "  {} of {}, {terms} terms", fit.method, fit.input)?;
        for term in &fit.terms {
            writeln!(
                out,
                "  {} terms: relative residual {}, mean square log error {} held out",
                term.matrix.rank,
                significant(term.matrix.relative_residual),
                or_dash(term.held_out.as_ref().map(|e| e.log.mean_square))
            )?;
        }
    }
    for note in &info.notes {
        writeln!(out, "  {note}")?;
    }
    Ok(())
}

/// A line for each model.
fn write_table(comparison: &Comparison, out: &mut String) -> fmt::Result {
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
fn write_measures(comparison: &Comparison, out: &mut String) -> fmt::Result {
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
fn remarks(row: &ModelMeasures, name: &str, out: &mut String) -> fmt::Result {
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

fn head(comparison: &Comparison, out: &mut String) -> fmt::Result {
    let Comparison { reference, samples, seed, .. } = comparison;
    writeln!(out, "reference {reference}, {samples} pairs, seed {seed}")
}

/// The median and the worst of every measure, for each folder.
fn write_folders(comparison: &FolderComparison, out: &mut String) -> fmt::Result {
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

fn write_factored(name: &str, report: &FactoredReport, out: &mut String) -> fmt::Result {
    writeln!(
        out,
        "{}: {} in {} textures, {}, fitted in {} s",
        name,
        report.method,
        report.terms.last().map_or(0, |term| term.textures),
        bytes(report.bytes),
        significant(report.seconds)
    )?;
    let held_out = |term: &TermRecord| or_dash(term.held_out.as_ref().map(|e| e.log.mean_square));
    if let Some(search) = &report.search {
        writeln!(out, "{} evaluations", report.evaluations)?;
        if let Some(cause) = &search.stopped {
            writeln!(out, "stopped early ({cause}): the best found so far")?;
        }
    }
    for term in &report.terms {
        writeln!(
            out,
            "{:>2} textures{}: mean square log error {}, held out {}{}",
            term.textures,
            term.family.map_or(String::new(), |family| format!(" ({family})")),
            significant(term.training.log.mean_square),
            held_out(term),
            as_stored(term, report.settings.texels)
        )?;
    }
    if report.method != Method::McCool {
        let mccool = &report.baseline.mccool;
        writeln!(
            out,
            "McCool, {} textures: mean square log error {}, held out {}",
            mccool.textures,
            significant(mccool.training.log.mean_square),
            held_out(mccool)
        )?;
    }
    if let Some(fidelity) = &report.fidelity {
        writeln!(out, "{}", fidelity_line(fidelity))?;
        if let Some(fitted) = &report.fitted_fidelity {
            writeln!(
                out,
                "geometric mean of eight held-out errors {} as fitted in f32, {} as stored in {}",
                significant(fitted.score()),
                significant(fidelity.score()),
                report.settings.texels.name()
            )?;
        }
    }
    writeln!(
        out,
        "largest albedo {}, reference {}",
        significant(report.albedo.model),
        or_dash(report.albedo.reference)
    )?;
    writeln!(out, "samples: {} used", report.samples.used)?;
    if report.samples.dropped.total() > 0 {
        writeln!(out, "dropped: {}", report.samples.dropped)?;
    }
    for note in &report.notes {
        writeln!(out, "note: {note}")?;
    }
    Ok(())
}

/// The errors of a model whose texels were rounded, beside those as fitted.
fn as_stored(term: &TermRecord, texels: TexelFormat) -> String {
    term.stored.as_ref().map_or(String::new(), |stored| {
        format!(
            " as fitted in f32; {}, held out {} as stored in {}",
            significant(stored.training.log.mean_square),
            or_dash(stored.held_out.as_ref().map(|e| e.log.mean_square)),
            texels.name()
        )
    })
}

fn write_separable(name: &str, report: &SeparableReport, out: &mut String) -> fmt::Result {
    writeln!(
        out,
        "{}: {} of {} terms, {}, {} × {} matrix, {} s",
        name,
        report.method,
        report.terms.last().map_or(0, |term| term.matrix.rank),
        bytes(report.bytes),
        report.matrix.rows,
        report.matrix.columns,
        significant(report.seconds)
    )?;
    for term in &report.terms {
        writeln!(
            out,
            "{:>2} terms: relative residual {}, log-cosine RMS {} over the matrix; mean square log \
             error {} held out",
            term.matrix.rank,
            significant(term.matrix.relative_residual),
            significant(term.matrix.log_cosine_rms),
            or_dash(term.held_out.as_ref().map(|e| e.log.mean_square))
        )?;
    }
    for note in &report.notes {
        writeln!(out, "{note}")?;
    }
    Ok(())
}

/// Returns how good a compact model is, in a few lines.
pub fn compact_text(name: &str, report: &CompactReport) -> String {
    text(|out| write_compact(name, report, out))
}

fn write_compact(name: &str, report: &CompactReport, out: &mut String) -> fmt::Result {
    writeln!(
        out,
        "{name}: {}, {}, {} s",
        makeup_text(&report.makeup),
        bytes(report.bytes),
        significant(report.seconds)
    )?;
    if let Some(fidelity) = &report.fidelity {
        writeln!(out, "{}", fidelity_line(fidelity))?;
    }
    let log = |errors: &FitErrors| errors.log.mean_square;
    if let Some(training) = &report.training {
        write!(out, "mean square log error {} of what was fitted, ", significant(log(training)))?;
    } else {
        write!(out, "mean square log error ")?;
    }
    writeln!(out, "{} held out", or_dash(report.held_out.as_ref().map(log)))?;
    for note in &report.notes {
        writeln!(out, "{note}")?;
    }
    Ok(())
}

/// The verdict.
fn write_study(report: &StudyReport, out: &mut String) -> fmt::Result {
    writeln!(
        out,
        "{} materials, errors on {} pairs within {}°; how often each parametrization is best (median)",
        report.materials.len(),
        report.pairs,
        significant(report.theta_max_deg)
    )?;
    let width = report.wins.iter().map(|wins| wins.figure.len()).max().unwrap_or(0);
    write!(out, "{:width$}", "")?;
    STUDIED.iter().try_for_each(|p| write!(out, "  {:>17}", p.name()))?;
    writeln!(out)?;
    for (index, wins) in report.wins.iter().enumerate() {
        write!(out, "{:width$}", wins.figure)?;
        for ((_, count), medians) in wins.counts.iter().zip(&report.medians) {
            let median = significant(medians.values[index].1);
            write!(out, "  {:>17}", format!("{count} ({median})"))?;
        }
        writeln!(out)?;
    }
    for material in report.materials.iter().filter(|m| m.is_anisotropic()) {
        writeln!(
            out,
            "{}: taken to be isotropic, but differs by {} when turned",
            material.material,
            percent(material.anisotropy)
        )?;
    }
    for reason in &report.skipped {
        writeln!(out, "left out: {reason}")?;
    }
    Ok(())
}

/// Returns what a model that was taken out of a larger one is, with the errors of its record.
pub fn kept_text(kept: &FactoredModel) -> String {
    text(|out| write_kept(kept, out))
}

fn write_kept(kept: &FactoredModel, out: &mut String) -> fmt::Result {
    let textures = kept.model.factors().len();
    let size = bytes(kept.model.payload_bytes());
    writeln!(out, "{}: {textures} textures, {size}", kept.record.input)?;
    if let Some(term) = kept.record.terms.iter().find(|term| term.textures == textures) {
        let training = significant(term.training.log.mean_square);
        let held_out = or_dash(term.held_out.as_ref().map(|e| e.log.mean_square));
        let stored = as_stored(term, kept.record.settings.texels);
        writeln!(
            out,
            "mean square log error {training}, held out {held_out}{stored} (as recorded)"
        )?;
    }
    Ok(())
}

/// Returns what was learned from paintings, in a folder of this name.
pub fn painted_text(folder: &str, size: usize, report: &PaintReport) -> String {
    text(|out| write_painted(folder, size, report, out))
}

fn write_painted(folder: &str, size: usize, report: &PaintReport, out: &mut String) -> fmt::Result {
    writeln!(out, "{folder}: {}", bytes(size))?;
    let (rms, samples) = (significant(report.rms.train), report.samples);
    writeln!(out, "  RMS {rms} of {samples} painted pixels")?;
    if let Some(rms) = report.rms.held_out {
        writeln!(out, "  RMS {} of pixels that were not used", significant(rms))?;
    }
    report.notes.iter().try_for_each(|note| writeln!(out, "  {note}"))
}
