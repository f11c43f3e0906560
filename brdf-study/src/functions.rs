//! The three analytic test functions of Barla, Belcour and Pacanowski 2015, section 3.

use brdf_model::{Brdf, Rgb};
use brdf_param::DirectionPair;

/// A grey test function in [0, 1] of a single quantity, which typical effects of materials follow.
///
/// ```
/// use brdf_param::DirectionPair;
/// use brdf_study::TestFunction;
///
/// let pair = DirectionPair::from_angles(0.3, 0.0, 0.3, 0.0);
/// assert!(TestFunction::Fresnel.value(&pair) < 1e-12, "light and viewer coincide");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TestFunction {
    /// Gloss: 1 − ‖h̄‖.
    Specular,
    /// The Fresnel effect: 1 − cos θd.
    Fresnel,
    /// Effects at grazing angles: 1 − (wi·n)(wo·n).
    Grazing,
}

impl TestFunction {
    /// All three functions.
    pub const ALL: [Self; 3] = [Self::Specular, Self::Fresnel, Self::Grazing];

    /// Returns the name used on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Specular => "specular",
            Self::Fresnel => "fresnel",
            Self::Grazing => "grazing",
        }
    }

    /// Returns the function of this name, or `None` where there is none.
    pub fn find(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|function| function.name() == name)
    }

    /// Returns the value for a pair, [0, 1].
    pub fn value(self, pair: &DirectionPair) -> f64 {
        let half = 0.5 * (pair.wi + pair.wo);
        match self {
            Self::Specular => 1.0 - half.truncate().length(),
            // cos θd is the length of the unnormalized half vector.
            Self::Fresnel => 1.0 - half.length(),
            Self::Grazing => 1.0 - pair.wi.z * pair.wo.z,
        }
    }
}

impl Brdf for TestFunction {
    fn eval(&self, pair: &DirectionPair) -> Rgb {
        if self.has_data(pair) { Rgb::splat(self.value(pair).max(0.0)) } else { Rgb::BLACK }
    }
}
