//! Uniform cubic B-splines on the unit interval.

/// A basis of uniform cubic B-splines on [0, 1].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct CubicBasis {
    /// Number of functions.
    pub(crate) count: usize,
    /// Whether all functions are even about 0: the spline has no kink at the mirror direction.
    pub(crate) is_even: bool,
}

/// The four functions that are not 0 at a point: their indices and values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Taps {
    pub(crate) at: [usize; 4],
    pub(crate) weights: [f64; 4],
}

impl CubicBasis {
    /// The fewest functions of a basis.
    pub(crate) const FEWEST: usize = 5;

    fn intervals(self) -> usize {
        // Three functions more than intervals; mirroring at 0 ties the first to the third.
        self.count - if self.is_even { 2 } else { 3 }
    }

    /// Returns what the functions are at a point, which is clamped to [0, 1].
    pub(crate) fn taps(self, x: f64) -> Taps {
        let intervals = self.intervals();
        let scaled = x.clamp(0.0, 1.0) * intervals as f64;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "between 0 and the number of intervals"
        )]
        let interval = (scaled as usize).min(intervals - 1);
        let t = scaled - interval as f64;
        let (s, t2, t3) = (1.0 - t, t * t, t * t * t);
        let weights = [
            s * s * s / 6.0,
            (3.0 * t3 - 6.0 * t2 + 4.0) / 6.0,
            (3.0 * (t + t2 - t3) + 1.0) / 6.0,
            t3 / 6.0,
        ];
        let at = std::array::from_fn(|tap| match (interval + tap, self.is_even) {
            (index, false) => index,
            (0, true) => 1,
            (index, true) => index - 1,
        });
        Taps { at, weights }
    }

    /// Returns the place of a function's peak, which may lie a little outside of [0, 1].
    pub(crate) fn place(self, index: usize) -> f64 {
        let first = if self.is_even { 0.0 } else { -1.0 };
        (index as f64 + first) / self.intervals() as f64
    }
}

impl Taps {
    /// Returns the value of the spline with these coefficients.
    pub(crate) fn read(&self, coefficients: &[f64]) -> f64 {
        self.at.iter().zip(self.weights).map(|(&at, weight)| weight * coefficients[at]).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_functions_add_up_to_one_and_reproduce_lines() {
        let basis = CubicBasis { count: 9, is_even: false };
        let line: Vec<f64> = (0..9).map(|index| 2.0 - 3.0 * basis.place(index)).collect();
        for step in 0..=100 {
            let x = f64::from(step) / 100.0;
            let taps = basis.taps(x);
            assert!((taps.weights.iter().sum::<f64>() - 1.0).abs() < 1e-14, "at {x}");
            assert!((taps.read(&line) - (2.0 - 3.0 * x)).abs() < 1e-13, "at {x}");
        }
    }

    #[test]
    fn even_splines_are_flat_at_zero() {
        let basis = CubicBasis { count: 7, is_even: true };
        let coefficients: Vec<f64> = (0..7).map(|i| f64::from(i * i % 5)).collect();
        let read = |x: f64| basis.taps(x).read(&coefficients);
        let slope = (read(1e-6) - read(0.0)) / 1e-6;
        assert!(slope.abs() < 1e-4, "{slope}");
        assert!((basis.place(0)).abs() < 1e-15, "the first function peaks at 0");
    }
}
