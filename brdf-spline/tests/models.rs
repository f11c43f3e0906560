//! What models promise: symmetries, limits, sizes, streams that come back, and errors on real materials.

use brdf_job::{Cancel, Job, Stopped};
use brdf_model::{
    Brdf, Channels, DirectionBatch, FidelityPairs, GgxLobe, GgxLobes, PairSampling, Preset, Rgb,
    RgbBatch, SampleSet, log_offsets, measure,
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
    assert_eq!((fit.nodes, fit.model.base()), (3_000, None));
    let unseen = PairSampling { seed: 2, ..sampling };
    let errors: Vec<f64> = unseen
        .pairs()
        .map(|pair| (fit.model.eval(&pair).g / gold.eval(&pair).g).ln().abs())
        .collect();
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    assert!(mean < 0.03, "mean log error {mean}");
}

/// Lobes that fit nothing here well.
fn poor_lobes(_: &SampleSet, count: usize) -> Result<GgxLobes, Stopped> {
    let lobe = GgxLobe { f0: Rgb::splat(0.3), f90: 0.5, alpha: 0.3 };
    let wide = GgxLobe { f0: Rgb::splat(0.1), f90: 0.1, alpha: 0.6 };
    let (diffuse, sheen) = (Rgb::new(0.1, 0.1, 0.05), Rgb::splat(0.01));
    Ok(GgxLobes { diffuse, lobes: [lobe, wide][..count].to_vec(), sheen })
}

fn few_rows(channels: Channels) -> SampleSet {
    SampleSet::draw(
        &preset("plastic"),
        &PairSampling { count: 1_200, seed: 1, theta_max: 1.2 },
        channels,
    )
}

/// On lobes too a stream comes back, batches agree, and symmetries hold; the lobes are what is left where no sample is.
#[test]
fn products_change_lobes_where_samples_are() {
    for channels in [Channels::Rgb, Channels::Luminance] {
        let samples = few_rows(channels);
        let settings = SplineSettings {
            bytes: 2_000,
            channels,
            symmetry: Some(Symmetry::Both),
            ..SplineSettings::default()
        };
        let fit = fit_spline_samples(&samples, Some(&poor_lobes), &settings, &Job::new());
        let model = fit.expect("a fit").model;
        assert!(model.as_bytes().len() <= 2_000);
        let base = model.base().expect("lobes").clone();
        assert!([1, 2].contains(&base.lobes.len()), "{base:?}");
        assert_eq!(SplineBrdf::from_bytes(model.as_bytes()).expect("a stream"), model);

        let pairs = pairs(400);
        let batch: DirectionBatch = pairs.iter().collect();
        let mut values = RgbBatch::default();
        model.eval_batch(batch.as_slices(), &mut values);
        for (index, pair) in pairs.iter().enumerate() {
            let exact = model.eval(&batch.as_slices().get(index)).g;
            let found = values.get(index).g;
            assert!((found - exact).abs() <= 2e-3 * exact + 1e-7, "{found}, {exact} at {pair:?}");
            let value = model.eval(pair).g;
            for other in [pair.rotated_about_normal(1.0), pair.swapped()] {
                assert!((model.eval(&other).g / value - 1.0).abs() < 1e-5, "at {pair:?}");
            }
        }

        let errors = |brdf: &dyn Brdf| {
            let offsets = log_offsets(&samples);
            measure(&samples, brdf, &offsets).fidelity.score()
        };
        assert!(errors(&model) < 0.2 * errors(&base), "{} {}", errors(&model), errors(&base));
    }
}

#[test]
fn samples_of_a_material_without_symmetry_find_none() {
    let sampling = PairSampling { count: 1_500, seed: 1, theta_max: 1.3 };
    let samples = SampleSet::draw(&Twisted, &sampling, Channels::Rgb);
    let settings = SplineSettings { bytes: 1_500, ..SplineSettings::default() };
    let fit = |samples| fit_spline_samples(samples, Some(&poor_lobes), &settings, &Job::new());
    assert_eq!(fit(&samples).expect("a fit").model.symmetry(), Symmetry::None);
    let symmetric = fit(&few_rows(Channels::Rgb)).expect("a fit").model.symmetry();
    assert!(symmetric.is_reciprocal(), "{symmetric:?}");
}

#[test]
fn lobes_are_left_where_no_sample_is() {
    let sampling = PairSampling { count: 1_200, seed: 1, theta_max: 0.6 };
    let samples = SampleSet::draw(&preset("plastic"), &sampling, Channels::Rgb);
    let settings = SplineSettings { bytes: 1_500, ..SplineSettings::default() };
    let fit = fit_spline_samples(&samples, Some(&poor_lobes), &settings, &Job::new());
    let model = fit.expect("a fit").model;
    let base = model.base().expect("lobes");
    let far =
        pairs(2_000).into_iter().filter(|p| p.wi.z.max(p.wo.z) < 0.3 && p.wi.z.min(p.wo.z) > 0.1);
    let off: Vec<f64> = far.map(|p| (model.eval(&p).g / base.eval(&p).g).ln().abs()).collect();
    let mean = off.iter().sum::<f64>() / off.len() as f64;
    assert!(off.len() > 30 && mean < 0.3, "{mean} over {}", off.len());
}

#[test]
fn a_base_has_lobes_but_not_too_many() {
    let settings = SplineSettings { bytes: 500, ..SplineSettings::default() };
    for count in [0, 8] {
        let lobes = |samples: &SampleSet, _: usize| {
            let one = poor_lobes(samples, 1)?;
            Ok(GgxLobes { lobes: vec![one.lobes[0]; count], ..one })
        };
        let refused =
            fit_spline_samples(&few_rows(Channels::Rgb), Some(&lobes), &settings, &Job::new());
        let is_told =
            matches!(refused, Err(SplineError::Lobes { lobes, max: 7 }) if lobes == count);
        assert!(is_told, "{refused:?}");
    }
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
    bytes[..5].copy_from_slice(&[1 << 6 | 1 << 2, 64, 200, 200, 40]);
    let refused = SplineBrdf::from_bytes(&bytes).expect_err("too large");
    assert!(refused.to_string().contains("at most 8 million"), "{refused}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Streams that are cut, changed or made up are models or errors, never panics.
    #[test]
    fn broken_streams_do_no_harm(
        on_lobes: bool,
        cut in 0..900_usize,
        changes in prop::collection::vec((0..900_usize, any::<u8>()), 0..8),
    ) {
        static MODELS: std::sync::LazyLock<[SplineBrdf; 2]> = std::sync::LazyLock::new(|| {
            let settings = SplineSettings { bytes: 900, ..SplineSettings::default() };
            let rows = few_rows(Channels::Rgb);
            let fit = fit_spline_samples(&rows, Some(&poor_lobes), &settings, &Job::new());
            [fitted("plastic", 900), fit.expect("a fit").model]
        });
        let mut bytes = MODELS[usize::from(on_lobes)].as_bytes().to_vec();
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
