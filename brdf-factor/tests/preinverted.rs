//! Preinverted factorization against the solvers and against a dense singular value decomposition.

#![allow(clippy::unwrap_used, clippy::cast_precision_loss, reason = "helpers of tests")]

use std::sync::Arc;

use brdf_factor::{
    ChannelTransform, Columns, Damping, FactorError, FactorParams, FactorSpec, Inversion,
    LinearSystem, LogTransform, Plan, Preinverted, Problem, Weight, factorize,
};
use brdf_model::{Brdf as _, Channels, PairSampling, Preset, Rgb, SampleSet};
use brdf_param::DirectionPair;
use faer::Mat;
use glam::DVec2;
use proptest::prelude::*;

fn samples(preset: &str, count: u32, seed: u64) -> SampleSet {
    let sampling = PairSampling { count, seed, theta_max: 1.3 };
    SampleSet::draw(&Preset::find(preset).unwrap().brdf(), &sampling, Channels::Rgb)
}

fn problem(samples: &SampleSet) -> Problem {
    Problem::new(samples, &FactorParams::default()).unwrap()
}

fn largest_difference(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Log values that a preinverted matrix gives samples.
fn predictions(
    problem: &Problem,
    values: &[Vec<f64>],
    plan: &Plan,
    inversion: Inversion,
) -> Vec<Vec<f64>> {
    let inverted = Preinverted::new(problem, &[], plan.clone(), inversion).unwrap();
    let mut workspace = inverted.workspace(values.len());
    inverted.solve(values, problem.maps(), &mut workspace);
    inverted.predictions(&workspace)
}

const ALL: Inversion = Inversion::Svd { components: usize::MAX, damping: Damping::Truncated };

#[test]
fn a_repaint_is_the_factorization_from_scratch() {
    let first = samples("lafortune-blue-paint", 2000, 1);
    for specs in [FactorSpec::radial(false), FactorSpec::mccool(true)] {
        let plan = Plan::of(&specs, 8);
        let problem = problem(&first);
        let inverted =
            Preinverted::new(&problem, &[], plan, Inversion::Cholesky).expect("a sound problem");
        let mut workspace = inverted.workspace(3);
        // Values of another material at the same places.
        for preset in ["cook-torrance", "lafortune-blue-paint"] {
            let other = samples(preset, 2000, 1);
            let maps = ChannelTransform::for_samples(LogTransform::Offset, 1e-5, &other);
            inverted.solve(other.values(), &maps, &mut workspace);
            let params = FactorParams { texture_size: 8, ..FactorParams::default() };
            let fit = factorize(&other, &specs, &params).unwrap();
            let apart = largest_difference(&inverted.predictions(&workspace), &fit.predictions);
            assert!(apart < 1e-8, "{preset}: {apart}");
            let model = inverted.model(&workspace, &maps).unwrap();
            let pair = other.pair(7);
            let (a, b) = (model.eval(&pair, DVec2::ZERO), fit.model.eval(&pair));
            assert!((a.g / b.g - 1.0).abs() < 1e-4, "{preset}: {a:?} and {b:?}");
        }
    }
}

/// B, rows by unknowns.
fn dense(system: &LinearSystem) -> Mat<f64> {
    let columns: Vec<Vec<f64>> = (0..system.unknowns())
        .map(|unknown| {
            let mut unit = vec![0.0; system.unknowns()];
            unit[unknown] = 1.0;
            system.apply(&unit)
        })
        .collect();
    Mat::from_fn(system.row_count(), system.unknowns(), |row, column| columns[column][row])
}

#[test]
fn every_damping_is_that_of_the_singular_values_of_the_whole_matrix() {
    let samples = samples("cook-torrance", 400, 3);
    let problem = problem(&samples);
    let specs = FactorSpec::radial(false);
    let columns: Vec<Arc<Columns>> = specs
        .iter()
        .map(|spec| Arc::new(problem.columns(&problem.empty_factor(spec, 7).unwrap())))
        .collect();
    let system = LinearSystem::new(columns, problem.weights());
    let svd = dense(&system).thin_svd().unwrap();
    let components = 15;
    for damping in [Damping::Truncated, Damping::Linear, Damping::Alpha(0.05)] {
        let given = predictions(
            &problem,
            samples.values(),
            &Plan::of(&specs, 7),
            Inversion::Svd { components, damping },
        );
        let expected: Vec<Vec<f64>> = problem
            .targets()
            .iter()
            .map(|targets| {
                let side = system.right_hand_side(targets);
                let mut x = vec![0.0; system.unknowns()];
                for i in 0..components {
                    let s = svd.S()[i];
                    let factor = match damping {
                        Damping::Truncated => 1.0 / s,
                        Damping::Linear => (1.0 - i as f64 / components as f64) / s,
                        Damping::Alpha(alpha) => {
                            let alpha = alpha * svd.S()[0];
                            s / (s * s + alpha * alpha)
                        }
                    };
                    let analysed: f64 =
                        side.iter().enumerate().map(|(row, y)| svd.U()[(row, i)] * y).sum();
                    for (row, x) in x.iter_mut().enumerate() {
                        *x += factor * analysed * svd.V()[(row, i)];
                    }
                }
                problem.in_given_order(&system.predict(&x))
            })
            .collect();
        let apart = largest_difference(&given, &expected);
        assert!(apart < 1e-6, "{damping:?}: {apart}");
    }
}

#[test]
fn coefficients_stand_for_the_material() {
    let samples = samples("lafortune-clay", 1000, 2);
    let problem = problem(&samples);
    let inverted =
        Preinverted::new(&problem, &[], Plan::of(&FactorSpec::radial(false), 12), ALL).unwrap();
    let mut workspace = inverted.workspace(3);
    inverted.solve(samples.values(), problem.maps(), &mut workspace);
    let brdf_factor::Inverse::Svd(basis) = inverted.inverse() else { panic!("asked for") };
    let mut texels = vec![0.0; workspace.solution().len()];
    basis.expand(workspace.coefficients(), &mut texels);
    assert_eq!(texels, workspace.solution(), "β and the basis give the texels");
    assert!(workspace.coefficients().len() <= texels.len());
}

/// A product of radial factors and one over a surface, and where its samples lie.
fn painted(count: u32) -> (SampleSet, Vec<DVec2>) {
    let plain = samples("lafortune-blue-paint", count, 5);
    let mut painted = SampleSet::new(Channels::Rgb);
    let mut places = Vec::new();
    for index in 0..plain.len() {
        let turn = index as f64 * 0.618_033_988_749_895;
        let place = DVec2::new(turn.fract(), (0.5 + 7.0 * turn).sin().mul_add(0.5, 0.5));
        let own = 0.4 + 0.5 * place.x * place.y;
        let pair = plain.pair(index);
        let radial = [pair.wi, pair.half(), pair.wo].map(|w| w.truncate().length());
        let product = (1.0 + radial[0]) * (-2.0 * radial[1]).exp() * (1.5 - radial[2]);
        painted.push_rgb(&pair, Rgb::new(own, 0.5 * own, 0.1) * product);
        places.push(place);
    }
    (painted, places)
}

#[test]
fn a_factor_over_the_surface_takes_what_varies_there() {
    let (samples, places) = painted(6000);
    let problem = problem(&samples);
    let specs = FactorSpec::radial(false);
    let errors = [false, true].map(|has_surface| {
        let plan = Plan::of(&specs, 24);
        let plan = if has_surface { plan.with_surface(24, false) } else { plan };
        let inverted = Preinverted::new(&problem, &places, plan, Inversion::Cholesky).unwrap();
        let mut workspace = inverted.workspace(3);
        inverted.solve(samples.values(), problem.maps(), &mut workspace);
        let model = inverted.model(&workspace, problem.maps()).unwrap();
        let squares = (0..samples.len()).map(|at| {
            let log = |v: f64| v.max(1e-9).ln();
            (log(model.eval(&samples.pair(at), places[at]).g) - log(samples.rgb(at).g)).powi(2)
        });
        (squares.sum::<f64>() / samples.len() as f64).sqrt()
    });
    assert!(errors[1] < 0.02 * errors[0], "without and with a surface: {errors:?}");
}

#[test]
fn another_sampling_is_refused_and_the_same_is_not() {
    let samples_a = samples("cook-torrance", 500, 1);
    let problem_a = problem(&samples_a);
    let plan = Plan::of(&FactorSpec::radial(true), 8);
    let made = Preinverted::new(&problem_a, &[], plan.clone(), ALL).unwrap();
    let restore = |problem: &Problem, plan: &Plan| {
        Preinverted::restore(problem, &[], plan.clone(), made.inverse().clone(), made.key())
    };
    let again = restore(&problem(&samples("lafortune-clay", 500, 1)), &plan).unwrap();
    assert_eq!((again.key(), again.unknowns()), (made.key(), made.unknowns()));
    let others = [
        restore(&problem(&samples("cook-torrance", 500, 2)), &plan),
        restore(&problem(&samples("cook-torrance", 499, 1)), &plan),
        restore(&problem_a, &Plan::of(&FactorSpec::radial(true), 9)),
        restore(&problem_a, &Plan::of(&FactorSpec::radial(false), 8)),
    ];
    for other in others {
        assert!(matches!(other, Err(FactorError::OtherSampling { .. })), "{other:?}");
    }
    let smoother = FactorParams { smoothing: 1e-3, ..FactorParams::default() };
    let smoother = Problem::new(&samples_a, &smoother).unwrap();
    assert!(matches!(restore(&smoother, &plan), Err(FactorError::OtherSampling { .. })));
}

#[test]
fn weights_that_depend_on_values_are_refused() {
    let samples = samples("cook-torrance", 100, 1);
    for params in [
        FactorParams { weight: Weight::F, ..FactorParams::default() },
        FactorParams { log_map: LogTransform::Log, ..FactorParams::default() },
    ] {
        let problem = Problem::new(&samples, &params).unwrap();
        let plan = Plan::of(&FactorSpec::radial(true), 8);
        let refused = Preinverted::new(&problem, &[], plan, Inversion::Cholesky);
        assert!(matches!(refused, Err(FactorError::Option { .. })), "{refused:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

    /// Fewer samples than unknowns too: smoothing holds the rest.
    #[test]
    fn cholesky_and_all_singular_vectors_agree(
        count in 20_u32..400,
        seed in 0_u64..1000,
        size in 3_usize..14,
    ) {
        let samples = samples("lafortune-blue-paint", count, seed);
        let problem = problem(&samples);
        let plan = Plan::of(&FactorSpec::radial(false), size);
        let exact = predictions(&problem, samples.values(), &plan, Inversion::Cholesky);
        let basis = predictions(&problem, samples.values(), &plan, ALL);
        let apart = largest_difference(&exact, &basis);
        prop_assert!(apart < 1e-6, "{apart}");
        let damping = Damping::Alpha(1e-12);
        let svd = Inversion::Svd { components: usize::MAX, damping };
        let damped = predictions(&problem, samples.values(), &plan, svd);
        prop_assert!(largest_difference(&exact, &damped) < 1e-6);
    }

    /// Solutions are linear in the fitted values, but for the ridge.
    #[test]
    fn a_brighter_material_has_brighter_texels(seed in 0_u64..1000, gain in 0.1_f64..10.0) {
        let samples = samples("lafortune-clay", 200, seed);
        let problem = problem(&samples);
        let plan = Plan::of(&FactorSpec::radial(false), 6);
        let inverted = Preinverted::new(&problem, &[], plan, Inversion::Cholesky).unwrap();
        let maps = [ChannelTransform::Log; 3];
        let mut workspace = inverted.workspace(3);
        let values: Vec<Vec<f64>> = samples.values().to_vec();
        inverted.solve(&values, &maps, &mut workspace);
        let dim = inverted.predictions(&workspace);
        let brighter: Vec<Vec<f64>> =
            values.iter().map(|c| c.iter().map(|v| gain * v).collect()).collect();
        inverted.solve(&brighter, &maps, &mut workspace);
        let pair: DirectionPair = samples.pair(0);
        prop_assert!(pair.wi.z > 0.0);
        for (a, b) in dim.iter().flatten().zip(inverted.predictions(&workspace).iter().flatten()) {
            prop_assert!((b - a - gain.ln()).abs() < 1e-5 * (1.0 + a.abs()), "{a} {b}");
        }
    }
}
