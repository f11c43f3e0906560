//! What tells two samplings apart.

use glam::DVec2;
use hmac_sha256::Hash;

use super::Plan;
use crate::Problem;

/// A hash of positions in the order in which they were given, texture coordinates, plan, bound, grazing
/// limit and smoothing.
pub(super) fn of(problem: &Problem, places: &[DVec2], plan: &Plan) -> String {
    let mut hash = Hash::new();
    let mut add = |value: f64| hash.update((value + 0.0).to_le_bytes());
    let mut sorted: Vec<usize> = (0..problem.len()).collect();
    sorted.sort_unstable_by_key(|at| problem.origin()[*at]);
    let pairs: Vec<_> = problem.pairs().collect();
    for at in sorted {
        for direction in [pairs[at].wi, pairs[at].wo] {
            direction.to_array().into_iter().for_each(&mut add);
        }
    }
    places.iter().flat_map(|place| place.to_array()).for_each(&mut add);
    add(problem.theta_max());
    add(problem.params().smoothing);
    // Derived text names every coordinate, size and bound; it only has to differ where they do.
    hash.update(format!("{plan:?} {:?}", problem.params().bound));
    hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}
