//! The search: rotations form the group they should, searches find what was planted, results are
//! reciprocal, never worse for a term more, and the same on any number of threads.

#![allow(
    clippy::unwrap_used,
    clippy::missing_panics_doc,
    reason = "a test that cannot go on has failed"
)]

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use brdf_factor::{FactorParams, FactorSpec, LogTransform, Problem, factorize, factorize_terms};
use brdf_job::{Cancel, Job, Progress, StopCause};
use brdf_model::{Brdf, Channels, PairSampling, Preset, SampleSet, log_offsets, measure};
use brdf_param::{DirectionPair, Projection, Space};
use brdf_search::{
    Family, GreedyParams, JointParams, Objective, PowellParams, Rotation4, SearchError,
    SearchOutcome, minimize_rotation, search_greedy, search_joint,
};
use glam::{DMat2, DMat4, DQuat, DVec4};
use proptest::prelude::*;

/// This many random cases, however many of them a test passes over.
fn cases(count: u32) -> ProptestConfig {
    ProptestConfig { max_global_rejects: u32::MAX, ..ProptestConfig::with_cases(count) }
}

fn quaternion() -> impl Strategy<Value = DQuat> {
    let anywhere = prop::array::uniform4(-1.0..1.0_f64);
    let corners = prop::sample::select(vec![
        [0.0, 0.0, 0.0, 1.0],
        [0.0, 0.0, 0.0, -1.0],
        [1.0, 0.0, 0.0, 0.0],
        [0.0, 1e-9, 0.0, 1.0],
        [0.0, 1e-9, 0.0, -1.0],
    ]);
    prop_oneof![5 => anywhere, 1 => corners]
        .prop_filter("not zero", |q| q.iter().map(|v| v * v).sum::<f64>() > 1e-6)
        .prop_map(DQuat::from_array)
}

fn rotation() -> impl Strategy<Value = Rotation4> {
    (quaternion(), quaternion()).prop_map(|(left, right)| Rotation4::new(left, right).unwrap())
}

fn vector() -> impl Strategy<Value = DVec4> {
    prop::array::uniform4(-1.0..1.0_f64).prop_map(DVec4::from_array)
}

fn distance(a: &DMat4, b: &DMat4) -> f64 {
    (*a - *b).to_cols_array().iter().fold(0.0, |m, v| v.abs().max(m))
}

proptest! {
    #![proptest_config(cases(2_000))]

    #[test]
    fn rotations_are_a_group_of_orthogonal_matrices(a in rotation(), b in rotation(), v in vector()) {
        let product = a.after(&b);
        prop_assert!(product.apply(v).distance(a.apply(b.apply(v))) < 1e-12);
        prop_assert!(distance(&product.to_matrix(), &(a.to_matrix() * b.to_matrix())) < 1e-12);
        prop_assert!(a.inverse().apply(a.apply(v)).distance(v) < 1e-12);
        prop_assert!((a.apply(v).length() - v.length()).abs() < 1e-12);
        prop_assert!((a.to_matrix().determinant() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn matrices_and_logs_return_the_rotation(a in rotation()) {
        let back = Rotation4::from_matrix(&a.to_matrix()).unwrap();
        prop_assert!(distance(&back.to_matrix(), &a.to_matrix()) < 1e-9);
        let log = a.shortest_log();
        prop_assert!(distance(&Rotation4::from_log(log).to_matrix(), &a.to_matrix()) < 1e-9);
        // Of half angles (α, β) and (π − α, π − β) the shorter is at most π long.
        let length = (log[0].length_squared() + log[1].length_squared()).sqrt();
        prop_assert!(length <= std::f64::consts::PI + 1e-9, "{length}");
        let mirrored = a.to_matrix() * DMat4::from_diagonal(DVec4::new(1.0, 1.0, 1.0, -1.0));
        prop_assert!(Rotation4::from_matrix(&mirrored).is_none(), "a mirror is no rotation");
    }

    #[test]
    fn powers_add_up(a in rotation(), s in -2.0..2.0_f64, t in -2.0..2.0_f64) {
        let both = a.power(s).after(&a.power(t));
        prop_assert!(distance(&both.to_matrix(), &a.power(s + t).to_matrix()) < 1e-7);
        prop_assert!(distance(&a.power(1.0).to_matrix(), &a.to_matrix()) < 1e-12);
        prop_assert!(distance(&a.power(0.0).to_matrix(), &DMat4::IDENTITY) < 1e-12);
    }

    /// The thesis prints a period of 4π; its half-turns return after 4, and their projections come
    /// back as point reflections after 2.
    #[test]
    fn half_turns_have_period_four(start in rotation(), axis in 0..6_usize, t in -3.0..3.0_f64) {
        let mut components = [0.0; 8];
        components[if axis < 3 { axis } else { axis + 1 }] = 1.0;
        let unit = |q: &[f64]| {
            let q = DQuat::from_slice(q);
            if q.length() > 0.5 { q } else { DQuat::IDENTITY }
        };
        let half_turn = Rotation4::new(unit(&components[..4]), unit(&components[4..])).unwrap();
        let at = |t: f64| half_turn.power(t).after(&start);
        prop_assert!(distance(&at(t + 4.0).to_matrix(), &at(t).to_matrix()) < 1e-9);
        let (here, there) = (at(t).projection().rows(), at(t + 2.0).projection().rows());
        prop_assert!((here[0] + there[0]).length() < 1e-9 && (here[1] + there[1]).length() < 1e-9);
    }

    #[test]
    fn projections_return_from_their_rotations(a in rotation()) {
        let projection = a.projection();
        let back = Rotation4::from_projection(&projection).projection();
        for (row, other) in projection.rows().iter().zip(back.rows()) {
            prop_assert!(row.distance(other) < 1e-9, "{row} {other}");
        }
    }
}

fn sampling(count: u32, seed: u64) -> PairSampling {
    PairSampling { count, seed, theta_max: 80_f64.to_radians() }
}

fn samples(name: &str, count: u32, channels: Channels) -> SampleSet {
    SampleSet::draw(&Preset::find(name).unwrap().brdf(), &sampling(count, 1), channels)
}

fn params() -> FactorParams {
    FactorParams { texture_size: 8, ..FactorParams::default() }
}

fn problem(samples: &SampleSet) -> Problem {
    Problem::new(samples, &params()).unwrap()
}

fn joint(samples: &SampleSet, family: &Family, terms: usize) -> SearchOutcome {
    let params = JointParams { terms, texture_size: 8, restarts: 6, ..JointParams::default() };
    search_joint(&problem(samples), family, &params, &Job::new()).unwrap()
}

fn greedy(samples: &SampleSet, family: &Family, params: &GreedyParams) -> SearchOutcome {
    let params = GreedyParams { texture_size: 8, restarts: 2, ..params.clone() };
    search_greedy(&problem(samples), family, &params, &Job::new()).unwrap()
}

fn plane(a: [f64; 4], b: [f64; 4]) -> Projection {
    Projection::from_rows(a, b).unwrap()
}

/// Four of the six dimensions of a rotation matter: turning the two axes that are not projected does
/// nothing, a point reflection mirrors the texture, and a spin by a quarter turns its grid.
#[test]
fn the_error_does_not_feel_idle_dimensions() {
    let training = samples("cook-torrance", 3_000, Channels::Luminance);
    let offsets = log_offsets(&training);
    let error = |projection: Projection| {
        let specs = FactorSpec::projections(Space::HalfDifference, &[projection], true);
        let model = factorize(&training, &specs, &params()).unwrap().model;
        measure(&training, &model, &offsets).log.mean_square
    };
    let rotation = Rotation4::new(
        DQuat::from_xyzw(0.2, 0.7, -0.3, 0.5),
        DQuat::from_xyzw(-0.6, 0.1, 0.4, 0.2),
    )
    .unwrap();
    let turned = |angle: f64, [i, j]: [usize; 2]| {
        let mut matrix = DMat4::IDENTITY;
        let (sin, cos) = angle.sin_cos();
        matrix.col_mut(i)[i] = cos;
        matrix.col_mut(i)[j] = sin;
        matrix.col_mut(j)[i] = -sin;
        matrix.col_mut(j)[j] = cos;
        rotation.after(&Rotation4::from_matrix(&matrix).unwrap()).projection()
    };
    let here = error(rotation.projection());
    for (angle, axes) in
        [(0.8, [2, 3]), (std::f64::consts::PI, [0, 1]), (std::f64::consts::FRAC_PI_2, [0, 1])]
    {
        let there = error(turned(angle, axes));
        assert!((here - there).abs() < 1e-6 * here, "{angle} {axes:?}: {here} {there}");
    }
    let spun = error(turned(0.4, [0, 1]));
    assert!((here - spun).abs() < 0.2 * here, "a spin only moves texels: {here} {spun}");
}

/// A product of known textures over some planes, and the problem of finding them.
fn planted_problem(planes: &[Projection], reciprocal: bool) -> Problem {
    let seen = samples("lafortune-blue-paint", 8_000, Channels::Luminance);
    let specs = FactorSpec::projections(Space::Standard, planes, reciprocal);
    let smooth = FactorParams { texture_size: 4, ..params() };
    let planted = factorize(&seen, &specs, &smooth).unwrap().model;
    let product = SampleSet::draw(&planted, &sampling(8_000, 2), Channels::Luminance);
    let fine =
        FactorParams { texture_size: 16, smoothing: 1e-6, log_map: LogTransform::Log, ..params() };
    Problem::new(&product, &fine).unwrap()
}

/// The share of the variance that the largest model leaves, and the angle from each planted plane to the
/// nearest that was found.
fn missed(problem: &Problem, planes: &[Projection], outcome: &SearchOutcome) -> (f64, Vec<f64>) {
    let targets = &problem.targets()[0];
    let count = targets.len() as f64;
    let mean = targets.iter().sum::<f64>() / count;
    let variance = targets.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / count;
    let best = outcome.terms.last().unwrap();
    let nearest = |planted: &Projection| {
        let angles = best.projections.iter().map(|plane| angle_deg(planted, plane));
        angles.fold(f64::INFINITY, f64::min)
    };
    (best.error / variance, planes.iter().map(nearest).collect())
}

/// A product of known textures over planes is found again: its values and its planes by the joint search, and
/// by the greedy one where there is one plane. Of two planes the greedy search takes one that does for
/// both first, and never comes back to it: it finds the values fairly, and other planes.
#[test]
fn planted_projections_are_found_again() {
    let planes = [
        plane([0.8, 0.1, -0.5, 0.2], [0.0, 0.7, 0.3, 0.6]),
        plane([0.1, 0.9, 0.3, -0.4], [0.6, -0.1, 0.7, 0.2]),
    ];
    let family = Family::new(Space::Standard, true);
    let problem = planted_problem(&planes, true);
    let search = JointParams { terms: 2, restarts: 30, ..JointParams::default() };
    let found = search_joint(&problem, &family, &search, &Job::new()).unwrap();
    let (left, angles) = missed(&problem, &planes, &found);
    assert!(left < 1e-3, "joint: {left:e} of the variance is left");
    assert!(angles.iter().all(|&deg| deg < 1.0), "joint: {angles:?} degrees off");
    let powell = GreedyParams { terms: 2, restarts: 4, ..GreedyParams::default() };
    let stepwise = search_greedy(&problem, &family, &powell, &Job::new()).unwrap();
    let (left, _) = missed(&problem, &planes, &stepwise);
    assert!(left < 5e-2, "greedy: {left:e} of the variance is left");

    for planted in planes {
        let problem = planted_problem(&[planted], true);
        let powell = GreedyParams { terms: 1, ..powell.clone() };
        let found = search_greedy(&problem, &family, &powell, &Job::new()).unwrap();
        let (left, angles) = missed(&problem, &[planted], &found);
        assert!(left < 2e-3, "greedy, one plane: {left:e} of the variance is left");
        assert!(angles[0] < 2.5, "greedy, one plane: {angles:?} degrees off");
    }
}

/// The largest angle, in degrees, between a plane and another, or the other's reciprocal conjugate in standard
/// space, with which it shares its texture.
fn angle_deg(a: &Projection, b: &Projection) -> f64 {
    let [a0, a1] = a.rows();
    let to = |b: Projection| {
        let [b0, b1] = b.rows();
        // Of the 2 × 2 matrix of cosines the smaller singular value is that of the largest angle.
        let cosines = DMat2::from_cols_array(&[a0.dot(b0), a1.dot(b0), a0.dot(b1), a1.dot(b1)]);
        let (sum, determinant) = ((cosines.transpose() * cosines), cosines.determinant());
        let half = 0.5 * (sum.x_axis.x + sum.y_axis.y);
        let smaller = half - (half * half - determinant * determinant).max(0.0).sqrt();
        smaller.clamp(0.0, 1.0).sqrt().acos().to_degrees()
    };
    to(*b).min(to(b.reciprocal_conjugate(Space::Standard)))
}

#[test]
fn results_are_reciprocal_and_never_worse_for_a_term_more() {
    let training = samples("ashikhmin-shirley", 4_000, Channels::Rgb);
    let offsets = log_offsets(&training);
    for space in [Space::Standard, Space::HalfDifference] {
        for (reciprocal, fixed) in [(true, FactorSpec::radial(true)), (false, Vec::new())] {
            let family = Family { fixed, ..Family::new(space, reciprocal) };
            for greedily in [false, true] {
                let outcome = if greedily {
                    greedy(
                        &training,
                        &family,
                        &GreedyParams { terms: 2, ..GreedyParams::default() },
                    )
                } else {
                    joint(&training, &family, 3)
                };
                let fits: Vec<_> = outcome
                    .terms
                    .iter()
                    .map(|term| factorize(&training, &family.specs(&term.projections), &params()))
                    .map(|fit| fit.unwrap().model)
                    .collect();
                let errors: Vec<f64> = fits
                    .iter()
                    .map(|model| measure(&training, model, &offsets).log.mean_square)
                    .collect();
                assert!(errors.windows(2).all(|w| w[1] <= 1.001 * w[0]), "{space:?}: {errors:?}");
                for pair in sampling(300, 5).pairs().filter(|_| reciprocal) {
                    let (a, b) = (fits[1].eval(&pair).g, fits[1].eval(&pair.swapped()).g);
                    assert!((a - b).abs() <= 1e-9 * a.abs() + 1e-12, "{space:?}: {a} and {b}");
                }
            }
        }
    }
}

#[test]
fn searches_are_the_same_on_any_number_of_threads() {
    let training = samples("lafortune-skin", 5_000, Channels::Luminance);
    let family = Family::new(Space::HalfDifference, true);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let powell = GreedyParams { terms: 2, ..GreedyParams::default() };
            (joint(&training, &family, 3), greedy(&training, &family, &powell))
        })
    };
    assert_eq!(on(1), on(3));
}

/// Each objective's own search leaves less of it than the searches for the others, and reports what the model
/// that it found measures.
#[test]
fn every_objective_is_lowered_by_its_own_search() {
    let training = samples("ward", 3_000, Channels::Luminance);
    let family = Family::new(Space::HalfDifference, true);
    let offsets = log_offsets(&training);
    let objectives = [Objective::Relative, Objective::Absolute, Objective::Blend];
    let left = objectives.map(|objective| {
        let search = GreedyParams { terms: 1, objective, ..GreedyParams::default() };
        let found = greedy(&training, &family, &search);
        let specs = family.specs(&found.terms[0].projections);
        let model = factorize(&training, &specs, &params()).unwrap().model;
        let errors = measure(&training, &model, &offsets);
        let (log, linear) = (errors.log, errors.linear);
        (
            found.terms[0].error,
            [log.mean_square, linear.mean_square, log.mean_abs + linear.mean_abs],
        )
    });
    for (own, objective) in objectives.into_iter().enumerate() {
        let (reported, measured) = left[own];
        // The relative one includes the smoothing terms; textures are narrowed to f32 in between.
        let slack = if objective == Objective::Relative { 1e-2 } else { 1e-6 };
        let off = reported / measured[own] - 1.0;
        assert!(off.abs() < slack, "{objective:?}: {reported} reported, {measured:?} measured");
        for (other, (_, others)) in left.iter().enumerate().filter(|(other, _)| *other != own) {
            let theirs = others[own];
            assert!(
                measured[own] < 0.985 * theirs,
                "{objective:?}: {measured:?}, {theirs} by {:?}",
                objectives[other]
            );
        }
    }
}

/// A mirror (one pair in a thousand is lit), a constant, and a black channel: valid models.
#[test]
fn materials_that_defeat_the_search_still_give_models() {
    let make = |value: fn(&DirectionPair) -> [f64; 3]| {
        let mut set = SampleSet::new(Channels::Rgb);
        for pair in sampling(3_000, 1).pairs() {
            set.push(&pair, &value(&pair));
        }
        set
    };
    let mirror = make(|pair| [if pair.half().z > 0.999 { 1e4 } else { 0.0 }; 3]);
    let constant = make(|_| [0.3; 3]);
    let black = make(|pair| [pair.wi.z, 0.0, 0.2]);
    for training in [mirror, constant, black] {
        for space in [Space::Standard, Space::HalfDifference] {
            let family = Family::new(space, true);
            for outcome in [
                joint(&training, &family, 2),
                greedy(&training, &family, &GreedyParams { terms: 2, ..GreedyParams::default() }),
            ] {
                let specs = family.specs(&outcome.terms[1].projections);
                let model = factorize(&training, &specs, &params()).unwrap().model;
                let errors = measure(&training, &model, &log_offsets(&training));
                assert!(errors.log.mean_square.is_finite(), "{space:?}: {errors:?}");
            }
        }
    }
}

#[test]
fn a_stopped_search_returns_a_model() {
    let training = samples("cook-torrance", 3_000, Channels::Luminance);
    let family = Family::new(Space::HalfDifference, true);
    let reported = AtomicUsize::new(0);
    for patience in [0, 30] {
        let problem = problem(&training);
        let fast = JointParams { restarts: 4, ..JointParams::default() };
        let powell = GreedyParams { restarts: 2, ..GreedyParams::default() };
        for greedily in [false, true] {
            let asked = AtomicUsize::new(0);
            let cancel = Cancel::new();
            if patience == 0 {
                cancel.cancel();
            }
            let watch = |progress: &Progress<'_>| {
                assert!((0.0..=1.0).contains(&progress.fraction), "{progress:?}");
                reported.fetch_add(1, Ordering::Relaxed);
                if asked.fetch_add(1, Ordering::Relaxed) >= patience {
                    cancel.cancel();
                }
            };
            let job = Job::watched_by(&watch).with_cancel(&cancel);
            let outcome = if greedily {
                search_greedy(&problem, &family, &powell, &job).unwrap()
            } else {
                search_joint(&problem, &family, &fast, &job).unwrap()
            };
            assert_eq!(outcome.stopped, Some(StopCause::Cancelled), "{outcome:?}");
            assert!(!outcome.terms.is_empty(), "{outcome:?}");
            assert!(outcome.terms.iter().all(|term| term.error.is_finite()), "{outcome:?}");
            let specs = family.specs(&outcome.terms[outcome.terms.len() - 1].projections);
            assert!(factorize_terms(&training, &specs, &params()).is_ok());
        }
    }
    assert!(reported.into_inner() > 0);
}

#[test]
fn impossible_options_are_refused_before_any_work() {
    let training = samples("lambert", 200, Channels::Luminance);
    let never = |_: &Progress<'_>| unreachable!("no work was to be done");
    let job = Job::watched_by(&never);
    let reciprocal = Family::new(Space::Standard, true);
    let search = |problem: &Problem, family: &Family, params: &JointParams| {
        search_joint(problem, family, params, &job).unwrap_err()
    };
    let fit = problem(&training);
    let many = JointParams { terms: 9, ..JointParams::default() };
    assert!(search(&fit, &reciprocal, &many).to_string().contains("1 to 8"));
    let none = JointParams { restarts: 0, ..JointParams::default() };
    assert!(search(&fit, &reciprocal, &none).to_string().contains("restarts"));
    let lopsided = Family {
        fixed: vec![FactorSpec::single(brdf_factor::Coordinate::Wi)],
        ..reciprocal.clone()
    };
    let error = search(&fit, &lopsided, &JointParams::default());
    assert_eq!(error, SearchError::NotReciprocal { factor: 0 });
    let unsmoothed = FactorParams { smoothing: 0.0, ..params() };
    let problem = Problem::new(&training, &unsmoothed).unwrap();
    let error = search(&problem, &reciprocal, &JointParams::default());
    assert!(matches!(error, SearchError::Underdetermined { samples: 200, .. }), "{error}");
    let powell = GreedyParams { last: 0, ..GreedyParams::default() };
    assert!(search_greedy(&fit, &reciprocal, &powell, &job).is_err());
}

/// The bar never goes back and ends where it should, and the number of evaluations that is foreseen is near what
/// happens.
#[test]
fn progress_counts_evaluations_up_to_a_total_that_holds() {
    let training = samples("lafortune-blue-paint", 2_000, Channels::Luminance);
    let problem = problem(&training);
    let family = Family::new(Space::Standard, true);
    for greedily in [false, true] {
        let seen = Mutex::new(Vec::new());
        let watch = |progress: &Progress<'_>| {
            seen.lock().unwrap().push((progress.fraction, progress.stage.to_owned()));
        };
        let job = Job::watched_by(&watch);
        let outcome = if greedily {
            let powell = GreedyParams { terms: 2, texture_size: 8, ..GreedyParams::default() };
            search_greedy(&problem, &family, &powell, &job).unwrap()
        } else {
            let joint = JointParams { terms: 3, texture_size: 8, ..JointParams::default() };
            search_joint(&problem, &family, &joint, &job).unwrap()
        };
        let seen = seen.into_inner().unwrap();
        // Threads tell in any order, so a reader sees the largest share so far, as bars do.
        assert!((seen.last().unwrap().0 - 1.0).abs() < 1e-9, "{:?}", seen.last());
        let all = outcome.evaluations as f64;
        for (fraction, stage) in &seen {
            assert!(*fraction <= 1.0, "{stage}");
            let Some((_, numbers)) = stage.split_once(", ") else { continue };
            let words: Vec<&str> = numbers.split(' ').collect();
            let [done, total] = [words[0], words[3]].map(|word| word.parse::<f64>().unwrap());
            assert!(done <= all && done <= total, "{stage}");
            assert!((0.6..1.6).contains(&(total / all)), "{stage}, in the end {all}");
        }
        let last = seen.iter().rev().find(|(_, stage)| stage.contains("evaluations")).unwrap();
        assert!(last.1.contains(&format!(", {all} of about")), "{last:?}");
    }
}

/// Without a round of the descent the best start is the answer: what depends on the viewer alone is found there.
#[test]
fn a_greedy_search_starts_from_the_viewer_too() {
    let powell = GreedyParams {
        terms: 1,
        restarts: 1,
        powell: PowellParams { rounds: 0, ..PowellParams::default() },
        ..GreedyParams::default()
    };
    for reciprocal in [false, true] {
        let family = Family::new(Space::Standard, reciprocal);
        let viewer = planted_problem(&[Projection::SECOND], reciprocal);
        let found = search_greedy(&viewer, &family, &powell, &Job::new()).unwrap();
        let plane = found.terms[0].projections[0];
        let expected = if reciprocal { Projection::FIRST } else { Projection::SECOND };
        for (row, other) in plane.rows().iter().zip(expected.rows()) {
            assert!(row.distance(other) < 1e-9, "reciprocal {reciprocal}: {plane:?}");
        }
        // A start, what it stands beside, and the textures in the end.
        assert_eq!(found.evaluations, if reciprocal { 5 } else { 6 });
    }
}

/// Powell's method on functions that have nothing to do with reflectance.
#[test]
fn powell_minimises_any_function_of_rotations() {
    let target = Rotation4::new(
        DQuat::from_xyzw(0.1, -0.4, 0.3, 0.8),
        DQuat::from_xyzw(0.5, 0.2, -0.1, 0.6),
    )
    .unwrap();
    // The sine of the largest angle between planes: 0 where they coincide, in any frame.
    let [a, b] = target.projection().rows();
    let f = |rotation: &Rotation4| {
        let [u, v] = rotation.projection().rows();
        let inside = |w: DVec4| w.dot(a).powi(2) + w.dot(b).powi(2);
        2.0 - inside(u) - inside(v)
    };
    let params = PowellParams { tolerance: 1e-4, rounds: 20, ..PowellParams::default() };
    let minimum = minimize_rotation(f, &Rotation4::IDENTITY, &params);
    assert!(minimum.value < 1e-3, "{minimum:?}");
    assert!(minimum.value <= f(&Rotation4::IDENTITY), "never worse than the start");
}
