//! Measured materials, whatever file they come in.

use std::path::Path;

use brdf_model::{
    Brdf, MerlLookup, MerlNodes, MerlTable, Nbrdf, RglBrdf, SampleSet, ScatteredBrdf, UtiaTable,
};

use crate::{
    ColumnMap, Contained, Format, FormatError, IoError, MappedFile, ModelFile, SeparableFile,
    detect, read_alta, read_container, read_cornell, read_merl, read_nbrdf, read_rgl, read_table,
    read_utia,
};

/// What the content alone does not say.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadOptions {
    /// How MERL tables are read.
    pub merl_lookup: MerlLookup,
    /// What the columns of a table mean.
    pub columns: Option<ColumnMap>,
    /// Which wavelength of a table to take, micrometres.
    pub wavelength_um: Option<f64>,
    /// Which material of an archive to take.
    pub material: Option<String>,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self {
            merl_lookup: MerlLookup::Trilinear(MerlNodes::Centre),
            columns: None,
            wavelength_um: None,
            material: None,
        }
    }
}

/// A material as a file holds it.
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
    /// A model that this project fitted.
    Model(Box<ModelFile>),
    /// A sum of products that this project made.
    Separable(Box<SeparableFile>),
}

impl Measured {
    /// The material as a function; scattered samples are interpolated, which is for pictures only.
    pub fn brdf(&self) -> &dyn Brdf {
        match self {
            Self::Merl(table) => table,
            Self::Rgl(material) => material.as_ref(),
            Self::Utia(table) => table,
            Self::Nbrdf(network) => network.as_ref(),
            Self::Samples(samples) => samples.as_ref(),
            Self::Model(file) => &file.model,
            Self::Separable(file) => &file.model,
        }
    }
}

/// A material, the format it came in, and what the reader had to assume.
#[derive(Debug)]
pub struct Measurement {
    /// The format.
    pub format: Format,
    /// The material.
    pub measured: Measured,
    /// What was assumed, chosen or changed, one sentence each.
    pub notes: Vec<String>,
    /// Length of the file.
    pub bytes: usize,
}

/// Opens a file of any format.
///
/// # Errors
///
/// [`IoError`], naming the file, the place in it, what was found and what was expected.
pub fn open_measurement(path: &Path, options: &ReadOptions) -> Result<Measurement, IoError> {
    let bytes = MappedFile::open(path)?;
    parse_measurement(&bytes, options).map_err(IoError::format(path))
}

/// Reads a material from the bytes of a file.
///
/// # Errors
///
/// [`FormatError`].
pub fn parse_measurement(bytes: &[u8], options: &ReadOptions) -> Result<Measurement, FormatError> {
    let format = detect(bytes)?;
    let mut notes = Vec::new();
    let measured = match format {
        Format::Merl => Measured::Merl(read_merl(bytes, options.merl_lookup)?),
        Format::Rgl => Measured::Rgl(Box::new(read_rgl(bytes)?)),
        Format::Utia => Measured::Utia(read_utia(bytes)?),
        Format::Nbrdf => {
            let network = read_nbrdf(bytes, options.material.as_deref())?;
            notes.push("an NBRDF proxy: a network's smooth fit, not the measurement".to_owned());
            Measured::Nbrdf(Box::new(network))
        }
        Format::Native => match read_container(bytes, options.merl_lookup)? {
            Contained::Model(file) => Measured::Model(file),
            Contained::Separable(file) => Measured::Separable(file),
            Contained::Table(table) => Measured::Merl(table),
            Contained::Samples(samples) => scattered(samples)?,
        },
        Format::Cornell => {
            let spectra = read_cornell(text(bytes)?)?;
            let (first, last) = (spectra.wavelengths[0], spectra.wavelengths.last().copied());
            notes.push(format!(
                "{} wavelengths from {first} to {} nm became linear RGB (CIE 1931 2°, D65)",
                spectra.wavelengths.len(),
                last.unwrap_or(first)
            ));
            if spectra.moved_into_gamut > 0 {
                notes.push(format!(
                    "{} of {} colours lay outside the gamut of Rec. 709 or within 1 % of its rim; \
                     they were moved towards grey of the same luminance",
                    spectra.moved_into_gamut,
                    spectra.samples.len()
                ));
            }
            scattered(spectra.samples)?
        }
        Format::Alta => {
            let (samples, said) = read_alta(text(bytes)?)?;
            notes.extend(said);
            scattered(samples)?
        }
        Format::Table => {
            let (samples, said) =
                read_table(text(bytes)?, options.columns.as_ref(), options.wavelength_um)?;
            notes.extend(said);
            scattered(samples)?
        }
    };
    Ok(Measurement { format, measured, notes, bytes: bytes.len() })
}

fn scattered(samples: SampleSet) -> Result<Measured, FormatError> {
    if samples.is_empty() {
        return Err(FormatError::Missing {
            what: format!("usable samples ({})", samples.dropped()),
            expected: "at least one row above the horizon with values of 0 or more".to_owned(),
        });
    }
    Ok(Measured::Samples(Box::new(ScatteredBrdf::new(samples))))
}

fn text(bytes: &[u8]) -> Result<&str, FormatError> {
    std::str::from_utf8(bytes).map_err(|error| FormatError::Field {
        offset: error.valid_up_to(),
        what: "the text",
        found: "a byte that is not UTF-8".to_owned(),
        expected: "plain text".to_owned(),
    })
}
