//! Errors of models of several sizes of one preset: `cargo run --release -p brdf-spline --example sizes`.

use std::error::Error;
use std::io::Write as _;

use brdf_job::Job;
use brdf_model::{FidelityPairs, Preset};
use brdf_spline::{SplineSettings, fit_splines};

fn main() -> Result<(), Box<dyn Error>> {
    let gold = Preset::find("ggx").ok_or("no such preset")?.brdf();
    let judge = FidelityPairs::new(1, 80_f64.to_radians());
    let mut out = std::io::stdout().lock();
    writeln!(out, "bytes  terms  J        log-cosine RMS at the highlight")?;
    for bytes in [500, 1_000, 2_700, 8_192] {
        let settings = SplineSettings { bytes, ..SplineSettings::default() };
        let model = fit_splines(&gold, &settings, &Job::new())?.model;
        let errors = judge.measure(&gold, &model);
        let (score, highlight) = (errors.score(), errors.highlight.log_cosine);
        writeln!(
            out,
            "{:5}  {:5}  {score:.5}  {highlight:.5}",
            model.as_bytes().len(),
            model.terms()
        )?;
    }
    Ok(())
}
