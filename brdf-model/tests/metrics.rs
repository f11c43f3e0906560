//! Measures: zero on equal input, symmetric where they claim to be, and scaling as documented.

#![allow(
    clippy::unwrap_used,
    clippy::missing_panics_doc,
    reason = "a test that cannot go on has failed"
)]

use brdf_model::{
    Brdf, Channels, PairSampling, Preset, Rgb, SampleSet, cosine_rms, log_offsets, measure,
    perceptual_errors,
};
use brdf_param::DirectionPair;
use proptest::prelude::*;

/// A material times a factor.
struct Scaled<'a>(&'a dyn Brdf, f64);

impl Brdf for Scaled<'_> {
    fn eval(&self, pair: &DirectionPair) -> Rgb {
        self.0.eval(pair) * self.1
    }
}

fn samples(brdf: &dyn Brdf) -> SampleSet {
    let sampling = PairSampling { count: 2_000, seed: 4, theta_max: 1.3 };
    SampleSet::draw(brdf, &sampling, Channels::Rgb)
}

#[test]
fn measures_are_zero_on_the_material_itself() {
    for preset in Preset::ALL {
        let brdf = preset.brdf();
        let set = samples(&brdf);
        let fit = measure(&set, &brdf, &log_offsets(&set));
        let eye = perceptual_errors(&set, &brdf);
        let rms = cosine_rms(&brdf, &brdf, Channels::Rgb, 1);
        let all = [
            fit.log.mean_abs,
            fit.log.mean_square,
            fit.log.max,
            fit.linear.mean_abs,
            fit.linear.mean_square,
            fit.linear.max,
            eye.log_cosine_rms,
            eye.cube_root_rms,
            eye.log_relative_rms,
            rms.absolute,
            rms.relative,
            rms.both_cosines,
            rms.within_80,
        ];
        assert!(all.iter().all(|v| v.abs() < 1e-12), "{}: {all:?}", preset.name());
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn measures_scale_as_documented(scale in 0.1..8.0_f64) {
        let a = Preset::find("plastic").unwrap().brdf();
        let b = Preset::find("lambert").unwrap().brdf();
        let rms = |s: f64| cosine_rms(&Scaled(&a, s), &Scaled(&b, s), Channels::Rgb, 1);
        let (one, many) = (rms(1.0), rms(scale));
        prop_assert!((many.absolute / one.absolute / scale - 1.0).abs() < 1e-9);
        prop_assert!((many.both_cosines / one.both_cosines / scale - 1.0).abs() < 1e-9);
        prop_assert!((many.relative / one.relative - 1.0).abs() < 1e-9);
        let cube = |s: f64| {
            perceptual_errors(&samples(&Scaled(&a, s)), &Scaled(&b, s)).cube_root_rms
        };
        prop_assert!((cube(scale) / cube(1.0) / scale.cbrt() - 1.0).abs() < 1e-9);
        // Dark materials: ln(1 + x) is x.
        let log = |s: f64| {
            perceptual_errors(&samples(&Scaled(&a, s)), &Scaled(&b, s)).log_cosine_rms
        };
        prop_assert!((log(1e-6 * scale) / log(1e-6) / scale - 1.0).abs() < 1e-3);
    }

    #[test]
    fn perceptual_measures_are_symmetric(scale in 0.2..3.0_f64) {
        let a = Preset::find("plastic").unwrap().brdf();
        let b = Scaled(&a, scale);
        let (there, back) =
            (perceptual_errors(&samples(&a), &b), perceptual_errors(&samples(&b), &a));
        prop_assert!((there.log_cosine_rms - back.log_cosine_rms).abs() < 1e-12);
        prop_assert!((there.cube_root_rms - back.cube_root_rms).abs() < 1e-12);
        prop_assert!((there.log_relative_rms - back.log_relative_rms).abs() < 1e-12);
    }
}
