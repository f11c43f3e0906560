//! Vertices that see the sky alike.

use crate::surface::{Surface, diagonal};

/// Most vertices of a cluster: more share better and cost the square.
const MOST: usize = 400;
/// Clusters beyond which they grow, as their numbers have sixteen bits.
const MOST_CLUSTERS: usize = 1 << 15;
/// Normals count this much more than places, which are in diagonals of the surface.
const NORMAL_WEIGHT: f64 = 2.0;

/// Clusters of vertices that lie close together and face the same way: the longest side of a box in six dimensions is
/// halved until few are left in each.
pub(crate) fn clusters(surface: &Surface) -> Vec<Vec<u32>> {
    let scale = diagonal(&surface.positions).max(f64::MIN_POSITIVE).recip();
    let pairs = surface.positions.iter().zip(&surface.normals);
    let features: Vec<[f64; 6]> = pairs
        .map(|(position, normal)| {
            let ([a, b, c], [d, e, f]) =
                ((scale * *position).to_array(), (NORMAL_WEIGHT * *normal).to_array());
            [a, b, c, d, e, f]
        })
        .collect();
    let mut all: Vec<u32> = (0_u32..).take(features.len()).collect();
    let mut clusters = Vec::new();
    let most = MOST.max(2 * features.len() / MOST_CLUSTERS);
    split(&mut all, &features, most, &mut clusters);
    clusters
}

fn split(vertices: &mut [u32], features: &[[f64; 6]], most: usize, clusters: &mut Vec<Vec<u32>>) {
    if vertices.len() <= most {
        if !vertices.is_empty() {
            vertices.sort_unstable();
            clusters.push(vertices.to_vec());
        }
        return;
    }
    let of = |vertex: &u32, axis: usize| features[*vertex as usize][axis];
    let spread = |axis: usize| {
        let values = || vertices.iter().map(|vertex| of(vertex, axis));
        let mean = values().sum::<f64>() / vertices.len() as f64;
        values().map(|v| (v - mean).powi(2)).sum::<f64>()
    };
    let axis = (0..6).map(|axis| (spread(axis), axis)).max_by(|a, b| a.0.total_cmp(&b.0));
    let axis = axis.map_or(0, |(_, axis)| axis);
    let by_place = |a: &u32, b: &u32| of(a, axis).total_cmp(&of(b, axis)).then(a.cmp(b));
    let middle = vertices.len() / 2;
    vertices.select_nth_unstable_by(middle, by_place);
    let (low, high) = vertices.split_at_mut(middle);
    split(low, features, most, clusters);
    split(high, features, most, clusters);
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    #[test]
    fn every_vertex_is_in_one_small_cluster_with_its_like() {
        let normals = |at: u32| if at.is_multiple_of(2) { DVec3::X } else { DVec3::Y };
        let surface = Surface {
            positions: (0..3000).map(|at| 1e-3 * f64::from(at) * DVec3::Z).collect(),
            normals: (0..3000).map(normals).collect(),
            triangles: Vec::new(),
        };
        let clusters = clusters(&surface);
        let mut all = clusters.concat();
        all.sort_unstable();
        assert!(all.into_iter().eq(0..3000), "each once");
        for cluster in &clusters {
            assert!((100..=MOST).contains(&cluster.len()), "{}", cluster.len());
            assert!(cluster.iter().all(|at| at % 2 == cluster[0] % 2), "one way");
            assert!(cluster[cluster.len() - 1] - cluster[0] < 2000, "close together");
        }
    }
}
