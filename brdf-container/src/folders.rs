//! Folders of materials, matched by name.

use std::path::{Path, PathBuf};

use brdf_files::FileError;

/// References and the models of the same name.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MatchedFolders {
    /// Name, reference, and a model of each folder, in alphabetical order.
    pub materials: Vec<(String, PathBuf, Vec<PathBuf>)>,
    /// References without a model in a folder, and models without a reference, with the reason.
    pub unmatched: Vec<String>,
    /// References in all.
    pub references: usize,
}

/// Returns the references of a folder with the models of the same name (`NAME.*` or `NAME/model.safetensors`) in each of
/// several others.
///
/// # Errors
///
/// [`FileError::File`] for a folder that cannot be read.
pub fn match_folders(references: &Path, models: &[&Path]) -> Result<MatchedFolders, FileError> {
    let references = materials_in(references)?;
    let folders: Vec<Vec<(String, PathBuf)>> =
        models.iter().map(|folder| materials_in(folder)).collect::<Result<_, _>>()?;
    let mut matched = MatchedFolders { references: references.len(), ..Default::default() };
    for (name, reference) in &references {
        let found: Option<Vec<PathBuf>> = folders
            .iter()
            .map(|folder| {
                let entry = folder.iter().find(|(other, _)| other == name);
                entry.map(|(_, path)| path.clone())
            })
            .collect();
        match found {
            Some(models) => matched.materials.push((name.clone(), reference.clone(), models)),
            None => matched.unmatched.push(format!("{}: no model", reference.display())),
        }
    }
    for (name, path) in folders.iter().flatten() {
        if !references.iter().any(|(other, _)| other == name) {
            matched.unmatched.push(format!("{}: no reference", path.display()));
        }
    }
    Ok(matched)
}

/// Returns names and files of the materials in a folder, in alphabetical order: plain files by their stem, folders of
/// results by the model in them.
///
/// # Errors
///
/// [`FileError::File`] for a folder that cannot be read.
fn materials_in(folder: &Path) -> Result<Vec<(String, PathBuf)>, FileError> {
    let refused = || FileError::file(folder, "looking into");
    let entries = std::fs::read_dir(folder).map_err(refused())?;
    let mut found = Vec::new();
    for entry in entries {
        let path = entry.map_err(refused())?.path();
        let model = path.join("model.safetensors");
        let name = |part: Option<&std::ffi::OsStr>| part.map(|n| n.to_string_lossy().into_owned());
        if model.is_file() {
            found.extend(name(path.file_name()).map(|name| (name, model)));
        } else if path.is_file() {
            found.extend(name(path.file_stem()).map(|name| (name, path.clone())));
        }
    }
    found.sort();
    Ok(found)
}
