//! The homomorphic factorization: solvers agree, planted factors come back, reciprocity holds, and
//! the same input gives the same bits.

#![allow(
    clippy::unwrap_used,
    clippy::missing_panics_doc,
    reason = "a test that cannot go on has failed"
)]

mod support;

use crate::support::{cases, pair};
use brdf_factor::{
    Angle, Axis, Coordinate, Factor, FactorParams, FactorSpec, FactoredBrdf, IsotropicPairs,
    LogTransform, Solver, Spacing, StoredTexels, TermSolve, TexelFormat, Weight, Zeros, factorize,
    factorize_terms,
};
use brdf_model::{
    Brdf, Channels, DirectionBatch, PairSampling, Preset, Rgb, RgbBatch, SampleSet, log_offsets,
    measure,
};
use brdf_param::{DirectionPair, HalfDifference, Projection, Space, polar_angle};
use proptest::prelude::*;

fn sampling(count: u32) -> PairSampling {
    PairSampling { count, seed: 1, theta_max: 80_f64.to_radians() }
}

fn samples(name: &str, count: u32, channels: Channels) -> SampleSet {
    SampleSet::draw(&Preset::find(name).unwrap().brdf(), &sampling(count), channels)
}

fn small() -> FactorParams {
    FactorParams { texture_size: 8, ..FactorParams::default() }
}

fn planes() -> Vec<Projection> {
    vec![
        Projection::from_rows([1.0, 0.0, 1.0, 0.0], [0.0, 1.0, 0.0, 1.0]).unwrap(),
        Projection::from_rows([0.3, -0.8, 0.1, 0.4], [0.9, 0.2, -0.5, 0.1]).unwrap(),
    ]
}

/// Every method, space and reciprocity, as named lists of factors.
fn all_specs() -> Vec<(String, Vec<FactorSpec>)> {
    let mut all = Vec::new();
    for reciprocal in [true, false] {
        all.push((format!("mccool {reciprocal}"), FactorSpec::mccool(reciprocal)));
        all.push((format!("radial {reciprocal}"), FactorSpec::radial(reciprocal)));
        for space in [Space::Standard, Space::HalfDifference] {
            let specs = FactorSpec::projections(space, &planes(), reciprocal);
            all.push((format!("{space:?} {reciprocal}"), specs));
        }
    }
    all.push((
        "h and d".to_owned(),
        vec![FactorSpec::single(Coordinate::H), FactorSpec::reciprocal(Coordinate::D)],
    ));
    all.extend(isotropic_specs());
    // Textures over angles beside a plane and a direction, as one model.
    let mut mixed = IsotropicPairs::Polar.specs(Spacing::Linear, 150, true);
    mixed.extend(FactorSpec::projections(Space::Standard, &planes()[..1], true));
    mixed.push(FactorSpec::reciprocal(Coordinate::Wi));
    all.push(("mixed".to_owned(), mixed));
    all
}

/// All choices of angles, and all angles that are in none of them.
fn isotropic_specs() -> Vec<(String, Vec<FactorSpec>)> {
    let spacings =
        [Spacing::Linear, Spacing::Power { exponent: 0.5 }, Spacing::Asinh { alpha: 0.05 }];
    let mut all = Vec::new();
    for (pairs, spacing) in IsotropicPairs::ALL.into_iter().zip(spacings) {
        for reciprocal in [true, false] {
            let specs = pairs.specs(spacing, 200, reciprocal);
            all.push((format!("{} {reciprocal}", pairs.name()), specs));
        }
    }
    let axes = |x, y| [Axis::linear(x), Axis::linear(y)];
    let coordinate = |x, y| Coordinate::Isotropic { axes: axes(x, y), swapped: false };
    let others = [(Angle::ThetaI, Angle::DeltaPhi), (Angle::PhiD, Angle::ThetaD)];
    let others = others.map(|(x, y)| FactorSpec::reciprocal(coordinate(x, y)));
    all.push(("others".to_owned(), others.to_vec()));
    all
}

#[test]
fn turns_change_nothing_of_textures_over_angles() {
    let training = samples("ggx", 4_000, Channels::Rgb);
    for (name, specs, model) in isotropic_specs().into_iter().flat_map(|(name, specs)| {
        let model = factorize(&training, &specs, &small()).unwrap().model;
        TexelFormat::ALL.map(|format| {
            let name = format!("{name} in {}", format.name());
            (name, specs.clone(), model.stored_as(format).unwrap())
        })
    }) {
        let mirror = (0..40).map(|at| {
            let theta = 0.03 * f64::from(at);
            DirectionPair::from_angles(theta, 0.3, theta, 0.3 + std::f64::consts::PI)
        });
        let retro = (0..40).map(|at| {
            let theta = 0.03 * f64::from(at);
            DirectionPair::from_angles(theta, 0.3, theta, 0.3)
        });
        for pair in sampling(500).pairs().chain(mirror).chain(retro) {
            let value = model.eval(&pair).g;
            for turn in [0.1, 1.7, 3.0, -2.2] {
                let turned = model.eval(&pair.rotated_about_normal(turn)).g;
                let off = (value - turned).abs();
                assert!(off <= 1e-9 * value, "{name}: {value} and {turned} at {pair:?}");
            }
            if specs.iter().all(FactorSpec::is_reciprocal) {
                let swapped = model.eval(&pair.swapped()).g;
                assert!((value - swapped).abs() <= 1e-9 * value, "{name}: {value} and {swapped}");
            }
        }
    }
}

/// The angles that textures are read at, one by one, are those of the parametrization.
#[test]
fn a_texture_over_an_angle_can_hold_that_angle() {
    let of = |angle: Angle, pair: &DirectionPair| {
        let a = HalfDifference::from_pair(pair);
        let (theta_i, theta_o) = (polar_angle(pair.wi), polar_angle(pair.wo));
        match angle {
            Angle::ThetaH => a.theta_h,
            Angle::ThetaD => a.theta_d,
            Angle::PhiD => a.phi_d.abs(),
            Angle::PhiDFolded => a.phi_d.abs().min(std::f64::consts::PI - a.phi_d.abs()),
            Angle::DifferenceX => a.theta_d * a.phi_d.cos(),
            Angle::DifferenceXFolded => a.theta_d * a.phi_d.cos().abs(),
            Angle::DifferenceY => a.theta_d * a.phi_d.sin(),
            Angle::DifferenceYFolded => a.theta_d * a.phi_d.sin().abs(),
            Angle::ThetaI => theta_i,
            Angle::ThetaO => theta_o,
            Angle::DeltaPhi => {
                let (i, o) = (pair.wi.truncate(), pair.wo.truncate());
                i.perp_dot(o).abs().atan2(i.dot(o))
            }
            _ => unreachable!("φd mod π goes round"),
        }
    };
    let angles = [
        (Angle::ThetaH, Angle::ThetaD),
        (Angle::DifferenceX, Angle::DifferenceY),
        (Angle::DifferenceXFolded, Angle::DifferenceYFolded),
        (Angle::ThetaI, Angle::ThetaO),
        (Angle::PhiD, Angle::DeltaPhi),
        (Angle::DeltaPhi, Angle::PhiDFolded),
    ];
    for (x, y) in angles {
        let mut planted = SampleSet::new(Channels::Luminance);
        let value = |pair: &DirectionPair| (0.7 * of(x, pair) - 0.4 * of(y, pair)).exp();
        for pair in sampling(3_000).pairs() {
            planted.push(&pair, &[value(&pair)]);
        }
        let spec = FactorSpec::single(Coordinate::Isotropic {
            axes: [Axis::linear(x), Axis::linear(y)],
            swapped: false,
        });
        let params = FactorParams { smoothing: 1e-7, log_map: LogTransform::Log, ..small() };
        let model = factorize(&planted, &[spec], &params).unwrap().model;
        for pair in sampling(500).pairs().skip(250) {
            let (found, wanted) = (model.eval(&pair).g, value(&pair));
            assert!((found / wanted - 1.0).abs() < 2e-3, "{x:?}, {y:?}: {found} for {wanted}");
        }
    }
}

#[test]
fn a_model_is_never_brighter_than_what_was_fitted() {
    // A sharp highlight that was hardly sampled: a texel at its top is free to overshoot.
    let training = samples("ggx", 500, Channels::Rgb);
    let largest = training.values()[0].iter().copied().fold(0.0, f64::max);
    let brightest = |clamp| {
        let params = FactorParams { clamp, ..small() };
        let specs = IsotropicPairs::Cartesian.specs(Spacing::Linear, 200, true);
        let model = factorize(&training, &specs, &params).unwrap().model;
        let pairs: Vec<DirectionPair> = sampling(4_000).highlight_pairs().collect();
        let mut batch = RgbBatch::default();
        model.eval_batch(pairs.iter().collect::<DirectionBatch>().as_slices(), &mut batch);
        let single = pairs.iter().map(|pair| model.eval(pair).r).fold(0.0, f64::max);
        let counted = model.count(pairs.iter().copied()).clamped_at_ceiling;
        (single, f64::from(batch.r.iter().copied().fold(0.0, f32::max)), counted)
    };
    let (single, batch, counted) = brightest(true);
    assert!(single <= largest && batch <= 1.000_001 * largest, "{single}, {batch} of {largest}");
    assert!(counted > 0);
    let (single, ..) = brightest(false);
    assert!(single > largest, "{single} of {largest}");
}

#[test]
fn zeros_that_a_model_may_be_below_do_not_pull_their_neighbours() {
    // A channel that a file clips to 0 below some brightness: a cliff in a logarithm.
    let plastic = samples("lafortune-blue-paint", 4_000, Channels::Luminance);
    let mut values = plastic.values()[0].clone();
    values.sort_by(f64::total_cmp);
    let clip = values[values.len() / 4];
    let mut clipped = SampleSet::new(Channels::Luminance);
    for index in 0..plastic.len() {
        let value = plastic.rgb(index).r;
        clipped.push_rgb(&plastic.pair(index), Rgb::splat(if value < clip { 0.0 } else { value }));
    }
    let errors = |zeros| {
        let params = FactorParams { zeros, ..small() };
        let specs = IsotropicPairs::Polar.specs(Spacing::Linear, 900, true);
        let fit = factorize(&clipped, &specs, &params).unwrap();
        assert!(fit.zeros > 900, "{} zeros", fit.zeros);
        let map = fit.model.maps()[0];
        let mut squares = [0.0_f64; 2];
        for index in 0..clipped.len() {
            let (wanted, found) = (clipped.rgb(index).r, fit.model.eval(&clipped.pair(index)).r);
            let off = map.forward(found) - map.forward(wanted);
            squares[usize::from(wanted > 0.0)] += off * off;
        }
        squares
    };
    let (exact, below) = (errors(Zeros::Exact), errors(Zeros::Below));
    assert!(below[1] < exact[1], "{below:?} against {exact:?}");
    assert!(below[0] < 0.85 * exact[0], "{below:?} against {exact:?}");
}

#[test]
fn the_three_solvers_predict_the_same_log_values() {
    let training = samples("lafortune-blue-paint", 4_000, Channels::Rgb);
    for (name, specs) in all_specs() {
        // One of each kind is enough, as these take many steps.
        if specs[0].grid.is_some() && name != "polar true" {
            continue;
        }
        for (weight, smoothing) in [(Weight::Log, 1e-4), (Weight::F2, 1e-3)] {
            let fit = |solver| {
                let params = FactorParams { solver: Some(solver), weight, smoothing, ..small() };
                let fit = factorize(&training, &specs, &params).unwrap();
                assert!(fit.converged, "{name}: {solver:?} after {} steps", fit.iterations);
                fit.predictions.concat()
            };
            let exact = fit(Solver::Cholesky);
            for solver in [Solver::Lsmr, Solver::Qmr] {
                let other = fit(solver);
                let off = exact.iter().zip(&other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(off < 1e-8, "{name}, {weight:?}: {solver:?} is off by {off}");
            }
        }
    }
}

#[test]
fn a_projection_onto_the_difference_vector_can_be_reciprocal() {
    let space = Space::HalfDifference;
    let spec = &FactorSpec::projections(space, &[Projection::SECOND], true)[0];
    assert!(spec.coordinates.len() == 2 && spec.is_reciprocal(), "{spec:?}");
}

#[test]
fn reciprocal_factors_cannot_tell_light_from_viewer() {
    let training = samples("ashikhmin-shirley", 4_000, Channels::Rgb);
    for (name, specs) in all_specs() {
        if !specs.iter().all(FactorSpec::is_reciprocal) {
            continue;
        }
        assert!(!name.ends_with("false"), "{name}");
        let fitted = factorize(&training, &specs, &small()).unwrap().model;
        for format in TexelFormat::ALL {
            let model = fitted.stored_as(format).unwrap();
            for pair in sampling(500).pairs() {
                let (a, b) = (model.eval(&pair).g, model.eval(&pair.swapped()).g);
                assert!((a - b).abs() <= 1e-9 * a, "{name} in {format:?}: {a} and {b}");
            }
        }
    }
}

/// Rounding moves a log value by at most half a step for every read of a texture, and exchanging constants
/// before by no more than f32 leaves.
#[test]
fn stored_texels_are_within_half_a_step() {
    let training = samples("ggx", 4_000, Channels::Rgb);
    for (name, specs) in all_specs() {
        let fitted = factorize(&training, &specs, &small()).unwrap().model;
        for format in [TexelFormat::F16, TexelFormat::U8] {
            let model = fitted.stored_as(format).unwrap();
            assert!(model.factors().iter().all(|factor| factor.format() == format));
            let steps = |channel: usize| -> f64 {
                let factors = model.factors().iter();
                factors
                    .map(|factor| {
                        let texels = factor.texels().iter().map(|t| f64::from(t[channel]));
                        let (low, high) = texels
                            .fold((0.0_f64, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
                        let step = match format {
                            TexelFormat::U8 => {
                                let [low, high] = factor.stored(3).ranges[channel];
                                f64::from(high - low) / 255.0
                            }
                            // Eleven digits, the first of which is not stored.
                            _ => low.abs().max(high) / 1024.0,
                        };
                        step * factor.coordinates().len() as f64
                    })
                    .sum()
            };
            let steps = [0, 1, 2].map(steps);
            for pair in sampling(500).pairs() {
                let (before, after) = (fitted.log_values(&pair), model.log_values(&pair));
                for channel in 0..3 {
                    let off = (after[channel] - before[channel]).abs();
                    assert!(off <= 0.5 * steps[channel] + 1e-5, "{name} in {format:?}: {off}");
                }
            }
            assert_eq!(model.ceilings(), fitted.ceilings());
            let bytes = format.bytes(1, 3) - format.range_bytes(3);
            let texels: usize = model.factors().iter().map(|f| f.grid().texels()).sum();
            let ranges = model.factors().len() * format.range_bytes(3);
            assert_eq!(model.payload_bytes(), bytes * texels + ranges, "{name}");
        }
    }
}

/// Files that are read and written again stay what they are, unless texels are set anew.
#[test]
fn a_stored_factor_comes_back() {
    let training = samples("ggx", 2_000, Channels::Rgb);
    let fitted = factorize(&training, &FactorSpec::mccool(true), &small()).unwrap().model;
    for format in TexelFormat::ALL {
        for factor in fitted.stored_as(format).unwrap().factors() {
            let stored = factor.stored(3);
            let again = Factor::from_stored(factor.description().clone(), &stored, 3).unwrap();
            assert_eq!(&again, factor, "{format:?}");
            let mut set = again.clone();
            set.set_texels(again.texels().to_vec()).unwrap();
            assert_eq!(set.format(), TexelFormat::F32);
            let short = StoredTexels { bytes: stored.bytes[1..].to_vec(), ..stored };
            assert!(Factor::from_stored(factor.description().clone(), &short, 3).is_err());
        }
    }
}

#[test]
fn texels_beyond_half_precision_are_refused() {
    let training = samples("ggx", 2_000, Channels::Rgb);
    let fitted = factorize(&training, &FactorSpec::mccool(true), &small()).unwrap().model;
    let mut factors = fitted.factors().to_vec();
    let mut texels = factors[0].texels().to_vec();
    texels[0][0] = 2e5;
    factors[0].set_texels(texels).unwrap();
    let far = FactoredBrdf::new(factors, fitted.maps().to_vec(), fitted.theta_max()).unwrap();
    assert!(far.stored_as(TexelFormat::U8).is_ok());
    let said = far.stored_as(TexelFormat::F16).unwrap_err().to_string();
    assert!(said.contains("f16"), "{said}");
}

/// A product of known textures over McCool's coordinates is found again.
#[test]
fn planted_factors_come_back() {
    let seen = samples("lafortune-clay", 20_000, Channels::Rgb);
    let planted = factorize(&seen, &FactorSpec::mccool(true), &small()).unwrap().model;
    let product = SampleSet::draw(&planted, &sampling(20_000), Channels::Rgb);
    let params = FactorParams { smoothing: 1e-9, log_map: LogTransform::Log, ..small() };
    let fit = factorize(&product, &FactorSpec::mccool(true), &params).unwrap();
    let errors = measure(&product, &fit.model, &log_offsets(&product));
    assert!(errors.log.mean_square < 1e-6, "{errors:?}");
}

#[test]
fn more_terms_never_fit_worse() {
    let training = samples("cook-torrance", 8_000, Channels::Luminance);
    let specs = FactorSpec::projections(Space::HalfDifference, &planes(), true);
    let offsets = log_offsets(&training);
    for terms in [TermSolve::All, TermSolve::Last(1)] {
        let params = FactorParams { terms, ..small() };
        let errors: Vec<f64> = factorize_terms(&training, &specs, &params)
            .unwrap()
            .iter()
            .map(|fit| measure(&training, &fit.model, &offsets).log.mean_square)
            .collect();
        assert!(errors.windows(2).all(|w| w[1] <= w[0] * 1.001), "{terms:?}: {errors:?}");
    }
}

#[test]
fn equal_runs_give_equal_bits_on_any_number_of_threads() {
    let training = samples("lafortune-skin", 5_000, Channels::Rgb);
    let run = |threads: usize| -> FactoredBrdf {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| factorize(&training, &FactorSpec::mccool(true), &small()).unwrap().model)
    };
    let one = run(1);
    assert_eq!(one, run(2));
    assert_eq!(one, run(1));
}

#[test]
fn black_channels_stay_black_and_constants_stay_constant() {
    let mut training = SampleSet::new(Channels::Rgb);
    for pair in sampling(2_000).pairs() {
        training.push(&pair, &[0.25, 0.0, 0.25]);
    }
    let model = factorize(&training, &FactorSpec::mccool(true), &small()).unwrap().model;
    for pair in sampling(200).pairs() {
        let value = model.eval(&pair);
        assert!(value.g.abs() < 1e-300 && (value.r - 0.25).abs() < 1e-5, "{value:?}");
    }
}

#[test]
fn options_out_of_range_and_free_texels_are_refused() {
    let training = samples("lambert", 500, Channels::Luminance);
    let specs = FactorSpec::mccool(true);
    let message =
        |params: FactorParams| factorize(&training, &specs, &params).unwrap_err().to_string();
    assert!(message(FactorParams { texture_size: 1, ..small() }).contains("2 to 1024"));
    assert!(message(FactorParams { texture_size: 0, ..small() }).contains("2 to 1024"));
    assert!(message(FactorParams { smoothing: f64::NAN, ..small() }).contains("smoothing"));
    let free = message(FactorParams { smoothing: 0.0, texture_size: 32, ..small() });
    assert!(free.contains("texel (") && free.contains("1e-4"), "{free}");
    let empty = SampleSet::new(Channels::Rgb);
    let nothing = factorize(&empty, &specs, &small()).unwrap_err().to_string();
    assert!(nothing.contains("no samples"), "{nothing}");
}

fn models() -> Vec<(String, FactoredBrdf)> {
    let training = samples("lafortune-blue-paint", 3_000, Channels::Rgb);
    let mut all: Vec<(String, FactoredBrdf)> = all_specs()
        .into_iter()
        .map(|(name, specs)| (name, factorize(&training, &specs, &small()).unwrap().model))
        .collect();
    for log_map in [LogTransform::Log, LogTransform::Highlight] {
        let params = FactorParams { log_map, ..small() };
        let fit = factorize(&training, &FactorSpec::mccool(true), &params).unwrap();
        all.push((format!("{log_map:?}"), fit.model));
    }
    all
}

proptest! {
    #![proptest_config(cases(64))]

    /// The batch form is the single form in f32, for every kind of coordinate and log map, below
    /// the horizon and beyond the grazing limit too.
    #[test]
    fn batches_equal_single_evaluations(pairs in prop::collection::vec(pair(), 1..150)) {
        let mut pairs: Vec<DirectionPair> = pairs;
        pairs[0].wi.z = -pairs[0].wi.z;
        let batch: DirectionBatch = pairs.iter().collect();
        let mut out = RgbBatch::default();
        for (name, model) in MODELS.iter() {
            model.eval_batch(batch.as_slices(), &mut out);
            for (index, pair) in pairs.iter().enumerate() {
                // Single evaluation of what f32 left of the directions.
                let single = model.eval(&batch.as_slices().get(index));
                let difference = (single - out.get(index)).map(f64::abs).max_channel();
                let allowed = 2e-3 * single.max_channel() + 1e-5;
                // Half vectors of nearly opposite directions are noise in f32.
                if (pair.wi + pair.wo).length() > 1e-3 {
                    prop_assert!(difference <= allowed, "{name}: {single:?} {:?} at {pair:?}", out.get(index));
                }
            }
        }
    }
}

static MODELS: std::sync::LazyLock<Vec<(String, FactoredBrdf)>> = std::sync::LazyLock::new(models);
