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
    let held = SampleSet::draw(&paint, &PairSampling { count: 20_000, seed: ScrambledSobol::held_out_seed(seed), theta_max: params.theta_max }, Channels::Luminance);
    let clock = std::time::Instant::now();
    let problem = Problem::new(&samples, &params).unwrap();
    let mut j = JointParams { seed, ..JointParams::default() };
    for a in &args[4..] {
        let (k, v) = a.split_once('=').unwrap();
        let v: Vec<f64> = v.split(',').map(|x| x.parse().unwrap()).collect();
        let u = |i: usize| v[i] as usize;
        match k {
            "coarse" => j.coarse = (u(0), u(1)),
            "medium" => j.medium = (u(0), u(1)),
            "mu" => j.coarse_mu = v[0],
            "starts" => j.starts = v.iter().map(|&x| x as usize).collect(),
            "screened" => j.screened = u(0),
            "extended" => j.extended = u(0),
            "beam" => j.beam = u(0),
            "sk" => j.screen_keep = u(0),
            "ss" => j.screen_steps = u(0),
            "tol" => j.tol = v[0],
            "fs" => j.fine_steps = u(0),
            "rounds" => j.rounds = v.chunks(3).map(|c| (c[0] as usize, c[1] as usize, c[2])).collect(),
            "mr" => j.medium_rounds = v.chunks(3).map(|c| (c[0] as usize, c[1] as usize, c[2])).collect(),
            _ => panic!("{k}"),
        }
    }
    let out = search_joint(&problem, space, true, &[], 5, &j, Control::default()).unwrap();
    print!("{} {} seed {seed}: search {:.2?}", args[1], args[2], clock.elapsed());
    let offsets = log_offsets(&samples);
    for (p, e) in out {
        let fit = factorize(&samples, &FactorSpec::projections(space, &p, true), &params).unwrap();
        let _ = e; print!("  {:.5}/{:.5}", measure(&samples, &fit.model, &offsets).log.mean_square, measure(&held, &fit.model, &offsets).log.mean_square);
    }
    println!();
}
