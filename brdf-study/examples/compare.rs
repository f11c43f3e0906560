//! Compares the parametrizations on a built-in material and names the best one for each figure.
//!
//! ```sh
//! cargo run --release -p brdf-study --example compare              # plastic
//! cargo run --release -p brdf-study --example compare cook-torrance
//! ```

#![allow(clippy::print_stdout, reason = "an example")]

use std::error::Error;

use brdf_job::Job;
use brdf_model::Preset;
use brdf_study::{ParametrizationRow, StudyParams, best, study_material};

/// A figure of a row; smaller is better.
type Figure = fn(&ParametrizationRow) -> f64;

fn main() -> Result<(), Box<dyn Error>> {
    let name = std::env::args().nth(1).unwrap_or_else(|| "plastic".to_owned());
    let material = Preset::find(&name).ok_or_else(|| format!("no preset is named {name:?}"))?;
    let rows = study_material(&material.brdf(), &StudyParams::default(), &Job::new())?;

    let figures: [(&str, Figure); 4] = [
        ("isolines across axes", |row| row.alignment.across_axes),
        ("missed by 4 products", |row| 1.0 - row.energy[2]),
        ("best two coordinates", |row| row.bivariate.log_cosine_rms),
        ("table of equal size", |row| row.resampled),
    ];
    println!("{name}: {} (smaller is better)\n", material.description());
    print!("{:22}", "");
    for row in &rows {
        print!("{:>17}", row.parametrization.name());
    }
    println!("{:>17}", "best");
    for (label, figure) in figures {
        print!("{label:22}");
        for row in &rows {
            print!("{:17.5}", figure(row));
        }
        println!("{:>17}", best(&rows, figure).map_or("none", |p| p.name()));
    }
    Ok(())
}
