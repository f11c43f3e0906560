#![allow(clippy::print_stdout, clippy::unwrap_used)]
use brdf_factor::*;
use brdf_model::*;
use brdf_param::*;
use brdf_search::*;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let space = if args[2] == "std" { Space::Standard } else { Space::HalfDifference };
    let seed: u64 = args[3].parse().unwrap();
    let paint = Preset::find(&args[1]).unwrap().brdf();
    let params = FactorParams { texture_size: 16, ..FactorParams::default() };
    let sampling = PairSampling { count: 45_000, seed, theta_max: params.theta_max };
    let samples = SampleSet::draw(&paint, &sampling, Channels::Luminance);
    let held = SampleSet::draw(
        &paint,
        &PairSampling {
            count: 20_000,
            seed: ScrambledSobol::held_out_seed(seed),
            theta_max: params.theta_max,
        },
        Channels::Luminance,
    );
    let clock = std::time::Instant::now();
    let problem = Problem::new(&samples, &params).unwrap();
    let j = JointParams { seed, ..JointParams::default() };
    let family = Family::new(space, true);
    let out = search_joint(&problem, &family, &j, Control::default()).unwrap();
    print!("{} {} seed {seed}: search {:.2?}", args[1], args[2], clock.elapsed());
    let offsets = log_offsets(&samples);
    print!(" {} evals", out.evaluations);
    for t in out.terms {
        let (p, e) = (t.projections, t.error);
        let fit = factorize(&samples, &FactorSpec::projections(space, &p, true), &params).unwrap();
        let _ = e;
        if std::env::var("SHOW").is_ok() {
            println!();
            for q in &p {
                println!("   {:.2?}", q.rows());
            }
        }
        print!(
            "  {:.5}/{:.5}",
            measure(&samples, &fit.model, &offsets).log.mean_square,
            measure(&held, &fit.model, &offsets).log.mean_square
        );
    }
    println!();
}
