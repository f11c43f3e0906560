//! Recognizing formats by what is in a file.

use serde::{Deserialize, Serialize};

use crate::table::looks_like_table;
use crate::{FormatError, merl, rgl, utia};

/// The formats that can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
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
    /// A container that this project wrote.
    Native,
}

impl Format {
    /// What people call it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Merl => "MERL binary",
            Self::Rgl => "RGL tensor file",
            Self::Cornell => "Cornell spectra",
            Self::Utia => "UTIA binary",
            Self::Alta => "ALTA text",
            Self::Table => "table of samples",
            Self::Nbrdf => "NBRDF archive",
            Self::Native => "brdf container",
        }
    }
}

/// The format of a file's content.
///
/// # Errors
///
/// [`FormatError::Unknown`].
pub fn detect(bytes: &[u8]) -> Result<Format, FormatError> {
    if bytes.starts_with(rgl::MAGIC) {
        return Ok(Format::Rgl);
    }
    if bytes.starts_with(b"PK\x03\x04") {
        return Ok(Format::Nbrdf);
    }
    if merl::looks_like_merl(bytes) {
        return Ok(Format::Merl);
    }
    if is_safetensors(bytes) {
        return Ok(Format::Native);
    }
    if bytes.len() == utia::FILE_LENGTH {
        return Ok(Format::Utia);
    }
    let unknown = || FormatError::Unknown { start: printable(bytes) };
    let text = leading_text(bytes).ok_or_else(unknown)?;
    if text.lines().any(|line| ["#DIM", "#PARAM_IN", "#FORMAT"].iter().any(|k| line.starts_with(k)))
    {
        return Ok(Format::Alta);
    }
    let first = text.lines().map(str::trim).find(|line| !line.is_empty() && !line.starts_with('#'));
    match first {
        // The number of wavelengths stands alone on its line.
        Some(line) if line.parse::<u32>().is_ok() => Ok(Format::Cornell),
        Some(_) if looks_like_table(text) => Ok(Format::Table),
        _ => Err(unknown()),
    }
}

/// A header length that fits, then the start of a JSON object.
fn is_safetensors(bytes: &[u8]) -> bool {
    let Some((length, rest)) = bytes.split_first_chunk::<8>() else { return false };
    // One that was cut short still starts as it should.
    rest.starts_with(b"{\"")
        || rest.first() == Some(&b'{') && u64::from_le_bytes(*length) <= rest.len() as u64
}

/// The longest valid text within the first 16 KiB, if there is any and it is not binary.
fn leading_text(bytes: &[u8]) -> Option<&str> {
    let head = &bytes[..bytes.len().min(16 << 10)];
    let text = match std::str::from_utf8(head) {
        Ok(text) => text,
        // A character may be cut at the end.
        Err(error) if error.error_len().is_none() || error.valid_up_to() > head.len() / 2 => {
            std::str::from_utf8(&head[..error.valid_up_to()]).ok()?
        }
        Err(_) => return None,
    };
    (!text.is_empty() && !text.contains('\0')).then_some(text)
}

fn printable(bytes: &[u8]) -> String {
    if bytes.is_empty() {
        return "nothing: the file is empty".to_owned();
    }
    format!("\"{}\"", bytes[..bytes.len().min(12)].escape_ascii())
}
