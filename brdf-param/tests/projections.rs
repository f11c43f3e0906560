//! Projections: orthonormal rows, tight bounds, reciprocal conjugates.

mod support;

use crate::support::{cases, pair};
use brdf_param::{Bound, DiscRadii, ParabolicPair, Projection, Space, contains_point};
use glam::{DVec2, DVec4};
use proptest::prelude::*;

fn projection() -> impl Strategy<Value = Projection> {
    let row = || prop::array::uniform4(-1.0..1.0_f64);
    (row(), row()).prop_filter_map("dependent rows", |(a, b)| Projection::from_rows(a, b).ok())
}

proptest! {
    #![proptest_config(cases(2_000))]

    #[test]
    fn rows_are_orthonormal_and_survive_storage(p in projection()) {
        let [a, b] = p.rows();
        prop_assert!((a.length() - 1.0).abs() < 1e-13 && (b.length() - 1.0).abs() < 1e-13);
        prop_assert!(a.dot(b).abs() < 1e-13);
        let again = Projection::from_rows(a.to_array(), b.to_array());
        prop_assert_eq!(again.ok(), Some(p));
    }

    /// The disc bound is reached and never passed; the cube bound is never tighter.
    #[test]
    fn the_disc_bound_is_exact(p in projection(), r1 in 0.1..1.0_f64, r2 in 0.1..1.0_f64) {
        let radii = DiscRadii { first: r1, second: r2 };
        let scaled = p.scaled(Bound::Disc, radii);
        let polygon = scaled.image_polygon(Bound::Disc, radii);
        let furthest = polygon.iter().fold(DVec2::ZERO, |m, v| m.max(v.abs()));
        prop_assert!(furthest.max_element() <= 1.0 + 1e-12);
        prop_assert!(furthest.min_element() > 0.999, "touches all sides: {furthest}");
        let cube = p.extent(Bound::Cube, DiscRadii::UNIT);
        let disc = p.extent(Bound::Disc, DiscRadii::UNIT);
        prop_assert!(disc.cmple(cube + 1e-12).all());
    }

    #[test]
    fn images_of_points_lie_in_the_polygon(
        p in projection(),
        radii in prop::array::uniform2(0.0..1.0_f64),
        azimuths in prop::array::uniform2(0.0..7.0_f64),
    ) {
        let scaled = p.scaled(Bound::Disc, DiscRadii::UNIT);
        let polygon = scaled.image_polygon(Bound::Disc, DiscRadii::UNIT);
        let disc = |i: usize| radii[i] * DVec2::from_angle(azimuths[i]);
        let image = scaled.apply(ParabolicPair { first: disc(0), second: disc(1) });
        // The polygon cuts 8e-5 of the rim off.
        prop_assert!(contains_point(&polygon, image * (1.0 - 2e-4)), "{image}");
    }

    #[test]
    fn conjugates_read_the_swapped_pair(p in projection(), pair in pair()) {
        for space in [Space::Standard, Space::HalfDifference] {
            let here = p.scaled_by(DVec2::ONE).apply(space.coordinates(&pair));
            let there = p
                .reciprocal_conjugate(space)
                .scaled_by(DVec2::ONE)
                .apply(space.coordinates(&pair.swapped()));
            prop_assert!(here.distance(there) < 1e-12, "{space:?} at {pair:?}");
        }
    }

    /// Rows that are not orthogonal are a linear map of orthonormal ones (Cole 2002, appendix A), and a
    /// texture over those covers all that they reach: by an oblique row too the image goes as far as the
    /// bound says.
    #[test]
    fn oblique_rows_are_a_linear_map_of_orthonormal_ones(
        p in projection(),
        angle_deg in prop_oneof![1.0..85.0_f64, 95.0..179.0_f64],
        lengths in prop::array::uniform2(1e-3..1e3_f64),
        discs in prop::array::uniform2(0.1..1.0_f64),
        point in prop::array::uniform4(-0.7..0.7_f64),
    ) {
        let [a, across] = p.rows();
        let (sin, cos) = angle_deg.to_radians().sin_cos();
        let oblique = [lengths[0] * a, lengths[1] * (cos * a + sin * across)];
        let q = Projection::from_rows(oblique[0].to_array(), oblique[1].to_array()).unwrap();
        for (row, expected) in q.rows().iter().zip([a, across]) {
            prop_assert!(row.distance(expected) < 1e-11, "{row} {expected}");
        }
        let whole = q.scaled_by(DVec2::ONE);
        let linear = oblique.map(|row| DVec2::new(row.dot(q.rows()[0]), row.dot(q.rows()[1])));
        let [x, y, z, w] = point;
        let through =
            whole.apply(ParabolicPair { first: DVec2::new(x, y), second: DVec2::new(z, w) });
        for (row, linear) in oblique.iter().zip(linear) {
            let direct = row.dot(DVec4::from_array(point));
            prop_assert!((direct - linear.dot(through)).abs() < 1e-11 * row.length());
        }
        let radii = DiscRadii { first: discs[0], second: discs[1] };
        let reach = |polygon: &[DVec2], linear: DVec2| {
            polygon.iter().map(|v| v.dot(linear)).fold(f64::NEG_INFINITY, f64::max)
        };
        let disc = whole.image_polygon(Bound::Disc, radii);
        let cube = whole.image_polygon(Bound::Cube, radii);
        let longest = disc.iter().map(|v| v.length()).fold(0.0, f64::max);
        for (row, linear) in oblique.iter().zip(linear) {
            let of_discs = radii.first * row.x.hypot(row.y) + radii.second * row.z.hypot(row.w);
            let missed = (of_discs - reach(&disc, linear)) / (longest * linear.length());
            // Of an ellipse the polygon cuts at most 3.7e-3 of its length off, where it is a sliver.
            prop_assert!((-1e-12..8e-3).contains(&missed), "discs: {missed}");
            let share = reach(&cube, linear) / row.abs().element_sum();
            prop_assert!((share - 1.0).abs() < 1e-12, "cube: {share}");
        }
    }
}
