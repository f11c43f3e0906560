//! Convex polygons in the plane.

use glam::DVec2;

/// Returns the corners of the convex hull of a set of points, counter-clockwise, without points on
/// its edges.
///
/// Andrew's monotone chain. Fewer than three distinct points come back sorted, without repeats.
///
/// ```
/// use brdf_param::{contains_point, convex_hull};
/// use glam::DVec2;
///
/// let points = [(0.0, 0.0), (1.0, 0.0), (0.3, 0.3), (0.0, 1.0)].map(DVec2::from);
/// let hull = convex_hull(&points);
/// assert_eq!(hull.len(), 3);
/// assert!(contains_point(&hull, points[2]));
/// ```
pub fn convex_hull(points: &[DVec2]) -> Vec<DVec2> {
    let mut sorted: Vec<DVec2> = points.to_vec();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    sorted.dedup();
    if sorted.len() < 3 {
        return sorted;
    }
    let lower = half_hull(sorted.iter().copied());
    let upper = half_hull(sorted.iter().rev().copied());
    let open = |chain: Vec<DVec2>| chain[..chain.len() - 1].to_vec();
    [open(lower), open(upper)].concat()
}

/// Returns whether a point lies inside a counter-clockwise convex polygon or on its rim.
pub fn contains_point(polygon: &[DVec2], point: DVec2) -> bool {
    let next = polygon.iter().cycle().skip(1);
    polygon.iter().zip(next).all(|(&a, &b)| (b - a).perp_dot(point - a) >= -1e-12)
}

fn half_hull(points: impl Iterator<Item = DVec2>) -> Vec<DVec2> {
    let mut chain: Vec<DVec2> = Vec::new();
    for point in points {
        while let [.., a, b] = chain[..] {
            if (b - a).perp_dot(point - b) > 0.0 {
                break;
            }
            chain.pop();
        }
        chain.push(point);
    }
    chain
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hull_of_a_square_with_inner_points_is_its_corners() {
        let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(DVec2::from);
        let mut points = corners.to_vec();
        points.extend([DVec2::splat(0.5), DVec2::new(0.5, 0.0), DVec2::new(0.2, 0.9)]);
        assert_eq!(convex_hull(&points), corners);
        assert!(contains_point(&corners, DVec2::new(1.0, 0.5)), "the rim belongs to it");
        assert!(!contains_point(&corners, DVec2::new(1.01, 0.5)), "outside");
    }
}
