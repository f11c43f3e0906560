//! What `brdf study` reports.

use std::io::Write;

use brdf_param::Parametrization;
use brdf_plot::Plot;
use brdf_study::{ParametrizationRow, STUDIED, StudyParams, best};
use maud::{PreEscaped, html};
use serde::Serialize;

use super::html::{command, document};
use brdf_model::anisotropy;

use super::separable::ANISOTROPIC;
use crate::numbers::{percent, significant};
use crate::subject::Subject;

/// `report.json`. The first key marks the folder as ours.
#[derive(Serialize)]
pub(crate) struct StudyReport {
    /// Version of the program.
    brdf: &'static str,
    /// Pairs that errors are measured on.
    pairs: u32,
    theta_max_deg: f64,
    /// Nodes of the resampled tables.
    table_nodes: usize,
    /// How often each parametrization is best, for each figure.
    wins: Vec<Wins>,
    /// Medians over materials, for each parametrization.
    medians: Vec<Medians>,
    /// The same counts among materials with sharp and with broad highlights.
    by_gloss: Vec<Group>,
    materials: Vec<Studied>,
    /// Materials that could not be studied, and why.
    skipped: Vec<String>,
}

/// One material.
#[derive(Serialize)]
pub(crate) struct Studied {
    material: String,
    /// What the data is.
    kind: &'static str,
    /// Rows were interpolated between measurements.
    interpolated: bool,
    /// Mean |f − f turned by a quarter| over mean f: the study takes it to be 0.
    anisotropy: f64,
    rows: Vec<ParametrizationRow>,
}

#[derive(Serialize)]
struct Wins {
    figure: &'static str,
    counts: Vec<(Parametrization, usize)>,
}

#[derive(Serialize)]
struct Medians {
    parametrization: Parametrization,
    values: Vec<(&'static str, f64)>,
}

#[derive(Serialize)]
struct Group {
    group: &'static str,
    materials: usize,
    wins: Vec<Wins>,
}

/// A figure of a row, smaller is better.
struct Figure {
    name: &'static str,
    value: fn(&ParametrizationRow) -> f64,
}

/// Figures that the verdict goes by.
const FIGURES: [Figure; 7] = [
    Figure { name: "isolines across the axes", value: |r| r.alignment.across_axes },
    Figure { name: "gradient along the azimuth", value: |r| r.alignment.along_azimuth },
    Figure { name: "energy missed by 1 product", value: |r| 1.0 - r.energy[0] },
    Figure { name: "energy missed by 4 products", value: |r| 1.0 - r.energy[2] },
    Figure { name: "error of both radii alone", value: |r| r.radii_only },
    Figure { name: "error of the best two coordinates", value: |r| r.bivariate.log_cosine_rms },
    Figure { name: "error resampled at equal size", value: |r| r.resampled },
];

impl Studied {
    pub(crate) fn new(subject: &Subject, rows: Vec<ParametrizationRow>) -> Self {
        Self {
            material: subject.short_name(),
            kind: subject.kind(),
            interpolated: subject.samples().is_some(),
            anisotropy: anisotropy(subject.brdf()),
            rows,
        }
    }

    /// Resampled half/difference tables lose most where highlights are sharp: the error that groups
    /// materials.
    fn sharpness(&self) -> f64 {
        let rows = self.rows.iter().map(|row| row.resampled);
        rows.fold(f64::INFINITY, f64::min)
    }
}

impl StudyReport {
    pub(crate) fn new(materials: Vec<Studied>, skipped: Vec<String>, params: StudyParams) -> Self {
        let all: Vec<&Studied> = materials.iter().collect();
        let mut by_sharpness = all.clone();
        by_sharpness.sort_by(|a, b| b.sharpness().total_cmp(&a.sharpness()));
        let (sharp, broad) = by_sharpness.split_at(by_sharpness.len().div_ceil(2));
        let group = |group, members: &[&Studied]| Group {
            group,
            materials: members.len(),
            wins: wins(members),
        };
        Self {
            brdf: env!("CARGO_PKG_VERSION"),
            pairs: params.pairs,
            theta_max_deg: params.theta_max.to_degrees(),
            table_nodes: params.table.pow(3),
            wins: wins(&all),
            medians: STUDIED.into_iter().map(|p| medians(&all, p)).collect(),
            by_gloss: vec![
                group("harder half (largest best resampling error)", sharp),
                group("easier half", broad),
            ],
            materials,
            skipped,
        }
    }

    /// A line for each material and parametrization.
    pub(crate) fn csv(&self) -> String {
        let mut text = String::from(
            "material,kind,parametrization,across_axes,along_azimuth,energy_1,energy_2,energy_4,\
             energy_8,bivariate,bivariate_error,radii_only,resampled\n",
        );
        for material in &self.materials {
            for row in &material.rows {
                let [a, b] = row.bivariate.coordinates;
                let energy = row.energy.map(|e| e.to_string()).join(",");
                text.push_str(&format!(
                    "{},{},{},{},{},{energy},{a} × {b},{},{},{}\n",
                    material.material,
                    material.kind,
                    row.parametrization.name(),
                    row.alignment.across_axes,
                    row.alignment.along_azimuth,
                    row.bivariate.log_cosine_rms,
                    row.radii_only,
                    row.resampled
                ));
            }
        }
        text
    }

    /// The verdict.
    pub(crate) fn print(&self, out: &mut impl Write) -> std::io::Result<()> {
        writeln!(
            out,
            "{} materials, errors on {} pairs within {}°; how often each parametrization is best (median)",
            self.materials.len(),
            self.pairs,
            significant(self.theta_max_deg)
        )?;
        let width = FIGURES.iter().map(|f| f.name.len()).max().unwrap_or(0);
        write!(out, "{:width$}", "")?;
        STUDIED.iter().try_for_each(|p| write!(out, "  {:>17}", p.name()))?;
        writeln!(out)?;
        for (index, wins) in self.wins.iter().enumerate() {
            write!(out, "{:width$}", wins.figure)?;
            for ((_, count), medians) in wins.counts.iter().zip(&self.medians) {
                let median = significant(medians.values[index].1);
                write!(out, "  {:>17}", format!("{count} ({median})"))?;
            }
            writeln!(out)?;
        }
        for material in self.materials.iter().filter(|m| m.anisotropy > ANISOTROPIC) {
            writeln!(
                out,
                "{}: taken to be isotropic, but differs by {} when turned",
                material.material,
                percent(material.anisotropy)
            )?;
        }
        for reason in &self.skipped {
            writeln!(out, "left out: {reason}")?;
        }
        Ok(())
    }

    /// `report.html`.
    pub(crate) fn page(&self, slices: &[Plot]) -> String {
        document(
            "parametrizations, measured",
            &html! {
                p {
                    (self.materials.len()) " materials. Errors are root mean squares of ln(1 + f "
                    "cosθi), f the luminance, over the same " (self.pairs) " pairs within "
                    (significant(self.theta_max_deg)) "°; tables have " (self.table_nodes)
                    " nodes. Materials are taken to be isotropic."
                }
                h2 { "Verdict" }
                (win_table(&self.wins, Some(&self.medians)))
                @for group in &self.by_gloss {
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
                    @for material in &self.materials {
                        @for row in &material.rows {
                            tr {
                                td {
                                    (material.material)
                                    @if material.interpolated { " (rows interpolated)" }
                                    @if material.anisotropy > ANISOTROPIC { " (anisotropic)" }
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
                @if !self.skipped.is_empty() {
                    h2 { "Left out" }
                    ul { @for reason in &self.skipped { li { (reason) } } }
                }
                h2 { "Command" }
                p { code { (command()) } }
            },
        )
    }
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

fn wins(materials: &[&Studied]) -> Vec<Wins> {
    FIGURES
        .iter()
        .map(|figure| {
            let winners: Vec<Parametrization> =
                materials.iter().filter_map(|m| best(&m.rows, figure.value)).collect();
            let count = |p| winners.iter().filter(|w| **w == p).count();
            Wins {
                figure: figure.name,
                counts: STUDIED.into_iter().map(|p| (p, count(p))).collect(),
            }
        })
        .collect()
}

fn medians(materials: &[&Studied], parametrization: Parametrization) -> Medians {
    let rows: Vec<&ParametrizationRow> = materials
        .iter()
        .flat_map(|m| m.rows.iter().filter(|row| row.parametrization == parametrization))
        .collect();
    let median = |figure: &Figure| {
        let mut values: Vec<f64> = rows.iter().map(|row| (figure.value)(row)).collect();
        values.sort_by(f64::total_cmp);
        let count = values.len();
        if count == 0 { f64::NAN } else { 0.5 * (values[(count - 1) / 2] + values[count / 2]) }
    };
    Medians {
        parametrization,
        values: FIGURES.iter().map(|figure| (figure.name, median(figure))).collect(),
    }
}
