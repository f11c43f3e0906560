//! Measured materials, whatever file they come in.

use brdf_model::{
    Brdf, Channels, MerlLookup, MerlNodes, MerlTable, Nbrdf, RglBrdf, SampleSet, ScatteredBrdf,
    UtiaTable,
};

#[cfg(feature = "table")]
use crate::TableOptions;
use crate::detect::{Format, detect};
use crate::error::FormatError;
use crate::note::ReadNote;
#[cfg(any(feature = "cornell", feature = "alta", feature = "table"))]
use crate::text::decode;

/// Choices that the content of a file does not settle: how a table is interpolated, what its columns mean, which
/// wavelength or which material of several is wanted.
///
/// ```
/// let table = brdf_io::TableOptions { wavelength_um: Some(0.633), ..Default::default() };
/// let options = brdf_io::ReadOptions { table, ..Default::default() };
/// assert!(options.material.is_none());
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ReadOptions {
    /// Interpolation of a MERL table; trilinear between the centres of cells by default.
    pub merl_lookup: MerlLookup,
    /// What a table itself may not say.
    #[cfg(feature = "table")]
    pub table: TableOptions,
    /// The name of the material to take from an archive; needed where the archive holds several.
    pub material: Option<String>,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self {
            merl_lookup: MerlLookup::Trilinear(MerlNodes::Centre),
            #[cfg(feature = "table")]
            table: TableOptions::default(),
            material: None,
        }
    }
}

/// A measured material in the form in which its file holds it.
#[derive(Debug)]
pub enum Measured {
    /// A MERL table.
    Merl(MerlTable),
    /// An RGL material.
    Rgl(Box<RglBrdf>),
    /// A UTIA table.
    Utia(UtiaTable),
    /// A neural BRDF.
    Nbrdf(Box<Nbrdf>),
    /// Scattered samples.
    Samples(Box<ScatteredBrdf>),
}

impl Measured {
    /// Returns the material as a function of two directions. Scattered samples are interpolated, which serves
    /// pictures only: fit models to [`Measured::samples`] instead.
    pub fn brdf(&self) -> &dyn Brdf {
        match self {
            Self::Merl(table) => table,
            Self::Rgl(material) => material.as_ref(),
            Self::Utia(table) => table,
            Self::Nbrdf(network) => network.as_ref(),
            Self::Samples(samples) => samples.as_ref(),
        }
    }

    /// Returns the rows of a scattered measurement, or `None` for tables and networks.
    pub fn samples(&self) -> Option<&SampleSet> {
        match self {
            Self::Samples(scattered) => Some(scattered.samples()),
            _ => None,
        }
    }

    /// Returns the channels that were measured, RGB or one.
    pub fn channels(&self) -> Channels {
        self.samples().map_or(Channels::Rgb, SampleSet::channels)
    }
}

/// A measured material, the format it came in, and what the reader had to assume.
#[derive(Debug)]
pub struct Measurement {
    /// The format.
    pub format: Format,
    /// The material.
    pub measured: Measured,
    /// Facts that were assumed, chosen or changed.
    pub notes: Vec<ReadNote>,
    /// Length of the file, in bytes.
    pub bytes: usize,
}

/// Reads a measured material from the bytes of a file, in whichever format [`detect`] finds.
///
/// ```
/// use brdf_io::{Format, ReadOptions, read};
///
/// let table = "theta_i_deg,phi_i_deg,theta_o_deg,phi_o_deg,r,g,b\n30,0,30,180,0.5,0.4,0.3\n";
/// let measurement = read(table.as_bytes(), &ReadOptions::default())?;
/// assert_eq!(measurement.format, Format::Table);
/// assert_eq!(measurement.measured.samples().expect("rows").len(), 1);
/// # Ok::<(), brdf_io::FormatError>(())
/// ```
///
/// # Errors
///
/// [`FormatError`]: the place in the file, what was found and what was expected.
pub fn read(bytes: &[u8], options: &ReadOptions) -> Result<Measurement, FormatError> {
    let format = detect(bytes)?;
    let mut notes = Vec::new();
    let measured = read_as(format, bytes, options, &mut notes)?;
    Ok(Measurement { format, measured, notes, bytes: bytes.len() })
}

#[cfg_attr(
    not(all(feature = "nbrdf", feature = "merl", feature = "table")),
    allow(
        unused_variables,
        unreachable_code,
        clippy::ptr_arg,
        reason = "each reader takes what it needs"
    )
)]
fn read_as(
    format: Format,
    bytes: &[u8],
    options: &ReadOptions,
    notes: &mut Vec<ReadNote>,
) -> Result<Measured, FormatError> {
    Ok(match format {
        #[cfg(feature = "merl")]
        Format::Merl => Measured::Merl(crate::read_merl(bytes, options.merl_lookup)?),
        #[cfg(feature = "rgl")]
        Format::Rgl => Measured::Rgl(Box::new(crate::read_rgl(bytes)?)),
        #[cfg(feature = "utia")]
        Format::Utia => Measured::Utia(crate::read_utia(bytes)?),
        #[cfg(feature = "nbrdf")]
        Format::Nbrdf => {
            let network = crate::read_nbrdf(bytes, options.material.as_deref())?;
            notes.push(ReadNote::NeuralProxy);
            Measured::Nbrdf(Box::new(network))
        }
        #[cfg(feature = "cornell")]
        Format::Cornell => {
            let spectra = crate::read_cornell(&decode(bytes)?)?;
            let (first, last) = (spectra.wavelengths[0], spectra.wavelengths.last().copied());
            notes.push(ReadNote::Spectra {
                wavelengths: spectra.wavelengths.len(),
                range_nm: [first, last.unwrap_or(first)],
            });
            if spectra.moved_into_gamut > 0 {
                let (moved, colours) = (spectra.moved_into_gamut, spectra.samples.len());
                notes.push(ReadNote::MovedIntoGamut { moved, colours });
            }
            scattered(spectra.samples)?
        }
        #[cfg(feature = "alta")]
        Format::Alta => {
            let (samples, said) = crate::read_alta(&decode(bytes)?)?;
            notes.extend(said);
            scattered(samples)?
        }
        #[cfg(feature = "table")]
        Format::Table => {
            let (samples, said) = crate::read_table(&decode(bytes)?, &options.table)?;
            notes.extend(said);
            scattered(samples)?
        }
        #[allow(unreachable_patterns, reason = "with all features there is a reader of each")]
        other => {
            return Err(FormatError::Missing {
                what: format!("reader of this format: {}", other.name()),
                expected: "brdf-io built with its feature".to_owned(),
            });
        }
    })
}

#[cfg(any(feature = "cornell", feature = "alta", feature = "table"))]
fn scattered(samples: SampleSet) -> Result<Measured, FormatError> {
    if samples.is_empty() {
        return Err(FormatError::Missing {
            what: format!("usable samples ({})", samples.dropped()),
            expected: "at least one row above the horizon with values of 0 or more".to_owned(),
        });
    }
    Ok(Measured::Samples(Box::new(ScatteredBrdf::new(samples))))
}
