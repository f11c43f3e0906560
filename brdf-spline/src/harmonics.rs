//! Functions of the azimuth of the difference vector.

use serde::{Deserialize, Serialize};

/// Which reflections of the azimuth φd of the difference vector leave an isotropic material unchanged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Symmetry {
    /// None: f(φd), f(−φd) and f(φd + π) may all differ.
    None,
    /// f(−φd) = f(φd): the material is its own mirror image.
    Mirror,
    /// f(φd + π) = f(φd): light and viewer may be exchanged.
    Reciprocal,
    /// Both.
    Both,
}

impl Symmetry {
    /// Every choice, the one with the most harmonics first.
    pub const ALL: [Self; 4] = [Self::None, Self::Mirror, Self::Reciprocal, Self::Both];

    /// Returns whether exchanging light and viewer changes nothing.
    pub fn is_reciprocal(self) -> bool {
        matches!(self, Self::Reciprocal | Self::Both)
    }

    /// Returns whether mirroring the material changes nothing.
    pub fn is_mirrored(self) -> bool {
        matches!(self, Self::Mirror | Self::Both)
    }

    /// The smallest range of φd, from 0, that all others follow from.
    pub(crate) fn period(self) -> f64 {
        std::f64::consts::FRAC_PI_2 * self.quarters() as f64
    }

    /// Quarters of a turn in that range.
    pub(crate) fn quarters(self) -> usize {
        match self {
            Self::None => 4,
            Self::Mirror | Self::Reciprocal => 2,
            Self::Both => 1,
        }
    }

    /// φd brought to the range from 0 to the period, for φd in (−π, π].
    pub(crate) fn fold(self, phi: f64) -> f64 {
        use std::f64::consts::{PI, TAU};
        let turned = |phi: f64| if phi < 0.0 { phi + PI } else { phi };
        match self {
            Self::None => {
                if phi < 0.0 {
                    phi + TAU
                } else {
                    phi
                }
            }
            Self::Mirror => phi.abs(),
            Self::Reciprocal => turned(phi),
            Self::Both => {
                let phi = phi.abs();
                phi.min(PI - phi)
            }
        }
    }

    /// The harmonics up to an order.
    pub(crate) fn harmonics(self, order: usize) -> Vec<Harmonic> {
        let step = if self.is_reciprocal() { 2 } else { 1 };
        (0..=order)
            .step_by(step)
            .flat_map(|order| {
                let sine = (!self.is_mirrored() && order > 0).then_some(true);
                std::iter::once(false).chain(sine).map(move |is_sine| Harmonic { order, is_sine })
            })
            .collect()
    }
}

/// The function cos mφd or sin mφd.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Harmonic {
    /// m.
    pub(crate) order: usize,
    /// Sine or cosine.
    pub(crate) is_sine: bool,
}

impl Harmonic {
    /// Returns sinᵐθd times cos mφd or sin mφd: smooth where θd = 0 and φd has no meaning.
    pub(crate) fn value(self, sin_theta_d: f64, phi_d: f64) -> f64 {
        self.envelope(sin_theta_d) * self.angular(phi_d)
    }

    /// Returns sinᵐθd.
    pub(crate) fn envelope(self, sin_theta_d: f64) -> f64 {
        // `powi` may differ between machines.
        (0..self.order).fold(1.0, |power, _| power * sin_theta_d)
    }

    fn angular(self, phi_d: f64) -> f64 {
        let (sin, cos) = (self.order as f64 * phi_d).sin_cos();
        if self.is_sine { sin } else { cos }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folding_changes_no_harmonic_of_its_symmetry() {
        for symmetry in Symmetry::ALL {
            let harmonics = symmetry.harmonics(6);
            for step in -31..=31 {
                let phi = f64::from(step) / 10.0;
                let folded = symmetry.fold(phi);
                assert!((0.0..=symmetry.period()).contains(&folded), "{symmetry:?}: {phi}");
                for harmonic in &harmonics {
                    let change = harmonic.value(0.9, phi) - harmonic.value(0.9, folded);
                    assert!(change.abs() < 1e-12, "{symmetry:?} at {phi}: {harmonic:?}");
                }
            }
        }
        let counts = Symmetry::ALL.map(|symmetry| symmetry.harmonics(6).len());
        assert_eq!(counts, [13, 7, 7, 4]);
    }
}
