//! Fits a preset and makes the files of its report in memory: their names and sizes.
//!
//! `cargo run --release -p brdf-report --example files -- cook-torrance`

#![expect(clippy::print_stdout, reason = "an example prints what it found")]

use brdf_fit::{FactoredMethod, FactoredSettings, Material, fit_factored};
use brdf_job::Job;
use brdf_model::Preset;
use brdf_report::{bytes, factored_files, fit_note};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let name = std::env::args().nth(1).unwrap_or_else(|| "lafortune-blue-paint".to_owned());
    let preset = Preset::find(&name).ok_or("no such preset")?.brdf();
    let material = Material::new(name.as_str(), &preset);
    let settings = FactoredSettings::of(FactoredMethod::McCool);
    let fit = fit_factored(&material, &settings, &Job::new())?;

    let notes: Vec<String> = fit.notes.iter().map(fit_note).collect();
    for note in &notes {
        println!("note: {note}");
    }
    let report = fit.report(&format!("preset:{name}"), env!("CARGO_PKG_VERSION"), notes);
    for file in factored_files(&material, &fit, &report, "the example `files` of brdf-report")? {
        println!("{:>10}  {}", bytes(file.bytes.len()), file.name);
    }
    Ok(())
}
