#![allow(clippy::print_stdout, clippy::unwrap_used)]
use brdf_factor::*;
use brdf_model::*;
use brdf_param::*;
use brdf_search::*;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let space = if args[2] == "std" { Space::Standard } else { Space::HalfDifference };
    let paint = Preset::find(&args[1]).unwrap().brdf();
    let params = FactorParams {
        texture_size: 16,
        bound: Bound::Cube,
        smoothing: 1e-3,
        terms: TermSolve::Last(2),
        ..FactorParams::default()
    };
    let sampling = PairSampling { count: 45_000, seed: 1, theta_max: params.theta_max };
    let samples = SampleSet::draw(&paint, &sampling, Channels::Luminance);
    let clock = std::time::Instant::now();
    let problem = Problem::new(&samples, &params).unwrap();
    let family = Family::new(space, true);
    let out =
        search_greedy(&problem, &family, &GreedyParams::default(), Control::default()).unwrap();
    println!(
        "{:.2?} {} evals {:?}",
        clock.elapsed(),
        out.evaluations,
        out.terms.iter().map(|t| t.error).collect::<Vec<_>>()
    );
    let offsets = log_offsets(&samples);
    let fits =
        factorize_terms(&samples, &family.specs(&out.terms[4].projections), &params).unwrap();
    for fit in fits {
        println!("  {:.5}", measure(&samples, &fit.model, &offsets).log.mean_square);
    }
}
