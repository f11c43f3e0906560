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
        /// Which one was asked for, micrometres.
        wanted_um: Option<f64>,
    },
    /// A table that is written unlike most.
    Dialect {
        /// What parts its fields.
        by: &'static str,
        /// Whether decimals follow a comma.
        decimal_comma: bool,
    },
    /// Angles whose names have no unit are too large for radians.
    DegreesAssumed,
    /// There are no azimuths, and polar angles on both sides of the normal.
    InPlane,
    /// Rows of the same directions have different values.
    Contradictions {
        /// Pairs of directions with such rows.
        pairs: usize,
        /// Largest over smallest value of such a pair.
        largest: f64,
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
            Self::Wavelength { chosen_um, all_um, wanted_um } => {
                let list: Vec<String> = all_um.iter().map(|length| shortest(*length)).collect();
                write!(
                    f,
                    "one channel, {} µm, of the wavelengths {} µm",
                    shortest(*chosen_um),
                    list.join(", ")
                )?;
                match wanted_um.filter(|wanted| (wanted - chosen_um).abs() > 1e-6) {
                    Some(wanted) => write!(f, "; {} µm is not among them", shortest(wanted)),
                    None => Ok(()),
                }
            }
            Self::Dialect { by, decimal_comma } => write!(
                f,
                "{by} part fields{}",
                if *decimal_comma { ", decimals follow a comma" } else { "" }
            ),
            Self::DegreesAssumed => {
                f.write_str("angles have no unit and are too large for radians; taken as degrees")
            }
            Self::InPlane => f.write_str(
                "no azimuths, and polar angles on both sides of the normal: all in one plane, azimuth 0",
            ),
            Self::Contradictions { pairs, largest } if largest.is_finite() => write!(
                f,
                "{pairs} pairs of directions stand in several rows with different values, up to {largest:.2} times apart"
            ),
            Self::Contradictions { pairs, .. } => write!(
                f,
                "{pairs} pairs of directions stand in several rows with different values, some of them 0"
            ),
        }
    }
}

/// A length without the digits that a change of unit adds.
fn shortest(micrometres: f64) -> String {
    ((micrometres * 1e9).round() / 1e9).to_string()
}
