//! Results on BTFs and on relighting as lines of text, for terminals and logs.

use std::fmt::{self, Write as _};
use std::path::Path;

use brdf_container::{BrdfComparison, CompressReport, TextureComparison};
use brdf_relight::{ErrorBreakdown, SpeedReport};
use btf_io::SynthReport;
use btf_vq::{Fidelity, RateRow};
use serde_json::Value;

use crate::numbers::{bytes, percent, significant};
use crate::text::text;

/// Returns what a compression came to.
pub fn compress_text(report: &CompressReport) -> String {
    text(|out| write_compress(report, out))
}

fn write_compress(report: &CompressReport, out: &mut String) -> fmt::Result {
    let CompressReport { output, ratio, seconds, notes, .. } = report;
    writeln!(out, "{output}")?;
    let (size, seconds) = (bytes(report.bytes), significant(*seconds));
    writeln!(out, "  {size} (1:{ratio:.0}), in {seconds} s")?;
    let rows = serde_json::to_string(&report.books).unwrap_or_default();
    writeln!(out, "  rows: {}", rows.replace(['{', '}', '"'], ""))?;
    notes.iter().try_for_each(|note| writeln!(out, "  {note}"))
}

/// Returns how near a compressed BTF is to its images.
pub fn texture_comparison_text(comparison: &TextureComparison) -> String {
    text(|out| write_texture(comparison, out))
}

fn write_texture(comparison: &TextureComparison, out: &mut String) -> fmt::Result {
    let shown =
        |f: Fidelity| format!("PSNR {} dB, MSSIM {}", significant(f.psnr), significant(f.mssim));
    let TextureComparison { model, fidelity, floor, ratio, .. } = comparison;
    writeln!(out, "{model}: {} (1:{ratio:.0})", bytes(comparison.bytes))?;
    writeln!(out, "  {}", shown(*fidelity))?;
    match floor {
        Some(floor) => writeln!(out, "  {} at best, by the resampling alone", shown(*floor)),
        None => Ok(()),
    }
}

/// Returns how near compressed BRDFs are to the originals.
pub fn brdf_comparison_text(comparison: &BrdfComparison) -> String {
    text(|out| write_brdfs(comparison, out))
}

fn write_brdfs(comparison: &BrdfComparison, out: &mut String) -> fmt::Result {
    let BrdfComparison { model, relative, floor, ratio, brdfs, .. } = comparison;
    writeln!(out, "{model}: {} (1:{ratio:.0})", bytes(comparison.bytes))?;
    writeln!(out, "  cosine-weighted RMS over that of the BRDF, and on the grid alone")?;
    let shown = |floor: Option<f64>| floor.map_or_else(String::new, significant);
    for brdf in brdfs {
        let (relative, floor) = (significant(brdf.relative), shown(brdf.floor));
        let holes = match brdf.without_data {
            0 => String::new(),
            count => format!("  {count} pairs without data"),
        };
        writeln!(out, "  {:24} {relative:>10} {floor:>10}{holes}", brdf.name)?;
    }
    writeln!(out, "  {:24} {:>10} {:>10}", "mean", significant(*relative), shown(*floor))
}

/// Returns a line for each point of a study.
pub fn rate_text(rows: &[RateRow]) -> String {
    text(|out| rows.iter().try_for_each(|row| write_rate(row, out)))
}

fn write_rate(row: &RateRow, out: &mut String) -> fmt::Result {
    let RateRow { method, ratio, fidelity, .. } = row;
    let (psnr, mssim) = (significant(fidelity.psnr), significant(fidelity.mssim));
    let (label, size) = (method.label(), bytes(row.bytes));
    writeln!(out, "{label:18} {size:>10}  1:{ratio:<6.0} PSNR {psnr} dB  MSSIM {mssim}")
}

/// Returns what a synthesis wrote into the folder `place`.
pub fn synth_text(report: &SynthReport, place: &Path) -> String {
    text(|out| write_synth(report, place, out))
}

fn write_synth(report: &SynthReport, place: &Path, out: &mut String) -> fmt::Result {
    let SynthReport { images, size, height_range: [low, high], .. } = report;
    let (seconds, megabytes) = (significant(report.seconds), report.bytes / 1_000_000);
    writeln!(out, "{images} images of {size}² texels in {seconds} s, {megabytes} MB")?;
    writeln!(out, "heights from {low:.4} to {high:.4} of the tile's width, mean 0")?;
    let (clipped, peak) = (percent(report.clipped), significant(f64::from(report.peak)));
    writeln!(out, "clipped: {clipped} of the values; the largest is {peak}")?;
    writeln!(out, "{}", place.display())
}

/// Returns the speed of precomputation and of frames.
pub fn speed_text(report: &SpeedReport) -> String {
    text(|out| write_speed(report, out))
}

fn write_speed(report: &SpeedReport, out: &mut String) -> fmt::Result {
    let speed = &report.speed;
    writeln!(out, "precomputation {:.1} s, {}", speed.precompute_s, bytes(report.bytes))?;
    writeln!(
        out,
        "new light {:.0} fps alone, {:.0} with the picture ({} coefficients)",
        speed.light_kernel_fps, speed.light_frame_fps, speed.lit_coefficients
    )?;
    writeln!(out, "new view {:.0} fps", speed.view_frame_fps)
}

/// Returns what relighting loses, in all and at each step.
pub fn breakdown_text(breakdown: &ErrorBreakdown) -> String {
    text(|out| write_breakdown(breakdown, out))
}

fn write_breakdown(breakdown: &ErrorBreakdown, out: &mut String) -> fmt::Result {
    let (total, colours) = (significant(breakdown.total), breakdown.colours);
    writeln!(out, "relative RMS {total} of {colours} colours")?;
    let parts = [
        ("terms", breakdown.rank),
        ("coefficients", breakdown.coefficients),
        ("light", breakdown.light),
        ("visibility", breakdown.visibility),
    ];
    for (name, value) in parts {
        writeln!(out, "  {name} {}", significant(value))?;
    }
    match breakdown.negative {
        0 => Ok(()),
        negative => writeln!(out, "  {negative} colours are below 0 in a channel"),
    }
}

/// Returns the facts of a record, one on each line; items of a list each on their own.
pub fn facts_text(name: &str, facts: &Value) -> String {
    text(|out| write_facts(name, facts, out))
}

fn write_facts(name: &str, facts: &Value, out: &mut String) -> fmt::Result {
    writeln!(out, "{name}")?;
    for (key, value) in facts.as_object().into_iter().flatten() {
        match value {
            Value::Array(items) => {
                items.iter().try_for_each(|item| writeln!(out, "  {key}: {}", plain(item)))?;
            }
            other => writeln!(out, "  {key}: {}", plain(other))?,
        }
    }
    Ok(())
}

/// JSON without quotes and braces.
fn plain(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Object(fields) => {
            let parts: Vec<String> =
                fields.iter().map(|(key, value)| format!("{key} {}", plain(value))).collect();
            parts.join(", ")
        }
        other => other.to_string(),
    }
}
