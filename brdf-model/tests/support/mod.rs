//! Random directions and pairs of them that look for trouble, shared by the tests of this folder.

use brdf_param::DirectionPair;
use glam::DVec3;
use proptest::prelude::*;

/// Directions of the upper hemisphere: most of them anywhere, many at the pole, at the horizon,
/// along the axes, or next to those by less than a rounding error matters.
pub(crate) fn direction() -> impl Strategy<Value = DVec3> {
    let anywhere = (0.0..=1.0_f64, -4.0..4.0_f64).prop_map(|(z, phi)| from_height(z, phi));
    let near = |height: f64| {
        (-18.0..-1.0_f64, -4.0..4.0_f64).prop_map(move |(exponent, phi)| {
            from_height((height - 10_f64.powf(exponent)).abs(), phi)
        })
    };
    let corners = prop::sample::select(vec![
        DVec3::Z,
        DVec3::X,
        DVec3::NEG_X,
        DVec3::Y,
        DVec3::NEG_Y,
        DVec3::new(0.6, 0.0, 0.8),
        DVec3::new(-0.6, 0.0, 0.8),
    ]);
    prop_oneof![6 => anywhere, 2 => near(1.0), 2 => near(0.0), 1 => corners]
}

/// Pairs: independent ones, equal, mirrored, opposite in azimuth, and nearly so.
pub(crate) fn pair() -> impl Strategy<Value = DirectionPair> {
    let related = (direction(), -18.0..-1.0_f64, 0..5_u8).prop_map(|(wi, exponent, relation)| {
        let nudge = DVec3::new(10_f64.powf(exponent), -0.3 * 10_f64.powf(exponent), 0.0);
        let wo = match relation {
            0 => wi,
            1 => DVec3::new(-wi.x, -wi.y, wi.z),
            2 => raise(wi + nudge),
            3 => raise(DVec3::new(-wi.x, -wi.y, wi.z) + nudge),
            _ => DVec3::new(-wi.y, wi.x, wi.z),
        };
        DirectionPair::new(wi, wo)
    });
    let independent = (direction(), direction()).prop_map(|(wi, wo)| DirectionPair::new(wi, wo));
    prop_oneof![2 => independent, 1 => related]
}

/// This many random cases, however many of them a test passes over.
pub(crate) fn cases(count: u32) -> ProptestConfig {
    ProptestConfig { max_global_rejects: u32::MAX, ..ProptestConfig::with_cases(count) }
}

fn from_height(z: f64, phi: f64) -> DVec3 {
    let planar = (1.0 - z * z).max(0.0).sqrt();
    DVec3::new(planar * phi.cos(), planar * phi.sin(), z).normalize()
}

fn raise(w: DVec3) -> DVec3 {
    w.normalize().with_z(w.z.abs()).normalize()
}
