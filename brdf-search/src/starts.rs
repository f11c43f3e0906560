//! The projections that searches start from.

use brdf_param::Projection;

use crate::random::StartRng;

/// Returns the simple planes that searches start from: the first direction, the second, their sum and
/// difference, and planes that pair one component of each.
///
/// In standard space the directions are `wi` and `wo`, in half/difference space h and d.
pub fn canonical_projections() -> Vec<Projection> {
    const ROWS: [[[f64; 4]; 2]; 8] = [
        [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]],
        [[0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]],
        [[1.0, 0.0, 1.0, 0.0], [0.0, 1.0, 0.0, 1.0]],
        [[1.0, 0.0, -1.0, 0.0], [0.0, 1.0, 0.0, -1.0]],
        [[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]],
        [[0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]],
        [[1.0, 0.0, 0.0, 1.0], [0.0, 1.0, -1.0, 0.0]],
        [[1.0, 0.0, 0.0, -1.0], [0.0, 1.0, 1.0, 0.0]],
    ];
    ROWS.iter().filter_map(|[a, b]| Projection::from_rows(*a, *b).ok()).collect()
}

/// Sets of `terms` planes to start from together: every canonical plane beside random ones, then
/// random ones alone. Every other set is made of turning planes only: minima of that kind exclude
/// others.
pub(crate) fn joint_starts(terms: usize, count: usize, seed: u64) -> Vec<Vec<Projection>> {
    let canonical = canonical_projections();
    (0..count)
        .map(|start| {
            let mut rng = StartRng::new(seed, terms as u64, start as u64);
            let mut set: Vec<Projection> = canonical.get(start).copied().into_iter().collect();
            while set.len() < terms {
                set.push(plane(start, &mut rng));
            }
            set
        })
        .collect()
}

/// Planes to try as the next of a set: the canonical ones, then random ones.
pub(crate) fn new_planes(count: usize, seed: u64, terms: usize, set: usize) -> Vec<Projection> {
    // Stages of grown sets follow those of sets that start together.
    let mut rng = StartRng::new(seed, 101 + terms as u64, set as u64);
    let mut planes = canonical_projections();
    while planes.len() < count {
        planes.push(plane(planes.len(), &mut rng));
    }
    planes
}

fn plane(index: usize, rng: &mut StartRng) -> Projection {
    if index.is_multiple_of(2) { rng.turning_projection() } else { rng.mixed_projection() }
}
