//! Minimization along a closed line, on which a function is periodic.

/// The options of a line search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineParams {
    /// Number of points spread over the period to find a bracket, at least 3.
    pub probes: usize,
    /// Width of the final bracket as a share of the period.
    pub tolerance: f64,
}

impl Default for LineParams {
    /// Returns 7 probes and a tolerance of 0.5 %.
    ///
    /// Seven probes find minima that are wider than a seventh of the period; 0.5 % of the period is a small
    /// part of a texel.
    fn default() -> Self {
        Self { probes: 7, tolerance: 5e-3 }
    }
}

/// A place on a line and the value of a function there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinePoint {
    /// Parameter along the line.
    pub t: f64,
    /// Value of the function.
    pub value: f64,
}

/// Returns the lowest point found of a function of this period, never worse than the start.
///
/// The start is t = 0, where the value is known.
///
/// The line is probed at equal steps; the lowest point and its neighbours bracket a minimum, which
/// golden section then narrows. Source: Press et al., *Numerical Recipes*, section 10.1.
///
/// ```
/// use brdf_search::{LineParams, minimize_on_line};
///
/// let f = |t: f64| (t - 1.3).cos();
/// let lowest = minimize_on_line(f, f(0.0), std::f64::consts::TAU, &LineParams::default());
/// assert!(lowest.value < -0.999);
/// ```
pub fn minimize_on_line(
    mut f: impl FnMut(f64) -> f64,
    value_at_zero: f64,
    period: f64,
    params: &LineParams,
) -> LinePoint {
    let probes = params.probes.max(3);
    let step = period / probes as f64;
    let start = LinePoint { t: 0.0, value: value_at_zero };
    let mut lowest = start;
    let mut t = 0.0;
    for _ in 1..probes {
        t += step;
        let value = f(t);
        // A value that is not a number is never lower.
        if value < lowest.value {
            lowest = LinePoint { t, value };
        }
    }
    let found = golden_section(&mut f, lowest, step, params.tolerance * period);
    if found.value < start.value { found } else { start }
}

/// Narrows a minimum known to lie within `step` of `lowest`.
fn golden_section(
    f: &mut impl FnMut(f64) -> f64,
    lowest: LinePoint,
    step: f64,
    tolerance: f64,
) -> LinePoint {
    /// Share of a bracket that a point cuts off.
    const GOLDEN: f64 = 0.381_966_011_250_105;
    let (mut from, mut to) = (lowest.t - step, lowest.t + step);
    let mut best = lowest;
    while to - from > tolerance {
        // Probe the longer side.
        let t = if to - best.t > best.t - from {
            best.t + GOLDEN * (to - best.t)
        } else {
            best.t - GOLDEN * (best.t - from)
        };
        let point = LinePoint { t, value: f(t) };
        let (kept, bound) = if point.value < best.value { (point, best.t) } else { (best, t) };
        if bound < kept.t {
            from = bound;
        } else {
            to = bound;
        }
        best = kept;
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_minimum_of_a_cosine_is_found_wherever_the_start_is() {
        for shift in [0.0, 0.3, 1.1, 2.9, 5.0] {
            let mut evaluations = 0;
            let f = |t: f64| -(t - shift).cos();
            let period = std::f64::consts::TAU;
            let params = LineParams { tolerance: 1e-6, ..LineParams::default() };
            let counted = |t| {
                evaluations += 1;
                f(t)
            };
            let found = minimize_on_line(counted, f(0.0), period, &params);
            assert!(found.value < -1.0 + 1e-9, "{shift}: {found:?}");
            assert!(evaluations < 40, "{evaluations}");
        }
    }

    #[test]
    fn constants_and_nan_keep_the_start() {
        let start = LinePoint { t: 0.0, value: 2.0 };
        assert_eq!(minimize_on_line(|_| 2.0, 2.0, 4.0, &LineParams::default()), start);
        assert_eq!(minimize_on_line(|_| f64::NAN, 2.0, 4.0, &LineParams::default()), start);
    }
}
