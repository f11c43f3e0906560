//! Round trips, reciprocity and isotropy of direction maps and parametrizations.

mod support;

use std::f64::consts::PI;

use crate::support::{cases, direction, pair};
use brdf_param::{Coordinates, DirectionPair, HemisphereMap, Parametrization};
use glam::{DVec2, DVec3};
use proptest::prelude::*;

/// How far a rebuilt direction may be off. Orthographic and hybrid coordinates hold no heights, and
/// onion slices no cosine of β; those come back through a square root, which where they are small
/// turns a rounding error ε of the coordinates into √ε.
fn tolerance(parametrization: Parametrization, pair: &DirectionPair) -> f64 {
    let through_a_root = |smallest: f64| (1e-15 / smallest.max(1e-9)).clamp(1e-12, 1e-7);
    let cos_beta = |wi: DVec3, wo: DVec3| {
        let view = wo.truncate().try_normalize().unwrap_or(DVec2::X);
        wi.z.hypot(wi.truncate().dot(view))
    };
    match parametrization {
        Parametrization::Orthographic | Parametrization::Hybrid => {
            through_a_root(pair.wi.z.min(pair.wo.z))
        }
        Parametrization::OnionSlice => {
            through_a_root(cos_beta(pair.wi, pair.wo).min(cos_beta(pair.wo, pair.wi)))
        }
        // The frame of the difference vector turns quickly next to the tangent.
        Parametrization::KautzMcCool => {
            let half = pair.half();
            (1e-15 / half.y.hypot(half.z).max(1e-15)).clamp(1e-12, 2.0)
        }
        _ => 1e-12,
    }
}

proptest! {
    #![proptest_config(cases(20_000))]

    #[test]
    fn hemisphere_maps_return_directions(w in direction()) {
        for map in HemisphereMap::ALL {
            let back = map.decode(map.encode(w)).expect("encoded points lie in the domain");
            let allowed = match map {
                // The height comes back through a square root.
                HemisphereMap::OrthographicDisc => (1e-15 / w.z.max(1e-9)).clamp(1e-12, 1e-7),
                _ => 1e-12,
            };
            prop_assert!(back.distance(w) < allowed, "{map:?}: {back} for {w}");
        }
    }

    #[test]
    fn parametrizations_return_pairs(pair in pair()) {
        for parametrization in Parametrization::ALL {
            let coordinates = parametrization.forward(&pair);
            let back = parametrization.inverse(coordinates);
            let allowed = tolerance(parametrization, &pair);
            let Some(back) = back else {
                // Where directions return with a larger error, one on the horizon may sink below it.
                let lowest = pair.wi.z.min(pair.wo.z);
                prop_assert!(lowest < allowed && allowed > 1e-12, "{parametrization:?} lost {pair:?}");
                continue;
            };
            let off = back.wi.distance(pair.wi).max(back.wo.distance(pair.wo));
            prop_assert!(off < allowed, "{parametrization:?}: off by {off} at {pair:?}");
        }
    }

    #[test]
    fn reciprocal_coordinates_are_those_of_the_swapped_pair(pair in pair()) {
        for parametrization in Parametrization::ALL {
            let swapped = parametrization.reciprocal(parametrization.forward(&pair));
            let Some(back) = parametrization.inverse(swapped) else {
                let lowest = pair.wi.z.min(pair.wo.z);
                let allowed = tolerance(parametrization, &pair).max(1e-6);
                prop_assert!(lowest < allowed, "{parametrization:?} lost {pair:?}");
                continue;
            };
            let off = back.wi.distance(pair.wo).max(back.wo.distance(pair.wi));
            let allowed = 4.0 * tolerance(parametrization, &pair);
            prop_assert!(off < allowed, "{parametrization:?}: off by {off} at {pair:?}");
        }
    }

    #[test]
    fn isotropic_coordinates_keep_what_rotation_keeps(pair in pair(), turn in -PI..PI) {
        for parametrization in Parametrization::ALL {
            let canonical = parametrization.isotropic(parametrization.forward(&pair));
            let Some(back) = parametrization.inverse(canonical) else {
                prop_assert!(pair.wi.z.min(pair.wo.z) < 1e-6, "{parametrization:?} lost {pair:?}");
                continue;
            };
            let turned = pair.rotated_about_normal(turn);
            let allowed = 4.0 * tolerance(parametrization, &pair);
            let off = [
                back.wi.z - turned.wi.z,
                back.wo.z - turned.wo.z,
                back.wi.dot(back.wo) - turned.wi.dot(turned.wo),
            ];
            prop_assert!(
                off.iter().all(|d| d.abs() < allowed),
                "{parametrization:?}: {off:?} at {pair:?}"
            );
        }
    }
}

#[test]
fn coordinates_that_are_not_finite_belong_to_nothing() {
    for parametrization in Parametrization::ALL {
        for bad in [f64::NAN, f64::INFINITY] {
            let coordinates = Coordinates(glam::DVec4::new(0.1, bad, 0.1, 0.0));
            assert!(!parametrization.contains(coordinates), "{parametrization:?} took {bad}");
        }
    }
}

/// Integrating 1 and cosθ over the domain of each map gives 2π and π.
#[test]
fn solid_angle_densities_integrate_to_the_hemisphere() {
    const STEPS: i32 = 1000;
    for map in HemisphereMap::ALL {
        let (low, high) = match map {
            HemisphereMap::Spherical => ((0.0, -PI), (PI / 2.0, PI)),
            HemisphereMap::Parabolic | HemisphereMap::OrthographicDisc => {
                ((-1.0, -1.0), (1.0, 1.0))
            }
            HemisphereMap::Polar => ((0.0, 0.0), (1.0, 1.0)),
        };
        let at = |i: i32, low: f64, high: f64| {
            low + (high - low) * (f64::from(i) + 0.5) / f64::from(STEPS)
        };
        let cell = (high.0 - low.0) * (high.1 - low.1) / f64::from(STEPS * STEPS);
        let (mut solid_angle, mut cosine, mut area) = (0.0, 0.0, 0.0);
        for i in 0..STEPS {
            for j in 0..STEPS {
                let point = DVec2::new(at(i, low.0, high.0), at(j, low.1, high.1));
                if let Some(w) = map.decode(point) {
                    let density = map.solid_angle_density(point) * cell;
                    solid_angle += density;
                    cosine += density * w.z;
                    area += cell;
                }
            }
        }
        assert!((cosine / PI - 1.0).abs() < 2e-3, "{map:?}: {cosine}");
        assert!((area / map.domain_area() - 1.0).abs() < 2e-3, "{map:?}: {area}");
        // The rim of the orthographic disc holds a band that a grid of texels misses.
        let allowed = if map == HemisphereMap::OrthographicDisc { 3e-2 } else { 2e-3 };
        assert!((solid_angle / (2.0 * PI) - 1.0).abs() < allowed, "{map:?}: {solid_angle}");
    }
}

proptest! {
    #![proptest_config(cases(5_000))]

    #[test]
    fn hemispheres_return_pairs(pair in pair()) {
        for parametrization in Parametrization::ALL {
            let points = parametrization.hemispheres(&pair);
            for point in points {
                prop_assert!((point.length() - 1.0).abs() < 1e-9 && point.z > -1e-9, "{parametrization:?}: {point}");
            }
            // Heights of the tangent-plane coordinates, and cos β of onion slices, come back through
            // a root; the frame of Kautz and McCool turns quickly next to the tangent.
            let half = pair.half();
            let cos_beta = |a: DVec3, b: DVec3| {
                let view = b.truncate().try_normalize().unwrap_or(DVec2::X);
                a.z.hypot(a.truncate().dot(view))
            };
            let smallest = pair.wi.z.min(pair.wo.z).min(half.y.hypot(half.z))
                .min(cos_beta(pair.wi, pair.wo));
            let Some(back) = parametrization.from_hemispheres(points) else {
                prop_assert!(smallest < 1e-6, "{parametrization:?} lost {pair:?}");
                continue;
            };
            let off = back.wi.distance(pair.wi).max(back.wo.distance(pair.wo));
            prop_assert!(off < 1e-6 || smallest < 1e-6, "{parametrization:?}: {off} at {pair:?}");
        }
    }

    #[test]
    fn isotropic_hemispheres_are_those_of_a_turned_pair(pair in pair()) {
        for parametrization in Parametrization::ALL {
            let points = parametrization.isotropic_hemispheres(&pair);
            prop_assert!(points[0].y.abs() < 1e-15 && points[0].x >= 0.0);
            let smallest = pair.wi.z.min(pair.wo.z).min(pair.half().z);
            let Some(back) = parametrization.from_isotropic_hemispheres(points) else {
                prop_assert!(smallest < 1e-4, "{parametrization:?} lost {pair:?}");
                continue;
            };
            // What no turn about the normal changes.
            let invariants = |p: &DirectionPair| [p.wi.z, p.wo.z, p.wi.dot(p.wo)];
            for (a, b) in invariants(&back).into_iter().zip(invariants(&pair)) {
                prop_assert!((a - b).abs() < 1e-5 || smallest < 1e-4, "{parametrization:?}: {a} for {b} at {pair:?}");
            }
        }
    }
}
