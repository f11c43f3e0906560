//! The claims of Cole 2002, section 4.4, beside what this project measures: `cargo run --release -p
//! brdf-cli --example thesis_claims`.
//!
//! The thesis' search as published (Powell, 16², cube, μ 1e-3, the last two terms solved together) and
//! the joint search (disc, μ 1e-4) on the luminance of the blue paint, Cook–Torrance, and the two
//! Cornell paints, which are read from `BRDF_DATA` (default `../shared/data`) and skipped without it.

#![expect(clippy::print_stdout, reason = "an example prints")]

use std::path::PathBuf;

use brdf_container::MaterialFile;
use brdf_factor::{FactorParams, FactorSpec, Problem, TermSolve, factorize, factorize_terms};
use brdf_io::ReadOptions;
use brdf_job::Job;
use brdf_model::{Channels, PairSampling, Preset, SampleSet, log_offsets, measure};
use brdf_param::{Bound, Space};
use brdf_search::{Family, GreedyParams, JointParams, SearchOutcome, search_greedy, search_joint};

const SPACES: [(Space, &str); 2] = [(Space::Standard, "std"), (Space::HalfDifference, "h/d")];

fn main() -> anyhow::Result<()> {
    println!("mean square log error by number of textures; reciprocal unless said\n");
    let blue = Rows::measure("blue paint", &preset("lafortune-blue-paint"), 5)?;
    let gloss = Rows::measure("Cook–Torrance", &preset("cook-torrance"), 5)?;
    let garnet = cornell("garnet_red")?.map(|s| Rows::measure("garnet red", &s, 2)).transpose()?;
    let krylon =
        cornell("krylon_blue")?.map(|s| Rows::measure("krylon blue", &s, 2)).transpose()?;

    println!(
        "\nclaim                                                   thesis      Powell       joint"
    );
    let below = |error: f64, than: f64| {
        let share = 100.0 * (1.0 - error / than);
        format!("{:.0} % {}", share.abs(), if share < 0.0 { "above" } else { "below" })
    };
    let claim = |text: &str, thesis: &str, powell: String, joint: String| {
        println!("{text:54}  {thesis:>10}  {powell:>10}  {joint:>10}");
    };
    let two = |rows: &Rows, strategy: usize, space: usize| rows.searched[strategy][space][1];
    let five = |rows: &Rows, strategy: usize, space: usize| rows.searched[strategy][space][4];
    let each = |f: &dyn Fn(usize) -> String| (f(0), f(1));
    let (powell, joint) = each(&|s| below(two(&blue, s, 0), blue.mccool));
    claim("blue paint, two textures, std, against McCool", "83 % below", powell, joint);
    let (powell, joint) = each(&|s| below(two(&blue, s, 1), blue.mccool));
    claim("the same in h/d", "–", powell, joint);
    let (powell, joint) = each(&|s| below(five(&blue, s, 0), two(&blue, s, 0)));
    claim("blue paint, std, five textures against two", "> 50 %", powell, joint);
    let (powell, joint) = each(&|s| below(five(&blue, s, 0), five(&blue, s, 1)));
    claim("blue paint, five textures, std against h/d", "50 % below", powell, joint);
    let (powell, joint) = each(&|s| below(two(&gloss, s, 0), gloss.mccool));
    claim("Cook–Torrance, two textures, std, against McCool", "equal", powell, joint);
    let (powell, joint) = each(&|s| below(two(&gloss, s, 1), gloss.mccool));
    claim("the same in h/d", "lower", powell, joint);
    for (name, rows) in [("garnet red", &garnet), ("krylon blue", &krylon)] {
        let Some(rows) = rows else { continue };
        let best = |s: usize| two(rows, s, 0).min(two(rows, s, 1));
        let (powell, joint) = each(&|s| below(best(s), rows.mccool));
        claim(
            &format!("{name}, two textures, better space, against McCool"),
            "lower",
            powell,
            joint,
        );
        let free = |s: usize| below(rows.free[s], best(s));
        claim(&format!("{name}, two textures, without reciprocity"), "mixed", free(0), free(1));
    }
    Ok(())
}

/// Errors of one material: McCool's, and for Powell and joint, in both spaces, by number of textures.
struct Rows {
    mccool: f64,
    searched: [[Vec<f64>; 2]; 2],
    /// Two textures without reciprocity, the better space, for both strategies.
    free: [f64; 2],
}

impl Rows {
    fn measure(name: &str, samples: &SampleSet, terms: usize) -> anyhow::Result<Self> {
        let thesis = params(Bound::Cube, 1e-3, TermSolve::Last(2));
        let mccool = factorize(samples, &FactorSpec::mccool(true), &thesis)?.model;
        let mccool = measure(samples, &mccool, &log_offsets(samples)).log.mean_square;
        println!("{name:14} McCool                {mccool:.4}");
        let mut searched: [[Vec<f64>; 2]; 2] = Default::default();
        let mut free = [f64::INFINITY; 2];
        for strategy in 0..2 {
            for (index, (space, label)) in SPACES.into_iter().enumerate() {
                let errors = errors(samples, &Family::new(space, true), terms, strategy == 1)?;
                let shown: Vec<String> = errors.iter().map(|e| format!("{e:.4}")).collect();
                let kind = ["Powell", "joint"][strategy];
                println!("{name:14} {kind:6} {label}            {}", shown.join(" "));
                searched[strategy][index] = errors;
                if terms == 2 {
                    let open = errors_free(samples, space, strategy == 1)?;
                    free[strategy] = free[strategy].min(open);
                }
            }
        }
        Ok(Self { mccool, searched, free })
    }
}

fn errors_free(samples: &SampleSet, space: Space, joint: bool) -> anyhow::Result<f64> {
    Ok(errors(samples, &Family::new(space, false), 2, joint)?[1])
}

fn errors(
    samples: &SampleSet,
    family: &Family,
    terms: usize,
    joint: bool,
) -> anyhow::Result<Vec<f64>> {
    let job = Job::new();
    let (params, found): (FactorParams, SearchOutcome) = if joint {
        let params = params(Bound::Disc, 1e-4, TermSolve::All);
        let search = JointParams { terms, ..JointParams::default() };
        (params, search_joint(&Problem::new(samples, &params)?, family, &search, &job)?)
    } else {
        let params = params(Bound::Cube, 1e-3, TermSolve::Last(2));
        let search = GreedyParams { terms, restarts: 4, ..GreedyParams::default() };
        // A third of the samples is enough to find planes; textures are solved on all.
        let problem = Problem::new(samples, &params)?.subset(16_384);
        (params, search_greedy(&problem, family, &search, &job)?)
    };
    let specs: Vec<Vec<FactorSpec>> =
        found.terms.iter().map(|term| family.specs(&term.projections)).collect();
    let fits = match params.terms {
        TermSolve::All => specs
            .iter()
            .map(|specs| factorize(samples, specs, &params))
            .collect::<Result<_, _>>()?,
        TermSolve::Last(_) => factorize_terms(samples, &specs[specs.len() - 1], &params)?,
    };
    let offsets = log_offsets(samples);
    Ok(fits.iter().map(|fit| measure(samples, &fit.model, &offsets).log.mean_square).collect())
}

fn params(bound: Bound, smoothing: f64, terms: TermSolve) -> FactorParams {
    FactorParams { texture_size: 16, bound, smoothing, terms, ..FactorParams::default() }
}

fn preset(name: &str) -> SampleSet {
    let material = Preset::find(name).unwrap_or(Preset::ALL[0]).brdf();
    let theta_max = FactorParams::default().theta_max;
    let sampling = PairSampling { count: 45_000, seed: 1, theta_max };
    SampleSet::draw(&material, &sampling, Channels::Luminance)
}

/// The measured rows of a Cornell paint, turned about the normal in 32 steps.
fn cornell(name: &str) -> anyhow::Result<Option<SampleSet>> {
    let folder = std::env::var_os("BRDF_DATA")
        .map_or_else(|| PathBuf::from("../shared/data"), PathBuf::from);
    let path = folder.join("cornell").join(format!("{name}.brdf"));
    if !path.exists() {
        println!("{name}: skipped, {} is missing; set BRDF_DATA", path.display());
        return Ok(None);
    }
    let rows = MaterialFile::open(&path.to_string_lossy(), &ReadOptions::default())?;
    let Some(rows) = rows.samples() else { return Ok(None) };
    let rows = rows.to_luminance().within(FactorParams::default().theta_max);
    Ok(Some(rows.replicated(32, false).shuffled(1)))
}
