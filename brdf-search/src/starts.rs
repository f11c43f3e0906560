//! Where searches start.

use brdf_param::Projection;

use crate::random::StartRng;

/// Planes that suggest themselves: the first direction, the second, their sum and difference, and
/// planes that pair one component of each. In standard space the directions are `wi` and `wo`, in
/// half/difference space h and d.
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
/// random ones alone.
pub(crate) fn joint_starts(terms: usize, count: usize, seed: u64) -> Vec<Vec<Projection>> {
    let canonical = canonical_projections();
    (0..count)
        .map(|start| {
            let mut rng = StartRng::new(seed, terms as u64, start as u64);
            let mut set: Vec<Projection> = Vec::with_capacity(terms);
            if let Some(&first) = canonical.get(start) {
                set.push(first);
            }
            while set.len() < terms {
                set.push(rng.projection());
            }
            set
        })
        .collect()
}
