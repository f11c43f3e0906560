//! The record of a study of several materials, with its verdict.

use std::fmt;

use brdf_job::{Job, Stopped};
use brdf_model::{ANISOTROPIC, Brdf, anisotropy};
use brdf_param::Parametrization;
use brdf_separable::SeparableError;
use serde::Serialize;

use crate::STUDIED;
use crate::measure::{ParametrizationRow, StudyParams, best, study_material};

/// The results of a study of several materials, which `brdf study` writes to `report.json`.
///
/// The first key, `brdf`, marks a folder of results.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StudyReport {
    /// Version of the program.
    pub brdf: String,
    /// Number of pairs that errors are measured on.
    pub pairs: u32,
    /// Grazing limit, degrees.
    pub theta_max_deg: f64,
    /// Number of nodes of the resampled tables.
    pub table_nodes: usize,
    /// Number of materials for which each parametrization is best, for each figure.
    pub wins: Vec<Wins>,
    /// Medians over materials, for each parametrization.
    pub medians: Vec<Medians>,
    /// Counts of wins among materials with sharp and with broad highlights.
    pub by_gloss: Vec<GlossGroup>,
    /// Figures of each material.
    pub materials: Vec<StudiedMaterial>,
    /// Materials that could not be studied, each with the reason.
    pub skipped: Vec<String>,
}

/// A material to study.
#[derive(Clone, Copy)]
pub struct StudyInput<'a> {
    /// The material, taken to be isotropic.
    pub brdf: &'a dyn Brdf,
    /// What it is called in the record.
    pub name: &'a str,
    /// Where it is from, for what is said if it cannot be studied.
    pub source: &'a str,
    /// Kind of its data.
    pub kind: &'a str,
    /// Whether values are interpolated between scattered measurements.
    pub interpolated: bool,
}

impl fmt::Debug for StudyInput<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("StudyInput").field("name", &self.name).finish_non_exhaustive()
    }
}

/// The figures of one material.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StudiedMaterial {
    /// Name of the material.
    pub material: String,
    /// Kind of its data.
    pub kind: String,
    /// Whether values were interpolated between scattered measurements.
    pub interpolated: bool,
    /// Mean of |f − f′| over the mean of f, with f′ the value after a quarter turn; the study takes it to be
    /// 0.
    pub anisotropy: f64,
    /// Figures for each parametrization.
    pub rows: Vec<ParametrizationRow>,
}

/// The numbers of materials for which each parametrization has the smallest value of a figure.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Wins {
    /// Name of the figure.
    pub figure: &'static str,
    /// Number of materials, for each parametrization.
    pub counts: Vec<(Parametrization, usize)>,
}

/// The medians of all figures over materials, for one parametrization.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Medians {
    /// Parametrization of the medians.
    pub parametrization: Parametrization,
    /// Name and median of each figure.
    pub values: Vec<(&'static str, f64)>,
}

/// The counts of wins among a group of materials.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct GlossGroup {
    /// Name of the group.
    pub group: &'static str,
    /// Number of materials in the group.
    pub materials: usize,
    /// Number of materials for which each parametrization is best.
    pub wins: Vec<Wins>,
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

impl StudiedMaterial {
    /// Returns whether the material is anisotropic by more than interpolation in tables explains.
    pub fn is_anisotropic(&self) -> bool {
        self.anisotropy > ANISOTROPIC
    }

    /// Resampled half/difference tables lose most where highlights are sharp: the error that groups
    /// materials.
    fn sharpness(&self) -> f64 {
        let rows = self.rows.iter().map(|row| row.resampled);
        rows.fold(f64::INFINITY, f64::min)
    }
}

impl StudyReport {
    /// Studies materials and returns the record, with wins and medians over all of them. Those without data stand in
    /// [`StudyReport::skipped`]. `version` is that of the program.
    ///
    /// # Errors
    ///
    /// [`Stopped`].
    pub fn of(
        version: &str,
        inputs: &[StudyInput<'_>],
        params: StudyParams,
        job: &Job<'_>,
    ) -> Result<Self, Stopped> {
        let (mut materials, mut skipped) = (Vec::new(), Vec::new());
        for (input, job) in inputs.iter().zip(job.split_into(&vec![1.0; inputs.len()])) {
            match study_material(input.brdf, &params, &job) {
                Ok(rows) => materials.push(StudiedMaterial {
                    material: input.name.to_owned(),
                    kind: input.kind.to_owned(),
                    interpolated: input.interpolated,
                    anisotropy: anisotropy(input.brdf),
                    rows,
                }),
                Err(SeparableError::Stopped(stopped)) => return Err(stopped),
                Err(error) => skipped.push(format!("{}: {error}", input.source)),
            }
        }
        Ok(Self::summed(version, materials, skipped, params))
    }

    fn summed(
        version: &str,
        materials: Vec<StudiedMaterial>,
        skipped: Vec<String>,
        params: StudyParams,
    ) -> Self {
        let all: Vec<&StudiedMaterial> = materials.iter().collect();
        let mut by_sharpness = all.clone();
        by_sharpness.sort_by(|a, b| b.sharpness().total_cmp(&a.sharpness()));
        let (sharp, broad) = by_sharpness.split_at(by_sharpness.len().div_ceil(2));
        let group = |group, members: &[&StudiedMaterial]| GlossGroup {
            group,
            materials: members.len(),
            wins: wins(members),
        };
        Self {
            brdf: version.to_owned(),
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

    /// Returns a table with a line for each material and parametrization, for spreadsheets.
    pub fn csv(&self) -> String {
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
}

fn wins(materials: &[&StudiedMaterial]) -> Vec<Wins> {
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

fn medians(materials: &[&StudiedMaterial], parametrization: Parametrization) -> Medians {
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
