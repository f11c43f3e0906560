//! NumPy archives (`.npz`) of neural BRDFs: one array of 675 weights, f32, for each material.

use std::io::{Cursor, Read as _};

use brdf_model::Nbrdf;
use npyz::{NpyFile, TypeChar};
use zip::ZipArchive;

use crate::error::{FormatError, quoted};

/// Longest entry that is read: an array of weights and its header take under 3 kB.
const LONGEST_ENTRY: u64 = 16 << 10;
/// Most names that a message lists.
const LISTED: usize = 12;

/// Returns the names of the materials in an archive, in alphabetical order.
///
/// # Errors
///
/// [`FormatError::Library`] for what is no archive.
pub fn nbrdf_names(bytes: &[u8]) -> Result<Vec<String>, FormatError> {
    let archive = open(bytes)?;
    let mut names: Vec<String> = archive
        .file_names()
        .filter_map(|name| name.strip_suffix(".npy"))
        .map(str::to_owned)
        .collect();
    names.sort_unstable();
    Ok(names)
}

/// Reads one material of an archive of neural BRDFs. No name is needed where the archive holds a single one.
///
/// # Errors
///
/// [`FormatError::Missing`] for a name that is not there, or that is needed;
/// [`FormatError::Library`] and [`FormatError::Model`] for an entry that holds no such network.
pub fn read_nbrdf(bytes: &[u8], material: Option<&str>) -> Result<Nbrdf, FormatError> {
    let names = nbrdf_names(bytes)?;
    let name = match (material, &names[..]) {
        (Some(name), _) if names.iter().any(|known| known == name) => name,
        (None, [only]) => only,
        _ => {
            let listed = names.iter().take(LISTED).cloned().collect::<Vec<_>>().join(", ");
            let more = names.len().saturating_sub(LISTED);
            let rest = if more > 0 { format!(" and {more} more") } else { String::new() };
            let what = material.map_or_else(
                || "material named, of an archive that holds several".to_owned(),
                |name| format!("material {} in the archive", quoted(name)),
            );
            return Err(FormatError::Missing {
                what,
                expected: format!("FILE.npz:NAME with one of {listed}{rest}"),
            });
        }
    };
    let mut archive = open(bytes)?;
    let mut content = Vec::new();
    archive
        .by_name(&format!("{name}.npy"))
        .map_err(|e| library(&e))?
        .take(LONGEST_ENTRY)
        .read_to_end(&mut content)
        .map_err(|e| library(&e))?;
    weights(&content)
}

fn weights(content: &[u8]) -> Result<Nbrdf, FormatError> {
    // Version 1 has headers of at most 64 KiB; later ones could claim gigabytes.
    if !content.starts_with(b"\x93NUMPY\x01") {
        return Err(FormatError::Library {
            what: "NumPy array",
            problem: "not a NumPy array of format version 1".to_owned(),
        });
    }
    let array = NpyFile::new(content).map_err(|e| library(&e))?;
    let is_f32 = matches!(array.dtype(), npyz::DType::Plain(kind)
        if kind.type_char() == TypeChar::Float && kind.size_field() == 4);
    if array.shape() != [Nbrdf::WEIGHTS as u64] || !is_f32 {
        return Err(FormatError::Missing {
            what: format!(
                "array of weights (shape {:?}, {})",
                array.shape(),
                array.dtype().descr()
            ),
            expected: format!("shape [{}] of 32-bit floats", Nbrdf::WEIGHTS),
        });
    }
    let weights: Vec<f32> = array.into_vec().map_err(|e| library(&e))?;
    Ok(Nbrdf::new(&weights)?)
}

fn open(bytes: &[u8]) -> Result<ZipArchive<Cursor<&[u8]>>, FormatError> {
    ZipArchive::new(Cursor::new(bytes)).map_err(|e| library(&e))
}

fn library(error: &dyn std::fmt::Display) -> FormatError {
    FormatError::Library { what: "archive of neural BRDFs", problem: error.to_string() }
}
