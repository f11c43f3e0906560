//! Scattered measurements, judged by ten folds: rows that a model is judged by were not fitted.

use std::time::Instant;

use brdf_container::MaterialFile;
use brdf_fit::Material;
use brdf_model::{FitErrors, log_offsets, measure_folds};

use crate::methods::{Method, Model};

/// As many parts as `brdf factor` makes, by its seed.
const FOLDS: usize = 10;
const SEED: u64 = 1;
/// Rows beyond are not fitted and not judged, radians.
const THETA_MAX: f64 = 80.0 / 180.0 * std::f64::consts::PI;

/// Prints the errors of every model of some scattered materials.
pub(crate) fn print_folds(files: &[MaterialFile], methods: &[Method]) -> anyhow::Result<()> {
    println!("\nscattered rows, by ten folds; J: geometric mean of the four errors\n");
    println!(
        "| material | rows | model | bytes | J | log-cosine | cube root | relative | log | fits, s |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for file in files {
        let material = file.material();
        let rows = material.samples().map_or(0, |rows| rows.within(THETA_MAX).len());
        for method in methods {
            let start = Instant::now();
            let model = method.fit(&material)?;
            let errors = match &model {
                Model::Fit(fit) if fit.held_out().is_some() => fit.held_out().copied(),
                _ => over_folds(&material, method)?,
            };
            let seconds = start.elapsed().as_secs_f64();
            let columns = match errors.map(|errors| errors.fidelity) {
                Some(errors) => {
                    let all = errors.all().map(|error| format!("{error:.4}")).join(" | ");
                    format!("{:.4} | {all}", errors.score())
                }
                None => "– | – | – | – | –".to_owned(),
            };
            println!(
                "| {} | {rows} | {} | {} | {columns} | {seconds:.1} |",
                file.short_name(),
                method.name,
                model.bytes(),
            );
        }
    }
    Ok(())
}

/// The errors of rows under models that were fitted without their fold.
fn over_folds(material: &Material<'_>, method: &Method) -> anyhow::Result<Option<FitErrors>> {
    let Some(rows) = material.samples().map(|rows| rows.within(THETA_MAX)) else {
        return Ok(None);
    };
    let folds = rows.folds(FOLDS, SEED);
    let mut predicted = Vec::new();
    for fold in &folds {
        let kept: Vec<usize> =
            (0..rows.len()).filter(|index| fold.binary_search(index).is_err()).collect();
        let rest = Material::from_samples(material.name(), &rows.select(&kept));
        let model = method.fit(&rest)?;
        let values = fold.iter().map(|&index| model.brdf().eval_unclamped(&rows.pair(index)));
        predicted.push(values.collect());
    }
    Ok(Some(measure_folds(&rows, &folds, &predicted, &log_offsets(&rows))))
}
