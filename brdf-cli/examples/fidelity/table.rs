//! Models judged on dense pairs, as lines and as medians.

use std::time::Instant;

use brdf_container::MaterialFile;
use brdf_fit::{Candidate, CompareSettings, compare, metric_lights};
use brdf_job::Job;
use brdf_model::{Fidelity, FidelityPairs};

use crate::methods::{Method, Model};

/// Which scramble the pairs of errors come from: no fit uses it.
const SEED: u64 = 4711;

/// A model of one material.
pub(crate) struct Row {
    pub(crate) name: &'static str,
    pub(crate) family: &'static str,
    pub(crate) is_shown: bool,
    pub(crate) model: Model,
    pub(crate) seconds: f64,
    pub(crate) fidelity: Fidelity,
    /// ΔE_ITP of a sphere under the studio.
    pub(crate) studio: f64,
}

/// Fits a material by every method, and judges the models.
pub(crate) fn measure(file: &MaterialFile, methods: &[Method]) -> anyhow::Result<Vec<Row>> {
    let material = file.material();
    let judge = FidelityPairs::new(SEED, 80_f64.to_radians());
    let mut rows = Vec::new();
    for method in methods {
        let start = Instant::now();
        let model = method.fit(&material)?;
        let seconds = start.elapsed().as_secs_f64();
        let fidelity = judge.measure(material.brdf(), model.brdf());
        let Method { name, family, is_shown, .. } = *method;
        rows.push(Row { name, family, is_shown, model, seconds, fidelity, studio: 0.0 });
    }
    let studio = metric_lights(None)?.into_iter().filter(|(name, _)| name == "studio");
    let settings =
        CompareSettings { samples: 1000, lights: studio.collect(), ..CompareSettings::default() };
    let candidates: Vec<Candidate<'_>> = rows
        .iter()
        .map(|row| Candidate {
            label: row.name.to_owned(),
            brdf: row.model.brdf(),
            bytes: row.model.bytes(),
        })
        .collect();
    let compared = compare(&material, &candidates, &settings, &Job::new())?;
    for (row, result) in rows.iter_mut().zip(&compared.results) {
        row.studio = result.pictures.first().map_or(0.0, |p| p.errors.delta_e_itp);
    }
    Ok(rows)
}

pub(crate) fn print_header() {
    println!(
        "{:34} {:14} {:>6} {:>6}  {:>7}  {:>7} {:>7}  {:>7} {:>7}  {:>6}",
        "material", "model", "bytes", "s", "J", "lc", "rel", "lc hl", "rel hl", "ΔE_ITP"
    );
}

pub(crate) fn print_row(material: &str, row: &Row) {
    let Fidelity { uniform, highlight } = row.fidelity;
    println!(
        "{material:34} {:14} {:6} {:6.2}  {:.5}  {:.5} {:7.4}  {:.5} {:7.4}  {:6.2}",
        row.name,
        row.model.bytes(),
        row.seconds,
        row.fidelity.score(),
        uniform.log_cosine,
        uniform.cosine_relative,
        highlight.log_cosine,
        highlight.cosine_relative,
        row.studio
    );
}

/// The mean of the two middle values, and the largest.
pub(crate) fn median_and_worst(mut values: Vec<f64>) -> Option<(f64, f64)> {
    values.sort_by(f64::total_cmp);
    let worst = *values.last()?;
    Some((0.5 * (values[(values.len() - 1) / 2] + values[values.len() / 2]), worst))
}

/// Prints the median and the worst of each model over some materials.
pub(crate) fn summarize(what: &str, materials: &[&Vec<Row>]) {
    let Some(first) = materials.first() else { return };
    println!("\n{} {what}: median (worst)\n", materials.len());
    println!(
        "| model | bytes | J | log-cosine | at the highlight | relative | at the highlight | ΔE_ITP | fit, s |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for index in 0..first.len() {
        let figure = |digits: usize, of: &dyn Fn(&Row) -> f64| {
            let values = materials.iter().map(|rows| of(&rows[index])).collect();
            let (median, worst) = median_and_worst(values).unwrap_or_default();
            format!("{median:.digits$} ({worst:.digits$})")
        };
        println!(
            "| {} | {} | {} | {} | {} | {} | {} | {} | {} |",
            first[index].name,
            figure(0, &|row| row.model.bytes() as f64),
            figure(4, &|row| row.fidelity.score()),
            figure(4, &|row| row.fidelity.uniform.log_cosine),
            figure(4, &|row| row.fidelity.highlight.log_cosine),
            figure(3, &|row| row.fidelity.uniform.cosine_relative),
            figure(3, &|row| row.fidelity.highlight.cosine_relative),
            figure(1, &|row| row.studio),
            figure(2, &|row| row.seconds),
        );
    }
}
