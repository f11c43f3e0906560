//! NumPy archives (`.npz`) of neural BRDFs: one array of 675 weights, f32, for each material.

use std::io::{Cursor, Read as _};

use brdf_model::Nbrdf;
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

/// Reads one material of an archive of neural BRDFs. No name is needed where the archive holds a single one, as one array
/// of all weights or as the six arrays of its layers.
///
/// # Errors
///
/// [`FormatError::Missing`] for a name that is not there, or that is needed;
/// [`FormatError::Library`] and [`FormatError::Model`] for an entry that holds no such network.
pub fn read_nbrdf(bytes: &[u8], material: Option<&str>) -> Result<Nbrdf, FormatError> {
    let names = nbrdf_names(bytes)?;
    if names.is_empty() {
        return Err(not_networks(bytes)?);
    }
    if are_layers(&names) && material.is_none() {
        let mut archive = open(bytes)?;
        let mut weights = Vec::with_capacity(Nbrdf::WEIGHTS);
        for (layer, shape) in LAYERS {
            weights.extend(array(&mut archive, layer, shape)?);
        }
        return Ok(Nbrdf::new(&weights)?);
    }
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
    let shape = format!("({},)", Nbrdf::WEIGHTS);
    Ok(Nbrdf::new(&array(&mut archive, name, &shape)?)?)
}

/// What an archive is that holds no array.
fn not_networks(bytes: &[u8]) -> Result<FormatError, FormatError> {
    let archive = open(bytes)?;
    let first = archive.file_names().min().map_or_else(
        || "nothing".to_owned(),
        |name| if archive.len() > 1 { format!("{} and more", quoted(name)) } else { quoted(name) },
    );
    let what = format!("an archive with {first}, not one of networks (.npz)");
    Ok(FormatError::Foreign { what, advice: "unpack it, or name it to `brdf btf` if it is a BTF" })
}

/// Layers of one network, as Keras has them: a matrix `[input, output]` and biases each, with their shapes.
const LAYERS: [(&str, &str); 6] = [
    ("fc1", "(6,21)"),
    ("b1", "(21,)"),
    ("fc2", "(21,21)"),
    ("b2", "(21,)"),
    ("fc3", "(21,3)"),
    ("b3", "(3,)"),
];

fn are_layers(names: &[String]) -> bool {
    names.len() == LAYERS.len()
        && LAYERS.iter().all(|(layer, _)| names.iter().any(|name| name == layer))
}

/// The numbers of one array of an archive.
fn array(
    archive: &mut ZipArchive<Cursor<&[u8]>>,
    name: &str,
    shape: &str,
) -> Result<Vec<f32>, FormatError> {
    let mut content = Vec::new();
    archive
        .by_name(&format!("{name}.npy"))
        .map_err(|e| library(&e))?
        .take(LONGEST_ENTRY)
        .read_to_end(&mut content)
        .map_err(|e| library(&e))?;
    numbers(&content, shape)
}

/// The numbers of an array file (NumPy enhancement proposal 1, format version 1): the magic word, the length of a
/// header in two bytes, the header (a Python dictionary with the type and the shape), the values.
fn numbers(content: &[u8], shape: &str) -> Result<Vec<f32>, FormatError> {
    let refused =
        |problem: &str| FormatError::Library { what: "NumPy array", problem: problem.to_owned() };
    let rest = content
        .strip_prefix(b"\x93NUMPY\x01\0")
        .ok_or_else(|| refused("not a NumPy array of format version 1"))?;
    let header = rest
        .split_first_chunk::<2>()
        .and_then(|(length, rest)| rest.split_at_checked(u16::from_le_bytes(*length).into()));
    let (header, values) = header.ok_or_else(|| refused("its header runs past its end"))?;
    let header = String::from_utf8_lossy(header);
    let words: String = header.chars().filter(|c| !c.is_whitespace()).collect();
    let has = |entry: &str| words.contains(entry);
    if !has("'descr':'<f4'") || !has("'fortran_order':False") || !has(&format!("'shape':{shape}")) {
        return Err(FormatError::Missing {
            what: format!("array of weights: its header is {}", quoted(header.trim())),
            expected: format!("descr '<f4', rows first, and shape {shape}"),
        });
    }
    let sides = shape.trim_matches(|c| matches!(c, '(' | ')')).split(',');
    let expected = 4 * sides.filter_map(|side| side.parse::<usize>().ok()).product::<usize>();
    if values.len() != expected {
        let hint = " of weights";
        return Err(FormatError::Size { found: values.len(), expected, hint });
    }
    Ok(values.as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect())
}

fn open(bytes: &[u8]) -> Result<ZipArchive<Cursor<&[u8]>>, FormatError> {
    ZipArchive::new(Cursor::new(bytes)).map_err(|e| library(&e))
}

fn library(error: &dyn std::fmt::Display) -> FormatError {
    FormatError::Library { what: "archive of neural BRDFs", problem: error.to_string() }
}
