//! Files of a folder of results, before they are written.

use serde::Serialize;

/// A file of a folder of results: its name within the folder, and its bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ResultFile {
    /// Name within the folder.
    pub name: String,
    /// What is in it.
    pub bytes: Vec<u8>,
}

impl ResultFile {
    /// Returns a file.
    pub fn new(name: impl Into<String>, bytes: Vec<u8>) -> Self {
        Self { name: name.into(), bytes }
    }

    /// Returns a record as indented JSON, as commands print it.
    ///
    /// # Errors
    ///
    /// [`serde_json::Error`] for a record that is no JSON.
    pub fn json(
        name: impl Into<String>,
        record: &impl Serialize,
    ) -> Result<Self, serde_json::Error> {
        Ok(Self::new(name, serde_json::to_string_pretty(record)?.into_bytes()))
    }
}

/// Returns a record as indented JSON with its keys in alphabetical order, and a line feed at its end.
///
/// # Errors
///
/// [`serde_json::Error`] for a record that is no JSON.
pub fn sorted_json(record: &impl Serialize) -> Result<String, serde_json::Error> {
    // Values keep their keys sorted; structs, in the order of their fields.
    let mut json = serde_json::to_string_pretty(&serde_json::to_value(record)?)?;
    json.push('\n');
    Ok(json)
}
