//! What it gains to solve the textures of two terms together, instead of the second beside a first that
//! stays: `cargo run --release -p brdf-cli --example terms_together`.
//!
//! Cole 2002, section 3.2.2, finds a significant improvement from n = 1 to n = 2. Luminance, 45,000 samples,
//! textures of 16², reciprocal, half/difference space; measured files are read from `BRDF_DATA` (default
//! `../shared/data`) and skipped without it.

#![expect(clippy::print_stdout, reason = "an example prints")]

use std::path::PathBuf;

use brdf_container::MaterialFile;
use brdf_factor::{FactorParams, FactorSpec, Problem, TermSolve, factorize_terms};
use brdf_io::ReadOptions;
use brdf_job::Job;
use brdf_model::{Channels, PairSampling, SampleSet, log_offsets, measure};
use brdf_param::Space;
use brdf_search::{Family, GreedyParams, search_greedy};

const PRESETS: [&str; 3] =
    ["preset:lafortune-blue-paint", "preset:cook-torrance", "preset:ashikhmin-shirley"];
const FILES: [&str; 2] =
    ["merl_layout_derived/vch_silk_blue.binary", "rgl/cm_military_green_rgb.bsdf"];

fn main() -> anyhow::Result<()> {
    println!("mean square log error of two textures; in brackets, of the first alone\n");
    println!(
        "McCool: p(wi) p(wo), then q(h). Searched: the planes of the thesis' search with n = 1."
    );
    println!("Last: the planes of its search with n = 2, solved together.\n");
    println!(
        "{:28} {:30} {:30} {:8}",
        "", "McCool: alone, together", "searched: alone, together", "n = 2"
    );
    let folder = std::env::var_os("BRDF_DATA")
        .map_or_else(|| PathBuf::from("../shared/data"), PathBuf::from);
    let files = FILES.iter().map(|file| folder.join(file).to_string_lossy().into_owned());
    for source in PRESETS.into_iter().map(str::to_owned).chain(files) {
        if !source.starts_with("preset:") && !PathBuf::from(&source).exists() {
            println!("skipped: {source} is missing; set BRDF_DATA");
            continue;
        }
        let file = MaterialFile::open(&source, &ReadOptions::default())?;
        let theta_max = FactorParams::default().theta_max;
        let sampling = PairSampling { count: 45_000, seed: 1, theta_max };
        let samples = SampleSet::draw(file.brdf(), &sampling, Channels::Luminance);
        let mccool = Errors::of(&samples, &FactorSpec::mccool(true))?;
        let searched = Errors::of(&samples, &found(&samples, 1)?)?;
        let both = Errors::of(&samples, &found(&samples, 2)?)?.together;
        let name = file.short_name();
        println!("{name:28} {:30} {:30} {both:.5}", mccool.to_string(), searched.to_string());
    }
    Ok(())
}

/// The factors of two planes that the thesis' search finds with the last `last` terms solved together.
fn found(samples: &SampleSet, last: usize) -> anyhow::Result<Vec<FactorSpec>> {
    let problem = Problem::new(samples, &params(TermSolve::Last(last)))?;
    let family = Family::new(Space::HalfDifference, true);
    let search = GreedyParams { terms: 2, last, ..GreedyParams::default() };
    let found = search_greedy(&problem, &family, &search, &Job::new())?;
    Ok(family.specs(&found.terms[1].projections))
}

/// Errors of two factors.
struct Errors {
    /// Of the first alone.
    first: f64,
    /// Of both, the second solved for beside the first.
    alone: f64,
    /// Of both, solved for together.
    together: f64,
}

impl Errors {
    fn of(samples: &SampleSet, specs: &[FactorSpec]) -> anyhow::Result<Self> {
        let offsets = log_offsets(samples);
        let errors = |terms| -> anyhow::Result<Vec<f64>> {
            let fits = factorize_terms(samples, specs, &params(terms))?;
            let errors = fits.iter().map(|fit| measure(samples, &fit.model, &offsets));
            Ok(errors.map(|errors| errors.log.mean_square).collect())
        };
        let (alone, together) = (errors(TermSolve::Last(1))?, errors(TermSolve::All)?);
        Ok(Self { first: alone[0], alone: alone[1], together: together[1] })
    }
}

impl std::fmt::Display for Errors {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { first, alone, together } = self;
        let share = 100.0 * (1.0 - together / alone);
        write!(f, "({first:.4}) {alone:.5} {together:.5} −{share:.0} %")
    }
}

fn params(terms: TermSolve) -> FactorParams {
    FactorParams { texture_size: 16, terms, ..FactorParams::default() }
}
