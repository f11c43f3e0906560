//! The three analytic test functions of Barla, Belcour and Pacanowski 2015, section 3.

use brdf_model::{Brdf, Rgb};
use brdf_param::DirectionPair;

/// A function of one coordinate each, which typical effects of materials follow; in [0, 1], grey.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TestFunction {
    /// 1 − ‖h̄‖: gloss.
    Specular,
    /// 1 − cos θd.
    Fresnel,
    /// 1 − (wi·n)(wo·n).
    Grazing,
}

impl TestFunction {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Specular, Self::Fresnel, Self::Grazing];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Specular => "specular",
            Self::Fresnel => "fresnel",
            Self::Grazing => "grazing",
        }
    }

    /// The function of a name.
    pub fn find(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|function| function.name() == name)
    }

    /// Its value.
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
