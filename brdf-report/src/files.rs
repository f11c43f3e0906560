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
