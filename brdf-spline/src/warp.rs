//! Scales of the two polar angles, on which splines have even knots.

use std::f64::consts::FRAC_PI_2;

/// Returns the place of θd on its axis: tan(θd/2)^1.5, [0, 1].
pub(crate) fn difference_axis(theta_d: f64) -> f64 {
    let t = (0.5 * theta_d).tan().clamp(0.0, 1.0);
    t * t.sqrt()
}

/// Returns the angle at a place of [`difference_axis`].
pub(crate) fn difference_angle(u: f64) -> f64 {
    2.0 * u.clamp(0.0, 1.0).cbrt().powi(2).atan()
}

/// The axis of θh: even up to about `alpha`, then geometric. A GGX lobe is −4 ln cosh there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct HalfAxis {
    /// Angle at which the spacing changes, radians.
    pub(crate) alpha: f64,
}

impl HalfAxis {
    /// Returns the place of θh: asinh(θh/α) / asinh(π/2α), [0, 1].
    pub(crate) fn place(self, theta_h: f64) -> f64 {
        (theta_h / self.alpha).asinh() / self.length()
    }

    /// Returns asinh(π/2α).
    pub(crate) fn length(self) -> f64 {
        (FRAC_PI_2 / self.alpha).asinh()
    }

    /// Returns θh at a place.
    #[cfg(test)]
    fn angle(self, x: f64) -> f64 {
        self.alpha * (x * self.length()).sinh()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_go_both_ways() {
        let axis = HalfAxis { alpha: 0.01 };
        for step in 0..=20 {
            let place = f64::from(step) / 20.0;
            assert!((axis.place(axis.angle(place)) - place).abs() < 1e-13, "θh at {place}");
            let back = difference_axis(difference_angle(place));
            assert!((back - place).abs() < 1e-13, "θd at {place}: {back}");
        }
        assert!((axis.angle(1.0) - FRAC_PI_2).abs() < 1e-12, "the axis ends at the horizon");
    }
}
