//! The measured figures of one material under every parametrization.

use brdf_job::Job;
use brdf_model::{Brdf, Channels, PairSampling, SampleSet};
use brdf_param::{DirectionPair, Parametrization};
use brdf_separable::SeparableError;
use rayon::prelude::*;
use serde::Serialize;

use crate::STUDIED;
use crate::grid::{Grid, Means, unit_coordinates};
use crate::slice::{SliceAlignment, alignment};

/// The options of a study.
///
/// The defaults give every parametrization 13,824 nodes for resampling.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StudyParams {
    /// Number of pairs that errors are measured on; means are taken over as many others.
    pub pairs: u32,
    /// Grazing limit, radians, (0, π/2]: pairs lie within it.
    pub theta_max: f64,
    /// Number of nodes along each of the three axes of the resampled table.
    pub table: usize,
    /// Number of bins along each side of a reduction to two coordinates.
    pub bins: usize,
    /// Seed of the pairs.
    pub seed: u64,
}

impl Default for StudyParams {
    fn default() -> Self {
        Self { pairs: 20_000, theta_max: 80_f64.to_radians(), table: 24, bins: 24, seed: 1 }
    }
}

/// Ranks whose energy is reported.
const RANKS: [usize; 4] = [1, 2, 4, 8];

/// The best function of two of a parametrization's three isotropic coordinates.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Bivariate {
    /// Names of the two coordinates.
    pub coordinates: [&'static str; 2],
    /// Root of the mean of (y − ŷ)², with y = ln(1 + f cosθi), on pairs that the means were not taken over.
    pub log_cosine_rms: f64,
}

/// The figures of one material under one parametrization.
///
/// Errors are root mean squares of y = ln(1 + f cosθi), with f the luminance, over the same pairs for all
/// parametrizations.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ParametrizationRow {
    /// Parametrization that the figures belong to.
    pub parametrization: Parametrization,
    /// Alignment of isolines with the axes.
    pub alignment: SliceAlignment,
    /// Energy kept by the best sums of 1, 2, 4 and 8 products of a function of the first radius and one of
    /// the other two coordinates: 1 − Σ(y − ŷ)² / Σ(y − ȳ)² over the pairs, with y the resampled table.
    pub energy: [f64; 4],
    /// The best reduction to two coordinates.
    pub bivariate: Bivariate,
    /// Error of the best function of both radii, without the azimuth.
    pub radii_only: f64,
    /// Error of a table of equal size, read trilinearly.
    pub resampled: f64,
}

/// Returns the figures of a material under every parametrization of [`STUDIED`], in that order.
///
/// The material is taken to be isotropic. The `job` is told of progress and can stop the work.
///
/// # Errors
///
/// [`SeparableError::NoData`] for a material without data within the grazing limit.
pub fn study_material(
    brdf: &dyn Brdf,
    params: &StudyParams,
    job: &Job<'_>,
) -> Result<Vec<ParametrizationRow>, SeparableError> {
    job.begin("studying", STUDIED.len() as u64);
    let pairs = |seed| {
        let sampling = PairSampling { count: params.pairs, seed, theta_max: params.theta_max };
        let drawn = SampleSet::draw(brdf, &sampling, Channels::Luminance);
        let targets = drawn
            .pairs()
            .zip(&drawn.values()[0])
            .map(|(pair, f)| (f * pair.wi.z).ln_1p())
            .collect();
        (drawn.pairs().collect::<Vec<DirectionPair>>(), targets)
    };
    let (means, judged): (Judged, Judged) =
        (Judged::new(pairs(params.seed)), Judged::new(pairs(params.seed.wrapping_add(1))));
    if judged.pairs.is_empty() || means.pairs.is_empty() {
        return Err(SeparableError::NoData { rows: params.table, columns: params.table.pow(2) });
    }
    STUDIED
        .par_iter()
        .map(|&parametrization| {
            job.check()?;
            let row = row(brdf, parametrization, params, &means, &judged);
            job.advance(1);
            row
        })
        .collect()
}

/// Returns the parametrization with the smallest figure, the first of equal ones, or `None` without rows.
pub fn best(
    rows: &[ParametrizationRow],
    figure: impl Fn(&ParametrizationRow) -> f64,
) -> Option<Parametrization> {
    let mut best: Option<(f64, Parametrization)> = None;
    for row in rows {
        let value = figure(row);
        if best.is_none_or(|(smallest, _)| value < smallest) {
            best = Some((value, row.parametrization));
        }
    }
    best.map(|(_, parametrization)| parametrization)
}

/// Pairs and what is to be matched on them.
struct Judged {
    pairs: Vec<DirectionPair>,
    targets: Vec<f64>,
}

impl Judged {
    fn new((pairs, targets): (Vec<DirectionPair>, Vec<f64>)) -> Self {
        Self { pairs, targets }
    }

    fn rms(&self, predicted: impl Fn(usize) -> f64) -> f64 {
        let sum: f64 =
            self.targets.iter().enumerate().map(|(i, y)| (predicted(i) - y).powi(2)).sum();
        (sum / count(self.targets.len())).sqrt()
    }
}

fn count(length: usize) -> f64 {
    length.max(1) as f64
}

fn row(
    brdf: &dyn Brdf,
    parametrization: Parametrization,
    params: &StudyParams,
    means: &Judged,
    judged: &Judged,
) -> Result<ParametrizationRow, SeparableError> {
    let coordinates = |set: &Judged| -> Vec<[f64; 3]> {
        set.pairs.iter().map(|pair| unit_coordinates(parametrization, pair)).collect()
    };
    let (known, asked) = (coordinates(means), coordinates(judged));
    let table = Grid::tabulate(brdf, parametrization, params.table, |pair| {
        (brdf.eval(pair).luminance() * pair.wi.z).ln_1p()
    });
    let names = parametrization.isotropic_names();
    let reductions: Vec<Bivariate> = [[0, 1], [0, 2], [1, 2]]
        .into_iter()
        .map(|[a, b]| {
            let pick = |points: &[[f64; 3]]| -> Vec<[f64; 2]> {
                points.iter().map(|point| [point[a], point[b]]).collect()
            };
            let reduced = Means::of(&pick(&known), &means.targets, params.bins);
            let points = pick(&asked);
            Bivariate {
                coordinates: [names[a], names[b]],
                log_cosine_rms: judged.rms(|i| reduced.at(points[i])),
            }
        })
        .collect();
    let radii_only = reductions[0].log_cosine_rms;
    let bivariate = reductions
        .into_iter()
        .min_by(|a, b| a.log_cosine_rms.total_cmp(&b.log_cosine_rms))
        .unwrap_or(Bivariate { coordinates: [names[0], names[1]], log_cosine_rms: radii_only });
    Ok(ParametrizationRow {
        parametrization,
        alignment: alignment(brdf, parametrization),
        energy: energies(&table, &asked)?,
        bivariate,
        radii_only,
        resampled: judged.rms(|i| table.read(asked[i])),
    })
}

/// Share of a table's variance, on the common pairs, that sums of products keep.
fn energies(table: &Grid, asked: &[[f64; 3]]) -> Result<[f64; 4], SeparableError> {
    let whole: Vec<f64> = asked.iter().map(|&at| table.read(at)).collect();
    let mean = whole.iter().sum::<f64>() / count(whole.len());
    let spread: f64 = whole.iter().map(|v| (v - mean).powi(2)).sum();
    let mut energy = [1.0; RANKS.len()];
    for (energy, rank) in energy.iter_mut().zip(RANKS) {
        let short = table.truncated(rank)?;
        let missed: f64 =
            asked.iter().zip(&whole).map(|(&at, v)| (short.read(at) - v).powi(2)).sum();
        if spread > 0.0 {
            *energy = 1.0 - missed / spread;
        }
    }
    Ok(energy)
}
