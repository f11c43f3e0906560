//! The folder of results of a study of parametrizations.

use brdf_plot::Plot;
use brdf_study::{Medians, STUDIED, StudyReport, Wins};
use maud::{PreEscaped, html};

use crate::error::ReportError;
use crate::files::ResultFile;
use crate::numbers::significant;
use crate::page::document;

/// Returns the files of a folder of results: the slices with isolines, `study.csv`, `report.html` with the verdict, and
/// `report.json`. The page quotes `command` as what made it.
///
/// # Errors
///
/// [`ReportError::Json`] for a report that is no JSON.
pub fn study_files(
    report: &StudyReport,
    slices: &[Plot],
    command: &str,
) -> Result<Vec<ResultFile>, ReportError> {
    let svg = |(index, plot): (usize, &Plot)| {
        ResultFile::new(format!("slices-{index}.svg"), plot.svg().as_bytes().to_vec())
    };
    let mut files: Vec<ResultFile> = slices.iter().enumerate().map(svg).collect();
    files.push(ResultFile::new("study.csv", report.csv().into_bytes()));
    files.push(ResultFile::new("report.html", page(report, slices, command).into_bytes()));
    files.push(ResultFile::json("report.json", report)?);
    Ok(files)
}

fn page(report: &StudyReport, slices: &[Plot], command: &str) -> String {
    document(
        "parametrizations, measured",
        &html! {
            p {
                (report.materials.len()) " materials. Errors are root mean squares of ln(1 + f "
                "cosθi), f the luminance, over the same " (report.pairs) " pairs within "
                (significant(report.theta_max_deg)) "°; tables have " (report.table_nodes)
                " nodes. Materials are taken to be isotropic."
            }
            h2 { "Verdict" }
            (win_table(&report.wins, Some(&report.medians)))
            @for group in &report.by_gloss {
                h2 { (group.group) ", " (group.materials) " materials" }
                (win_table(&group.wins, None))
            }
            @for plot in slices { (PreEscaped(plot.svg())) }
            h2 { "Every material" }
            table {
                tr {
                    th { "material" } th { "parametrization" } th { "across axes" }
                    th { "along azimuth" } th { "energy of 1, 2, 4, 8 products" }
                    th { "best two coordinates" } th { "their error" } th { "both radii" }
                    th { "resampled" }
                }
                @for material in &report.materials {
                    @for row in &material.rows {
                        tr {
                            td {
                                (material.material)
                                @if material.interpolated { " (rows interpolated)" }
                                @if material.is_anisotropic() { " (anisotropic)" }
                            }
                            td { (row.parametrization.name()) }
                            td { (significant(row.alignment.across_axes)) }
                            td { (significant(row.alignment.along_azimuth)) }
                            td { (row.energy.map(|e| format!("{e:.4}")).join(" ")) }
                            td { (row.bivariate.coordinates.join(" × ")) }
                            td { (significant(row.bivariate.log_cosine_rms)) }
                            td { (significant(row.radii_only)) }
                            td { (significant(row.resampled)) }
                        }
                    }
                }
            }
            @if !report.skipped.is_empty() {
                h2 { "Left out" }
                ul { @for reason in &report.skipped { li { (reason) } } }
            }
            h2 { "Command" }
            p { code { (command) } }
        },
    )
}

fn win_table(wins: &[Wins], medians: Option<&[Medians]>) -> maud::Markup {
    html! {
        table {
            tr {
                th { "best, number of materials" @if medians.is_some() { " (median)" } }
                @for parametrization in STUDIED { th { (parametrization.name()) } }
            }
            @for (index, figure) in wins.iter().enumerate() {
                tr {
                    td { (figure.figure) }
                    @for (column, (_, count)) in figure.counts.iter().enumerate() {
                        td {
                            (count)
                            @if let Some(medians) = medians {
                                " (" (significant(medians[column].values[index].1)) ")"
                            }
                        }
                    }
                }
            }
        }
    }
}
