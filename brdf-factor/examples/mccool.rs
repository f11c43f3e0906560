//! McCool's factorization of a preset, with all three solvers.
//!
//! `cargo run --release -p brdf-factor --example mccool -- cook-torrance`

#![expect(clippy::print_stdout, reason = "an example prints what it found")]

use std::time::Instant;

use brdf_factor::{FactorParams, FactorSpec, Solver, factorize};
use brdf_model::{Channels, PairSampling, Preset, SampleSet, log_offsets, measure};
use brdf_param::Bound;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let name = std::env::args().nth(1).unwrap_or_else(|| "lafortune-blue-paint".to_owned());
    let material = Preset::find(&name).ok_or("no such preset")?.brdf();
    let thesis = FactorParams {
        texture_size: 16,
        bound: Bound::Cube,
        smoothing: 1e-3,
        ..FactorParams::default()
    };
    let sampling = PairSampling { count: 45_000, seed: 1, theta_max: thesis.theta_max };
    let samples = SampleSet::draw(&material, &sampling, Channels::Luminance);
    let unseen = SampleSet::draw(
        &material,
        &PairSampling { count: 20_000, seed: 2, ..sampling },
        Channels::Luminance,
    );
    for solver in [Solver::Cholesky, Solver::Lsmr, Solver::Qmr] {
        let start = Instant::now();
        let params = FactorParams { solver: Some(solver), ..thesis };
        let fit = factorize(&samples, &FactorSpec::mccool(true), &params)?;
        let elapsed = start.elapsed();
        let offsets = log_offsets(&samples);
        let errors = measure(&samples, &fit.model, &offsets);
        let held_out = measure(&unseen, &fit.model, &offsets);
        println!(
            "{name} {solver:?}: mean square log error {:.5}, held out {:.5}, {} unknowns, \
             {} iterations, converged {}, {elapsed:.1?}",
            errors.log.mean_square,
            held_out.log.mean_square,
            fit.unknowns,
            fit.iterations,
            fit.converged
        );
    }
    Ok(())
}
