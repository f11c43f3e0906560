//! Scattered measurements, judged by ten folds: rows that a model is judged by were not fitted.

use std::time::Instant;

use brdf_container::MaterialFile;
use brdf_fit::Material;
use brdf_model::{FitErrors, log_offsets, measure};

use crate::methods::{Method, Model};

/// As many parts as `brdf factor` makes, by its seed.
const FOLDS: usize = 10;
const SEED: u64 = 1;
/// Rows beyond are not fitted and not judged, radians.
const THETA_MAX: f64 = 80.0 / 180.0 * std::f64::consts::PI;

/// Prints the errors of every model of some scattered materials, root mean squares.
pub(crate) fn print_folds(files: &[MaterialFile], methods: &[Method]) -> anyhow::Result<()> {
    println!("\nscattered rows, by ten folds: root mean square errors\n");
    println!("| material | rows | model | bytes | log | linear, sr⁻¹ | fits, s |");
    println!("|---|---|---|---|---|---|---|");
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
            let root = |square: fn(&FitErrors) -> f64, digits: usize| {
                errors.as_ref().map_or_else(
                    || "–".to_owned(),
                    |errors| format!("{:.digits$}", square(errors).sqrt()),
                )
            };
            println!(
                "| {} | {rows} | {} | {} | {} | {} | {seconds:.1} |",
                file.short_name(),
                method.name,
                model.bytes(),
                root(|errors| errors.log.mean_square, 3),
                root(|errors| errors.linear.mean_square, 4),
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
    let offsets = log_offsets(&rows);
    let mut parts = Vec::new();
    for fold in rows.folds(FOLDS, SEED) {
        let kept: Vec<usize> =
            (0..rows.len()).filter(|index| fold.binary_search(index).is_err()).collect();
        let rest = Material::from_samples(material.name(), &rows.select(&kept));
        let model = method.fit(&rest)?;
        parts.push((measure(&rows.select(&fold), model.brdf(), &offsets), fold.len()));
    }
    Ok(Some(FitErrors::pooled(&parts)))
}
