//! What a reader assumed, chose or changed.

use std::fmt;

/// An assumption, choice or change that a reader made, which the user of the file should be told.
///
/// [`Display`](fmt::Display) says it in a sentence without a full stop.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ReadNote {
    /// A neural BRDF stands for the measurement.
    NeuralProxy,
    /// Spectra became colours.
    Spectra {
        /// How many wavelengths they have.
        wavelengths: usize,
        /// The first and last, nanometres.
        range_nm: [f64; 2],
    },
    /// Colours outside the gamut of Rec. 709, or within 1 % of its rim, were moved towards grey.
    MovedIntoGamut {
        /// How many.
        moved: usize,
        /// Of how many.
        colours: usize,
    },
    /// Values held the cosine of the viewer.
    CosineDividedOut,
    /// The file does not say what its values are.
    UnitAssumed,
    /// One of several wavelengths was taken.
    Wavelength {
        /// Which one, micrometres.
        chosen_um: f64,
        /// All of them, micrometres.
        all_um: Vec<f64>,
    },
}

impl fmt::Display for ReadNote {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NeuralProxy => {
                f.write_str("an NBRDF proxy: a network's smooth fit, not the measurement")
            }
            Self::Spectra { wavelengths, range_nm: [first, last] } => write!(
                f,
                "{wavelengths} wavelengths from {first} to {last} nm became linear RGB (CIE 1931 2°, D65)"
            ),
            Self::MovedIntoGamut { moved, colours } => write!(
                f,
                "{moved} of {colours} colours lay outside the gamut of Rec. 709 or within 1 % of its rim; \
                 they were moved towards grey of the same luminance"
            ),
            Self::CosineDividedOut => {
                f.write_str("values held the cosine of the viewer; it was divided out")
            }
            Self::UnitAssumed => {
                f.write_str("#PARAM_OUT is missing; values were taken as sr⁻¹ without cosine")
            }
            Self::Wavelength { chosen_um, all_um } => {
                let list: Vec<String> = all_um.iter().map(f64::to_string).collect();
                write!(f, "one channel, {chosen_um} µm, of the wavelengths {} µm", list.join(", "))
            }
        }
    }
}
