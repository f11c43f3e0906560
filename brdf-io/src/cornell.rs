//! Cornell `.brdf` spectra, in the text form that pbrt-v2 distributes: comments, the number of
//! wavelengths, the wavelengths in nanometres, then rows of four angles in radians and one value in
//! sr⁻¹ per wavelength. Line breaks mean nothing.

use brdf_model::{Channels, SampleSet};
use brdf_param::DirectionPair;

use crate::error::{FormatError, quoted};
use crate::spectrum::SpectrumToRgb;

/// Most wavelengths a file may have.
const MAX_WAVELENGTHS: usize = 4096;

/// Spectral samples turned into colours, with the wavelengths they had.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectra {
    /// Linear RGB samples.
    pub samples: SampleSet,
    /// Wavelengths of the file, nanometres.
    pub wavelengths: Vec<f64>,
    /// Samples whose colour was moved into the gamut, see [`SpectrumToRgb::rgb_in_gamut`].
    pub moved_into_gamut: usize,
}

/// Reads the samples of a Cornell file as linear RGB; colours outside the gamut are moved into it and counted.
///
/// ```
/// // Two wavelengths in nanometres, then one row: four angles in radians and two values in sr⁻¹.
/// let spectra = brdf_io::read_cornell("# a grey material\n2\n400 700\n0.5 0 0.5 3.14 0.2 0.2\n")?;
/// assert_eq!(spectra.wavelengths, [400.0, 700.0]);
/// assert!((spectra.samples.rgb(0).g - 0.2).abs() < 1e-9);
/// assert_eq!(spectra.moved_into_gamut, 0);
/// # Ok::<(), brdf_io::FormatError>(())
/// ```
///
/// # Errors
///
/// [`FormatError::Line`] for something that is no number; [`FormatError::Missing`].
pub fn read_cornell(text: &str) -> Result<Spectra, FormatError> {
    let mut numbers = numbers(text);
    let mut next = |what: &str| {
        numbers.next().unwrap_or_else(|| {
            Err(FormatError::Missing {
                what: what.to_owned(),
                expected: "it before the end of the file, which may be incomplete".to_owned(),
            })
        })
    };
    let count = next("the number of wavelengths")?;
    if !(2.0..=MAX_WAVELENGTHS as f64).contains(&count) || count.fract() != 0.0 {
        return Err(FormatError::Missing {
            what: format!("usable number of wavelengths ({count})"),
            expected: format!("a whole number from 2 to {MAX_WAVELENGTHS}"),
        });
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked above")]
    let count = count as usize;
    let wavelengths: Vec<f64> =
        (0..count).map(|_| next("a wavelength")).collect::<Result<_, _>>()?;
    let to_rgb = SpectrumToRgb::new(&wavelengths).ok_or_else(|| FormatError::Missing {
        what: "ascending wavelengths".to_owned(),
        expected: "nanometres in ascending order".to_owned(),
    })?;
    let values: Vec<f64> = numbers.collect::<Result<_, _>>()?;
    let row_length = 4 + count;
    if values.is_empty() || !values.len().is_multiple_of(row_length) {
        return Err(FormatError::Missing {
            what: format!("whole rows: {} numbers follow the wavelengths", values.len()),
            expected: format!("a multiple of {row_length}: 4 angles and {count} values a row"),
        });
    }
    let mut samples = SampleSet::new(Channels::Rgb);
    let mut moved_into_gamut = 0;
    for row in values.chunks_exact(row_length) {
        let pair = DirectionPair::from_angles(row[0], row[1], row[2], row[3]);
        let (colour, moved) = to_rgb.rgb_in_gamut(&row[4..]);
        moved_into_gamut += usize::from(moved);
        samples.push_rgb(&pair, colour);
    }
    Ok(Spectra { samples, wavelengths, moved_into_gamut })
}

fn numbers(text: &str) -> impl Iterator<Item = Result<f64, FormatError>> + '_ {
    text.lines().enumerate().flat_map(|(line, content)| {
        let data = content.split('#').next().unwrap_or("");
        data.split([',', ' ', '\t', '\r']).filter(|token| !token.is_empty()).map(move |token| {
            token.parse().map_err(|_| FormatError::Line {
                line: line + 1,
                found: quoted(token),
                expected: "a number".to_owned(),
            })
        })
    })
}
