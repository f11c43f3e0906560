//! Finds projections for a built-in material and prints them: `cargo run --release -p brdf-search
//! --example search`.

#![expect(clippy::print_stdout, reason = "an example prints")]

use brdf_factor::{FactorParams, Problem, factorize};
use brdf_job::Job;
use brdf_model::{Channels, PairSampling, Preset, SampleSet, log_offsets, measure};
use brdf_param::Space;
use brdf_search::{Family, JointParams, SearchError, search_joint};

fn main() -> Result<(), SearchError> {
    let params = FactorParams { texture_size: 16, ..FactorParams::default() };
    let sampling = PairSampling { count: 45_000, seed: 1, theta_max: params.theta_max };
    let material = Preset::ALL[0];
    let samples = SampleSet::draw(&material.brdf(), &sampling, Channels::Luminance);

    let problem = Problem::new(&samples, &params)?;
    let family = Family::new(Space::Standard, true);
    let search = JointParams { terms: 3, ..JointParams::default() };
    let found = search_joint(&problem, &family, &search, &Job::new())?;

    println!("{}: {} least-squares problems solved", material.name(), found.evaluations);
    for term in &found.terms {
        let model = factorize(&samples, &family.specs(&term.projections), &params)?.model;
        let errors = measure(&samples, &model, &log_offsets(&samples));
        println!(
            "{} textures, mean square log error {:.5}",
            term.projections.len(),
            errors.log.mean_square
        );
        for projection in &term.projections {
            println!("  {:+.3?}", projection.rows().map(|row| row.to_array()));
        }
    }
    Ok(())
}
