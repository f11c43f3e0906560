//! Microfacet models against Mitsuba 3, computed by `scripts/mitsuba_microfacet.py`.
//!
//! Mitsuba masks and shadows with the separable Smith form, G₁(wi) G₁(wo); ours is height-correlated,
//! so its values are brought to the separable form by the exact ratio of the two, which each
//! direction's Λ gives.

use std::f64::consts::PI;

use brdf_model::{Analytic, Brdf, Fresnel, Ggx, Lambert, Rgb};
use brdf_param::DirectionPair;
use glam::DVec3;

const GOLDEN: &str = include_str!("data/mitsuba_microfacet.csv");

fn rows(model: &str) -> Vec<(DirectionPair, [f64; 3])> {
    let rows: Vec<_> = GOLDEN
        .lines()
        .filter_map(|line| line.strip_prefix(model)?.strip_prefix(','))
        .map(|line| {
            let v: Vec<f64> = line.split(',').map(|field| field.parse().unwrap()).collect();
            let [ti, pi, to, po] = [v[0], v[1], v[2], v[3]].map(f64::to_radians);
            (DirectionPair::from_angles(ti, pi, to, po), [v[4], v[5], v[6]])
        })
        .collect();
    assert_eq!(rows.len(), 60, "rows of {model}");
    rows
}

pub(crate) fn conductor() -> Fresnel {
    Fresnel::Conductor { eta: Rgb::new(0.2, 0.92, 1.1), k: Rgb::new(3.91, 2.45, 2.14) }
}

/// (1 + Λi + Λo) / ((1 + Λi)(1 + Λo)): separable over height-correlated masking.
pub(crate) fn separable_over_correlated(pair: &DirectionPair, alpha_x: f64, alpha_y: f64) -> f64 {
    let lambda = |w: DVec3| {
        let slope_sq = ((alpha_x * w.x).powi(2) + (alpha_y * w.y).powi(2)) / (w.z * w.z);
        0.5 * ((1.0 + slope_sq).sqrt() - 1.0)
    };
    let (i, o) = (lambda(pair.wi), lambda(pair.wo));
    (1.0 + i + o) / ((1.0 + i) * (1.0 + o))
}

fn check_ggx(model: &str, fresnel: Fresnel, alpha_x: f64, alpha_y: f64) {
    let ggx = Analytic::Ggx(Ggx { diffuse: Rgb::BLACK, fresnel, alpha_x, alpha_y });
    for (pair, expected) in rows(model) {
        let found = ggx.eval(&pair) * separable_over_correlated(&pair, alpha_x, alpha_y);
        for (found, expected) in found.channels().into_iter().zip(expected) {
            let error = (found - expected).abs();
            assert!(error <= 5e-6 * expected, "{model}: {found} for {expected} at {pair:?}");
        }
    }
}

#[test]
fn ggx_conductors_match() {
    check_ggx("conductor_ggx", conductor(), 0.3, 0.3);
    check_ggx("conductor_ggx_aniso", conductor(), 0.15, 0.4);
}

#[test]
fn a_ggx_dielectric_coat_matches() {
    check_ggx("plastic_ggx", Fresnel::Dielectric { ior: 1.5 }, 0.3, 0.3);
}

#[test]
fn lambert_matches() {
    let lambert = Analytic::Lambert(Lambert { albedo: Rgb::new(0.2, 0.5, 0.8) });
    for (pair, expected) in rows("diffuse") {
        for (found, expected) in lambert.eval(&pair).channels().into_iter().zip(expected) {
            assert!((found - expected).abs() <= 2e-7 * expected, "{found} for {expected}");
        }
        assert!((lambert.eval(&pair).r - 0.2 / PI).abs() < 1e-15);
    }
}
