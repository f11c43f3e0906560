//! Powell's direction-set method on functions of rotations in four dimensions.
//!
//! Source: Cole 2002, section 3.1.1, after Press et al., *Numerical Recipes in C*, section 10.5. A line
//! through R along D is R(t) = Dᵗ R; six half-turns, one for each component of the two quaternions,
//! are the first directions.

use glam::DQuat;

use crate::Rotation4;
use crate::line_search::{LineParams, minimize_on_line};

/// The options of a descent by Powell's method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowellParams {
    /// Largest number of rounds through the six directions; two to four are usual.
    pub rounds: usize,
    /// Share of the value that a round must lower it by; with less it is the last.
    pub tolerance: f64,
    /// Options of each line search.
    pub line: LineParams,
}

impl Default for PowellParams {
    fn default() -> Self {
        Self { rounds: 8, tolerance: 1e-2, line: LineParams::default() }
    }
}

/// The place at which a descent ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Minimum {
    /// The lowest place found.
    pub rotation: Rotation4,
    /// Value of the function there.
    pub value: f64,
    /// Number of calls of the function.
    pub evaluations: usize,
    /// Whether a round gained less than the tolerance; if not, no rounds were left.
    pub converged: bool,
}

/// Period of a function of the projection of Dᵗ R along a basis direction: after t = 2 a quaternion is
/// its own negative, and the projection a point reflection of itself.
const PERIOD: f64 = 2.0;

/// Returns the minimum of `f` that a descent from `start` by Powell's method ends at.
///
/// `f` is any function of rotations that does not change under point reflection R ↦ −R, such as the error
/// of a texture over [`Rotation4::projection`].
///
/// ```
/// use brdf_search::{PowellParams, Rotation4, minimize_rotation};
/// use glam::{DQuat, DVec4};
///
/// // The rotation that takes x as near to ±w as can be.
/// let f = |r: &Rotation4| 1.0 - r.apply(DVec4::X).w.abs();
/// let start = Rotation4::new(DQuat::from_xyzw(0.1, 0.5, 0.2, 0.8), DQuat::IDENTITY).unwrap();
/// let minimum = minimize_rotation(f, &start, &PowellParams::default());
/// assert!(minimum.value < 1e-3);
/// ```
pub fn minimize_rotation(
    mut f: impl FnMut(&Rotation4) -> f64,
    start: &Rotation4,
    params: &PowellParams,
) -> Minimum {
    let mut evaluations = 0;
    let mut counted = |rotation: &Rotation4| {
        evaluations += 1;
        f(rotation)
    };
    let mut descent = Descent {
        directions: basis_directions(),
        rotation: *start,
        value: counted(start),
        line: params.line,
    };
    let mut converged = false;
    for _ in 0..params.rounds {
        let before = descent.value;
        descent.round(&mut counted);
        converged = before - descent.value <= params.tolerance * before.abs();
        if converged {
            break;
        }
    }
    Minimum { rotation: descent.rotation, value: descent.value, evaluations, converged }
}

struct Descent {
    directions: Vec<Rotation4>,
    rotation: Rotation4,
    value: f64,
    line: LineParams,
}

impl Descent {
    /// Minimizes along every direction; then, where the whole way of the round leads further down,
    /// along it, and lets it replace the direction of the largest decrease.
    fn round(&mut self, f: &mut impl FnMut(&Rotation4) -> f64) {
        let (start, start_value) = (self.rotation, self.value);
        let (mut largest, mut largest_decrease) = (0, 0.0);
        for index in 0..self.directions.len() {
            let before = self.value;
            let direction = self.directions[index];
            self.minimize_along(&direction, PERIOD, f);
            if before - self.value > largest_decrease {
                (largest, largest_decrease) = (index, before - self.value);
            }
        }
        let way = self.rotation.after(&start.inverse());
        if way.angle_to(&Rotation4::IDENTITY) < 1e-6 {
            return;
        }
        let beyond = f(&way.after(&self.rotation));
        if beyond >= start_value {
            return;
        }
        // Numerical Recipes' test: the way must not curve up again, nor one direction alone have made
        // the decrease.
        let curved = 2.0
            * (start_value - 2.0 * self.value + beyond)
            * (start_value - self.value - largest_decrease).powi(2);
        if curved < largest_decrease * (start_value - beyond).powi(2) {
            // Twice the way and back again covers a stretch around both ends.
            self.minimize_along(&way, 4.0, f);
            self.directions.remove(largest);
            self.directions.push(way);
        }
    }

    fn minimize_along(
        &mut self,
        direction: &Rotation4,
        period: f64,
        f: &mut impl FnMut(&Rotation4) -> f64,
    ) {
        let from = self.rotation;
        let along = |t: f64| direction.power(t).after(&from);
        let lowest = minimize_on_line(|t| f(&along(t)), self.value, period, &self.line);
        self.rotation = along(lowest.t);
        self.value = lowest.value;
    }
}

/// Half-turns: one component of one quaternion each.
fn basis_directions() -> Vec<Rotation4> {
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let turns = axes.map(|[x, y, z]| DQuat::from_xyzw(x, y, z, 0.0));
    let left = turns.iter().map(|&q| Rotation4::new(q, DQuat::IDENTITY));
    let right = turns.iter().map(|&q| Rotation4::new(DQuat::IDENTITY, q));
    left.chain(right).flatten().collect()
}
