//! Recognizing formats by what is in a file.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};

use crate::FormatError;
use crate::foreign::foreign;
use crate::text::decode;

/// The file formats that [`detect`] knows, whether or not their readers are built in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Format {
    /// MERL `.binary`.
    Merl,
    /// RGL `.bsdf` tensor file.
    Rgl,
    /// Cornell `.brdf` spectra, as pbrt-v2 distributes them.
    Cornell,
    /// UTIA `.bin`.
    Utia,
    /// ALTA text.
    Alta,
    /// A table of numbers with a header.
    Table,
    /// NumPy archive of neural BRDFs.
    Nbrdf,
}

impl Format {
    /// Returns the name that people know the format by, for example "MERL binary".
    pub fn name(self) -> &'static str {
        match self {
            Self::Merl => "MERL binary",
            Self::Rgl => "RGL tensor file",
            Self::Cornell => "Cornell spectra",
            Self::Utia => "UTIA binary",
            Self::Alta => "ALTA text",
            Self::Table => "table of samples",
            Self::Nbrdf => "NBRDF archive",
        }
    }
}

/// Returns the format of a file's content. The file's name plays no part.
///
/// ```
/// use brdf_io::{Format, detect};
///
/// assert_eq!(detect(b"tensor_file\0\x01\x00")?, Format::Rgl);
/// assert!(detect(b"").is_err());
/// # Ok::<(), brdf_io::FormatError>(())
/// ```
///
/// # Errors
///
/// [`FormatError::Unknown`].
pub fn detect(bytes: &[u8]) -> Result<Format, FormatError> {
    if bytes.starts_with(RGL_MAGIC) {
        return Ok(Format::Rgl);
    }
    if bytes.starts_with(b"PK\x03\x04") {
        return Ok(Format::Nbrdf);
    }
    if looks_like_merl(bytes) {
        return Ok(Format::Merl);
    }
    if bytes.len() == UTIA_LENGTH {
        return Ok(Format::Utia);
    }
    let unknown = || FormatError::Unknown { start: printable(bytes) };
    let text = leading_text(bytes);
    if let Some(foreign) = foreign(bytes, text.as_deref()) {
        return Err(foreign);
    }
    let text = text.ok_or_else(unknown)?;
    if text.lines().any(|line| ["#DIM", "#PARAM_IN", "#FORMAT"].iter().any(|k| line.starts_with(k)))
    {
        return Ok(Format::Alta);
    }
    let first = text.lines().map(str::trim).find(|line| !line.is_empty() && !line.starts_with('#'));
    match first {
        // The number of wavelengths stands alone on its line.
        Some(line) if line.parse::<u32>().is_ok() => Ok(Format::Cornell),
        Some(_) if has_header(&text) => Ok(Format::Table),
        _ => Err(unknown()),
    }
}

/// How RGL tensor files begin.
pub(crate) const RGL_MAGIC: &[u8] = b"tensor_file\0";
/// Length of every UTIA file: three planes of 288 × 288 doubles.
pub(crate) const UTIA_LENGTH: usize = 3 * 8 * 288 * 288;
/// theta_h, theta_d and phi_d of the MERL grid.
pub(crate) const MERL_DIMENSIONS: [u32; 3] = [90, 90, 180];
/// Length of every MERL file: three numbers, three planes of doubles.
pub(crate) const MERL_LENGTH: usize = 12 + 3 * 8 * 90 * 90 * 180;

/// Two of the three dimensions are there, or the length is right and the dimensions are damaged: either
/// way the reader has something useful to say.
fn looks_like_merl(bytes: &[u8]) -> bool {
    let found = bytes.as_chunks::<4>().0.iter().map(|chunk| u32::from_le_bytes(*chunk));
    let right = found.zip(MERL_DIMENSIONS).filter(|(found, wanted)| found == wanted).count();
    right >= 2 || bytes.len() == MERL_LENGTH
}

#[cfg(feature = "table")]
fn has_header(text: &str) -> bool {
    crate::table::looks_like_table(text)
}

/// Without the reader, whatever has rows of numbers.
#[cfg(not(feature = "table"))]
fn has_header(text: &str) -> bool {
    text.lines().any(|line| line.split([',', ' ', '\t']).all(|field| field.parse::<f64>().is_ok()))
}

/// The text at the start of a file, if it is one.
fn leading_text(bytes: &[u8]) -> Option<Cow<'_, str>> {
    // A character may be cut at the end, which makes it Latin-1: no matter for what is looked for.
    let text = decode(&bytes[..bytes.len().min(16 << 10)]).ok()?;
    (!text.is_empty()).then_some(text)
}

fn printable(bytes: &[u8]) -> String {
    if bytes.is_empty() {
        return "nothing: the file is empty".to_owned();
    }
    format!("\"{}\"", bytes[..bytes.len().min(12)].escape_ascii())
}
