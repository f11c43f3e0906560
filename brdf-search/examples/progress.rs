//! How well a search foresees its end: the share that it says is done, against the share of its time.
//!
//! ```sh
//! cargo run --release -p brdf-search --example progress -- lafortune-blue-paint standard joint
//! ```
//!
//! Other presets, `half-difference` and `powell` likewise.

#![allow(clippy::print_stdout, reason = "a program that prints a table")]

use std::error::Error;
use std::sync::Mutex;
use std::time::Instant;

use brdf_factor::{FactorParams, Problem};
use brdf_job::{Job, Progress};
use brdf_model::{Channels, PairSampling, Preset, SampleSet};
use brdf_param::Space;
use brdf_search::{Family, GreedyParams, JointParams, search_greedy, search_joint};

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let word = |index: usize, default: &str| -> String {
        words.get(index).cloned().unwrap_or_else(|| default.to_owned())
    };
    let name = word(0, "lafortune-blue-paint");
    let preset = Preset::find(&name).ok_or("no such preset")?.brdf();
    let space = match word(1, "standard").as_str() {
        "standard" => Space::Standard,
        _ => Space::HalfDifference,
    };
    let params = FactorParams { texture_size: 16, ..FactorParams::default() };
    let sampling = PairSampling { count: 45_000, seed: 1, theta_max: params.theta_max };
    let samples = SampleSet::draw(&preset, &sampling, Channels::Luminance);
    let problem = Problem::new(&samples, &params)?;
    let family = Family::new(space, true);

    let start = Instant::now();
    let seen: Mutex<Vec<(f64, f64, String)>> = Mutex::new(Vec::new());
    let watch = |progress: &Progress<'_>| {
        if let Ok(mut seen) = seen.lock() {
            let now = start.elapsed().as_secs_f64();
            seen.push((now, progress.fraction, progress.stage.to_owned()));
        }
    };
    let job = Job::watched_by(&watch);
    let outcome = match word(2, "joint").as_str() {
        "powell" => search_greedy(&problem, &family, &GreedyParams::default(), &job)?,
        _ => search_joint(&problem, &family, &JointParams::default(), &job)?,
    };
    let seconds = start.elapsed().as_secs_f64();
    let errors: Vec<String> = outcome.terms.iter().map(|t| format!("{:.3e}", t.error)).collect();
    println!("{seconds:.2} s, {} evaluations, {}", outcome.evaluations, errors.join(" "));

    println!("   time    said");
    let seen = seen.into_inner()?;
    let (mut shown, mut last) = (0.0, String::new());
    for (now, fraction, stage) in &seen {
        // Once for each part of the search, and for each tenth of its time.
        let part = stage.split(',').next().unwrap_or_default();
        if part != last || now / seconds >= shown {
            println!("{:6.1} % {:6.1} %  {stage}", 100.0 * now / seconds, 100.0 * fraction);
            part.clone_into(&mut last);
            shown = (10.0 * now / seconds).floor() / 10.0 + 0.1;
        }
    }
    Ok(())
}
