//! What every reflectance model owes: values that are finite, not negative and reciprocal, zero
//! below the horizon, and energy that does not exceed what arrives.

#![allow(
    clippy::unwrap_used,
    clippy::missing_panics_doc,
    reason = "a test that cannot go on has failed"
)]

mod support;

use crate::support::{cases, pair};
use brdf_model::{Brdf, Preset, Rgb, directional_albedo};
use brdf_param::DirectionPair;
use glam::DVec3;
use proptest::prelude::*;

proptest! {
    #![proptest_config(cases(5_000))]

    #[test]
    fn presets_are_reciprocal_and_not_negative(pair in pair()) {
        // Closer to the horizon than this, cosines themselves carry errors of percents.
        prop_assume!(pair.wi.z.min(pair.wo.z) > 1e-6 || pair.wi.z.min(pair.wo.z) <= 0.0);
        // Nor is the half vector of nearly opposite directions known to nine digits.
        prop_assume!((pair.wi + pair.wo).length() > 1e-3);
        for preset in Preset::ALL {
            let model = preset.brdf();
            let (forward, backward) = (model.eval(&pair), model.eval(&pair.swapped()));
            for (f, b) in forward.channels().into_iter().zip(backward.channels()) {
                prop_assert!(f.is_finite() && f >= 0.0, "{}: {f} at {pair:?}", preset.name());
                prop_assert!((f - b).abs() <= 1e-9 * f.max(b), "{}: {f} {b}", preset.name());
            }
        }
    }

    #[test]
    fn isotropic_presets_do_not_feel_rotation(pair in pair(), turn in -3.0..3.0_f64) {
        prop_assume!(pair.wi.z.min(pair.wo.z) > 1e-6);
        let anisotropic = ["ashikhmin-shirley", "ward"];
        for preset in Preset::ALL.into_iter().filter(|p| !anisotropic.contains(&p.name())) {
            let model = preset.brdf();
            let turned = model.eval(&pair.rotated_about_normal(turn));
            let (here, there) = (model.eval(&pair).g, turned.g);
            prop_assert!((here - there).abs() <= 1e-9 * here.max(1e-9), "{}", preset.name());
        }
    }
}

#[test]
fn nothing_is_reflected_below_the_horizon() {
    let below = DVec3::new(0.6, 0.0, -0.8);
    for preset in Preset::ALL {
        let model = preset.brdf();
        for pair in [DirectionPair::new(below, DVec3::Z), DirectionPair::new(DVec3::Z, below)] {
            assert_eq!(model.eval(&pair), Rgb::BLACK, "{}", preset.name());
            assert!(!model.has_data(&pair), "{}", preset.name());
        }
    }
}

/// Microfacet models and the energy-bounded Ward model; the others promise nothing.
#[test]
fn energy_is_conserved_where_the_model_promises_it() {
    for name in ["lambert", "ward", "ggx", "ashikhmin-shirley"] {
        let model = Preset::find(name).unwrap().brdf();
        for theta in [0.0, 0.5, 1.0, 1.3, 1.5] {
            let albedo = directional_albedo(&model, theta).max_channel();
            assert!(albedo <= 1.01, "{name} reflects {albedo} at {theta} rad");
        }
    }
    let lambert = Preset::find("lambert").unwrap().brdf();
    let albedo = directional_albedo(&lambert, 1.0).r;
    assert!((albedo - 0.5).abs() < 2e-3, "white furnace: {albedo}");
}

#[test]
fn anisotropy_tells_brushed_materials_from_others() {
    let of = |name: &str| brdf_model::anisotropy(&Preset::find(name).unwrap().brdf());
    assert!(of("plastic") < 1e-9 && of("lafortune-blue-paint") < 1e-9);
    assert!(of("ashikhmin-shirley") > 0.1, "{}", of("ashikhmin-shirley"));
}
