//! A preset by three methods: bytes, errors on samples that were not fitted, and notes.
//!
//! `cargo run --release -p brdf-fit --example methods -- cook-torrance`

#![expect(clippy::print_stdout, reason = "an example prints what it found")]

use brdf_fit::{
    FactoredMethod, FactoredSettings, FitSettings, LogChoice, Material, SearchSettings,
    SeparableMethod, SeparableSettings, fit,
};
use brdf_job::Job;
use brdf_model::Preset;
use brdf_param::{Parametrization, Space};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let name = std::env::args().nth(1).unwrap_or_else(|| "lafortune-blue-paint".to_owned());
    let preset = Preset::find(&name).ok_or("no such preset")?.brdf();
    let material = Material::new(name, &preset);
    let search = SearchSettings {
        terms: 2,
        spaces: vec![Space::HalfDifference],
        ..SearchSettings::default()
    };
    let settings = [
        FitSettings::Factored(FactoredSettings::of(FactoredMethod::McCool)),
        FitSettings::Factored(FactoredSettings {
            samples: 20_000,
            ..FactoredSettings::of(FactoredMethod::Search(search))
        }),
        FitSettings::Separable(SeparableSettings {
            parametrization: Parametrization::HalfDifference,
            isotropic: true,
            joint_rgb: true,
            resolution: 26,
            ..SeparableSettings::of(SeparableMethod::LogSvd(LogChoice::Offset))
        }),
    ];
    for settings in &settings {
        let fit = fit(&material, settings, &Job::new())?;
        let errors = fit.held_out().ok_or("nothing was held out")?;
        println!(
            "{} by {}: {} bytes, held out: mean square log error {:.5}, mean error {:.5} / sr",
            material.name(),
            fit.method().name(),
            fit.bytes(),
            errors.log.mean_square,
            errors.linear.mean_abs
        );
        for note in fit.notes() {
            println!("  {note:?}");
        }
    }
    Ok(())
}
