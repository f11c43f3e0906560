//! Every printed error of the papers that this code corrects, and what holds instead.

mod support;

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::support::{cases, pair};
use brdf_param::{
    DirectionPair, HalfDifference, Hybrid, OnionSlice, Orthographic, polar_angle, wrap_azimuth,
};
use glam::DVec3;
use proptest::prelude::*;

fn theta_k_of(pair: &DirectionPair) -> f64 {
    polar_angle((pair.wi - pair.wo).normalize_or(DVec3::X))
}

proptest! {
    #![proptest_config(cases(20_000))]

    /// Barla et al., section 3: ‖h̄‖ = sin θh cos θd, without the printed square.
    #[test]
    fn the_planar_half_length_is_sin_theta_h_cos_theta_d(pair in pair()) {
        let angles = HalfDifference::from_pair(&pair);
        let planar = Hybrid::from_pair(&pair).h_length;
        let printed = angles.theta_h.sin() * angles.theta_d.cos();
        prop_assert!((planar - printed).abs() < 1e-12, "{planar} {printed}");
    }

    /// Barla et al., appendix: θk from atan2(h·n, −‖h̄‖ cos(φh − φk)) lies in [0, π].
    #[test]
    fn theta_k_keeps_its_branch(pair in pair()) {
        let hybrid = Hybrid::from_pair(&pair);
        let height = 0.5 * (pair.wi.z + pair.wo.z);
        let expected = theta_k_of(&pair);
        // Needs both vectors: an azimuth without a length says nothing.
        prop_assume!(hybrid.k_length > 1e-3 && height > 1e-3);
        let planar_k = 0.5 * (pair.wi - pair.wo).truncate().length();
        prop_assume!(planar_k > 1e-6);
        prop_assert!((hybrid.theta_k() - expected).abs() < 1e-7, "{} {expected}", hybrid.theta_k());
    }

    /// Barla et al., appendix: φk = φh + atan2(sin φd, cos φd cos θh), not φh + φd.
    #[test]
    fn phi_k_follows_from_phi_d_and_theta_h(pair in pair()) {
        let angles = HalfDifference::from_pair(&pair);
        let hybrid = Hybrid::from_pair(&pair);
        let planar_k = 0.5 * (pair.wi - pair.wo).truncate().length();
        prop_assume!(planar_k > 1e-4 && hybrid.h_length > 1e-4);
        let turn = angles.phi_d.sin().atan2(angles.phi_d.cos() * angles.theta_h.cos());
        let off = wrap_azimuth(hybrid.phi_k - angles.phi_h - turn);
        prop_assert!(off.abs() < 1e-9, "off by {off} at {pair:?}");
    }

    /// Barla et al., appendix: (wi·n)(wo·n) = 1 − ‖h̄‖² − ‖k‖² (1 + cos² θk) holds as printed.
    #[test]
    fn the_grazing_identity_holds(pair in pair()) {
        let hybrid = Hybrid::from_pair(&pair);
        let cos_k = theta_k_of(&pair).cos();
        let k_sq = hybrid.k_length.powi(2);
        let printed = 1.0 - hybrid.h_length.powi(2) - k_sq * (1.0 + cos_k * cos_k);
        prop_assert!((pair.wi.z * pair.wo.z - printed).abs() < 1e-12);
    }

    /// Havran et al., Eq. 3: with the sine, the mirror direction lies in the middle of its slice.
    #[test]
    fn mirror_directions_have_beta_zero(theta in 0.0..FRAC_PI_2, phi in -PI..PI) {
        let mirror = DirectionPair::from_angles(theta, phi + PI, theta, phi);
        let slice = OnionSlice::from_pair(&mirror);
        prop_assert!(slice.sin_beta.abs() < 1e-12, "{slice:?}");
        prop_assert!((slice.alpha + theta).abs() < 1e-9, "α keeps its sign: {slice:?}");
    }
}

/// The printed forms fail as recorded: each of these would pass if the erratum were none.
#[test]
fn the_printed_forms_are_wrong() {
    let pair = DirectionPair::from_angles(0.9, 0.3, 0.4, 2.2);
    let (angles, hybrid) = (HalfDifference::from_pair(&pair), Hybrid::from_pair(&pair));
    let squared = angles.theta_h.sin() * angles.theta_d.cos();
    assert!((hybrid.h_length.powi(2) - squared).abs() > 1e-2, "‖h̄‖² as printed");
    assert!(
        wrap_azimuth(hybrid.phi_k - angles.phi_h - angles.phi_d).abs() > 1e-2,
        "φk = φh + φd as printed"
    );
}

#[test]
fn degenerate_pairs_have_their_documented_answers() {
    let opposite = DirectionPair::new(DVec3::X, DVec3::NEG_X);
    assert_eq!(opposite.half(), DVec3::Z, "h = 0 takes the normal");
    assert!(Hybrid::from_pair(&opposite).phi_h.abs() < 1e-15, "h̄ = 0");
    assert!((Hybrid::from_pair(&opposite).theta_k() - FRAC_PI_2).abs() < 1e-15, "h·n = 0");

    let equal = DirectionPair::from_angles(0.7, 1.0, 0.7, 1.0);
    assert!(Hybrid::from_pair(&equal).phi_k.abs() < 1e-15, "k = 0");
    assert!(Orthographic::from_pair(&equal).phi_k.abs() < 1e-15, "k̄ = 0");
    assert!(HalfDifference::from_pair(&equal).theta_d < 1e-7, "θd = 0");

    // Half vector along the tangent: the frame of the difference vector takes its limit.
    let along = DirectionPair::new(DVec3::X, DVec3::X);
    let back = brdf_param::KautzMcCool::from_pair(&along).to_pair().unwrap();
    assert!(back.wi.distance(DVec3::X) < 1e-12 && back.wo.distance(DVec3::X) < 1e-12);

    // At the zenith the view azimuth still fixes the frame of the light.
    let (alpha, sin_beta) = OnionSlice::light(DVec3::new(0.6, 0.0, 0.8), TAU / 4.0);
    assert!(alpha.abs() < 1e-15 && (sin_beta + 0.6).abs() < 1e-15, "{alpha} {sin_beta}");
}
