//! What models promise: symmetries, limits, sizes, streams that come back, and errors on real materials.

use brdf_job::{Cancel, Job};
use brdf_model::{
    Brdf, Channels, DirectionBatch, FidelityPairs, PairSampling, Preset, Rgb, RgbBatch, SampleSet,
};
use brdf_param::DirectionPair;
use brdf_spline::{
    SplineBrdf, SplineError, SplineSettings, Symmetry, fit_spline_samples, fit_splines,
};
use proptest::prelude::*;

fn preset(name: &str) -> impl Brdf {
    Preset::find(name).expect("a preset").brdf()
}

fn fitted(name: &str, bytes: usize) -> SplineBrdf {
    let settings = SplineSettings { bytes, ..SplineSettings::default() };
    fit_splines(&preset(name), &settings, &Job::new()).expect("a fit").model
}

fn pairs(count: u32) -> Vec<DirectionPair> {
    let sampling = PairSampling { count, seed: 3, theta_max: 1.57 };
    let mirrors = (0..20).map(|step| {
        let theta = 0.07 * f64::from(step);
        DirectionPair::from_angles(theta, 0.0, theta, std::f64::consts::PI)
    });
    sampling.pairs().chain(sampling.highlight_pairs()).chain(mirrors).collect()
}

/// A material that is neither reciprocal nor its own mirror image.
struct Twisted;

impl Brdf for Twisted {
    fn eval(&self, pair: &DirectionPair) -> Rgb {
        if pair.wi.z <= 0.0 || pair.wo.z <= 0.0 {
            return Rgb::BLACK;
        }
        let half = pair.half();
        let twist = pair.wi.cross(pair.wo).z;
        let lobe = (-30.0 * (half.x * half.x + half.y * half.y)).exp();
        Rgb::new(1.0, 0.5, 0.2) * (0.2 + lobe) * (1.0 + 0.4 * twist + 0.3 * pair.wi.z)
    }
}

#[test]
fn turning_and_exchanging_directions_changes_nothing() {
    let settings = SplineSettings { bytes: 1500, ..SplineSettings::default() };
    let twisted = fit_splines(&Twisted, &settings, &Job::new()).expect("a fit").model;
    assert_eq!(twisted.symmetry(), Symmetry::None);
    for model in [fitted("ggx", 900), fitted("plastic", 900), twisted] {
        for pair in pairs(300) {
            let value = model.eval(&pair);
            for turn in [0.3, 1.0, 2.5, 4.0] {
                let turned = model.eval(&pair.rotated_about_normal(turn));
                let change = (turned - value).map(f64::abs).max_channel();
                assert!(change <= 1e-5 * value.max_channel(), "{value:?}, turned {turned:?}");
            }
            if model.symmetry().is_reciprocal() {
                let other = model.eval(&pair.swapped());
                let change = (other - value).map(f64::abs).max_channel();
                assert!(change <= 1e-9 * value.max_channel(), "{value:?}, exchanged {other:?}");
            }
        }
    }
}

#[test]
fn symmetries_are_found() {
    let fit = |brdf: &dyn Brdf| {
        let settings = SplineSettings { bytes: 400, ..SplineSettings::default() };
        fit_splines(brdf, &settings, &Job::new()).expect("a fit").model.symmetry()
    };
    assert_eq!(fit(&preset("cook-torrance")), Symmetry::Both);
    struct OneWay;
    impl Brdf for OneWay {
        fn eval(&self, pair: &DirectionPair) -> Rgb {
            Rgb::splat(if pair.wi.z > 0.0 && pair.wo.z > 0.0 { 0.1 + pair.wi.z } else { 0.0 })
        }
    }
    assert_eq!(fit(&OneWay), Symmetry::Mirror);
    struct Handed;
    impl Brdf for Handed {
        fn eval(&self, pair: &DirectionPair) -> Rgb {
            let lit = pair.wi.z > 0.0 && pair.wo.z > 0.0;
            let half = pair.half();
            let d = pair.wi - pair.wo;
            // Odd under a mirror, even under exchange.
            let hand = (half.x * d.y - half.y * d.x) * (half.x * d.x + half.y * d.y);
            Rgb::splat(if lit { 0.5 + hand } else { 0.0 })
        }
    }
    assert_eq!(fit(&Handed), Symmetry::Reciprocal);
}

#[test]
fn models_stay_within_their_bytes_and_within_what_was_measured() {
    for bytes in [300, 700, 2_700] {
        for name in ["ggx", "lafortune-blue-paint"] {
            let model = fitted(name, bytes);
            assert!(model.as_bytes().len() <= bytes, "{name}: {} bytes", model.as_bytes().len());
            let ranges = model.ranges();
            for pair in pairs(500) {
                for (value, [min, max]) in model.eval(&pair).channels().iter().zip(&ranges) {
                    assert!((min..=max).contains(&value), "{name}: {value} of {min}..{max}");
                }
            }
        }
    }
    let settings = SplineSettings { bytes: 100, ..SplineSettings::default() };
    let refused = fit_splines(&preset("ggx"), &settings, &Job::new());
    assert!(matches!(refused, Err(SplineError::Bytes { bytes: 100, .. })), "{refused:?}");
}

#[test]
fn larger_models_are_better_and_small_ones_good() {
    let judge = FidelityPairs::new(5, 80_f64.to_radians());
    // Limits a little above what was measured.
    for (name, limits) in
        [("ggx", [0.0024, 0.0013, 0.0009]), ("lafortune-blue-paint", [0.0072, 0.0019, 0.0012])]
    {
        let score = |bytes| judge.measure(&preset(name), &fitted(name, bytes)).score();
        let scores = [700, 4_000, 12_000].map(score);
        let is_good = scores.iter().zip(limits).all(|(score, limit)| *score < limit);
        assert!(is_good, "{name}: {scores:?}");
    }
}

#[test]
fn a_stream_comes_back_whole_and_batches_agree() {
    let model = fitted("cook-torrance", 800);
    let again = SplineBrdf::from_bytes(model.as_bytes()).expect("a stream");
    assert_eq!(again, model);
    let pairs = pairs(1000);
    let batch: DirectionBatch = pairs.iter().collect();
    let mut values = RgbBatch::default();
    model.eval_batch(batch.as_slices(), &mut values);
    for (index, pair) in pairs.iter().enumerate() {
        // What the f32 pairs are, so that rounding them is not counted.
        let exact = model.eval(&batch.as_slices().get(index)).g;
        let off = (values.get(index).g - exact).abs();
        assert!(off <= 2e-3 * exact + 1e-7, "{} against {exact} at {pair:?}", values.get(index).g);
    }
}

#[test]
fn one_and_two_threads_give_the_same_bytes() {
    let bytes = [1, 2].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| fitted("plastic", 500).as_bytes().to_vec())
    });
    assert_eq!(bytes[0], bytes[1]);
}

#[test]
fn luminance_is_grey_and_scattered_rows_are_fitted_as_they_are() {
    let settings =
        SplineSettings { bytes: 1_500, channels: Channels::Luminance, ..SplineSettings::default() };
    let gold = preset("ggx");
    let model = fit_splines(&gold, &settings, &Job::new()).expect("a fit").model;
    let pair = DirectionPair::from_angles(0.4, 0.0, 0.5, 3.0);
    let (grey, colour) = (model.eval(&pair), gold.eval(&pair));
    assert!((grey.r - grey.b).abs() < 1e-12, "{grey:?}");
    assert!((grey.g / colour.luminance() - 1.0).abs() < 0.03, "{grey:?} of {colour:?}");

    let sampling = PairSampling { count: 3_000, seed: 1, theta_max: 1.4 };
    let samples = SampleSet::draw(&gold, &sampling, Channels::Rgb);
    let settings = SplineSettings { bytes: 2_000, ..SplineSettings::default() };
    let fit = fit_spline_samples(&samples, None, &settings, &Job::new()).expect("a fit");
    assert_eq!((fit.nodes, fit.model.symmetry()), (3_000, Symmetry::Both));
    let unseen = PairSampling { seed: 2, ..sampling };
    let errors: Vec<f64> = unseen
        .pairs()
        .map(|pair| (fit.model.eval(&pair).g / gold.eval(&pair).g).ln().abs())
        .collect();
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    assert!(mean < 0.03, "mean log error {mean}");
}

#[test]
fn nothing_to_fit_and_stopped_work_are_errors() {
    struct Black;
    impl Brdf for Black {
        fn eval(&self, _: &DirectionPair) -> Rgb {
            Rgb::BLACK
        }
    }
    let settings = SplineSettings { bytes: 300, ..SplineSettings::default() };
    let black = fit_splines(&Black, &settings, &Job::new());
    assert!(matches!(black, Err(SplineError::NoData { .. })), "{black:?}");
    let cancel = Cancel::new();
    cancel.cancel();
    let job = Job::new().with_cancel(&cancel);
    let stopped = fit_splines(&preset("ggx"), &settings, &job);
    assert!(matches!(stopped, Err(SplineError::Stopped(_))), "{stopped:?}");
}

/// A short stream that asks for a large table is refused before anything is allocated.
#[test]
fn a_head_cannot_ask_for_too_much() {
    let mut bytes = fitted("plastic", 500).as_bytes().to_vec();
    // Symmetry none, three channels; 64 terms, 200 splines of each kind, harmonics up to order 40.
    bytes[..5].copy_from_slice(&[1 << 3 | 1 << 2, 64, 200, 200, 40]);
    let refused = SplineBrdf::from_bytes(&bytes).expect_err("too large");
    assert!(refused.to_string().contains("at most 8 million"), "{refused}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Streams that are cut, changed or made up are models or errors, never panics.
    #[test]
    fn broken_streams_do_no_harm(
        cut in 0..900_usize,
        changes in prop::collection::vec((0..900_usize, any::<u8>()), 0..8),
    ) {
        static MODEL: std::sync::LazyLock<SplineBrdf> =
            std::sync::LazyLock::new(|| fitted("plastic", 900));
        let mut bytes = MODEL.as_bytes().to_vec();
        for (at, value) in changes {
            if let Some(byte) = bytes.get_mut(at) {
                *byte = value;
            }
        }
        bytes.truncate(cut);
        if let Ok(model) = SplineBrdf::from_bytes(&bytes) {
            let value = model.eval(&DirectionPair::from_angles(0.5, 0.0, 0.6, 2.0));
            prop_assert!(value.is_finite() || model.as_bytes().len() < 40);
        }
    }
}
