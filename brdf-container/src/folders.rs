//! Folders of materials, matched by name and compared.

use std::path::{Path, PathBuf};

use brdf_files::FileError;
use brdf_fit::{Comparison, Distribution, FolderComparison};

/// Folders that cannot be compared.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FolderError {
    /// A folder that cannot be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// A file among the folders.
    #[error("{name}: not a folder; the reference is one, so every model must be")]
    NotAFolder {
        /// What was given.
        name: String,
    },
    /// No material is in all of them.
    #[error(
        "{folder}: none of {references} references has a model of the same name in every folder"
    )]
    NoneMatched {
        /// The folder of references.
        folder: String,
        /// Number of references.
        references: usize,
    },
}

/// Compares the models of several folders with the references of the same name (`NAME.*` or `NAME/model.safetensors`),
/// each group by `compare`, which gets the reference and a model of each folder.
///
/// # Errors
///
/// [`FolderError`]; what `compare` says.
pub fn compare_folders<E: From<FolderError>>(
    references: &str,
    models: &[String],
    mut compare: impl FnMut(&str, &[String]) -> Result<Comparison, E>,
) -> Result<FolderComparison, E> {
    if let Some(name) = models.iter().find(|folder| !Path::new(folder).is_dir()) {
        return Err(FolderError::NotAFolder { name: name.clone() }.into());
    }
    let folders: Vec<&Path> = models.iter().map(Path::new).collect();
    let matched = match_folders(Path::new(references), &folders).map_err(FolderError::from)?;
    if matched.materials.is_empty() {
        let (folder, references) = (references.to_owned(), matched.references);
        return Err(FolderError::NoneMatched { folder, references }.into());
    }
    let text = |path: &PathBuf| path.to_string_lossy().into_owned();
    let mut materials = Vec::new();
    for (name, reference, models) in &matched.materials {
        let models: Vec<String> = models.iter().map(text).collect();
        let comparison = compare(&text(reference), &models)?;
        materials.push(Comparison { reference: name.clone(), ..comparison });
    }
    let of = |(index, folder): (usize, &String)| Distribution::of(folder, index, &materials);
    let distributions = models.iter().enumerate().map(of).collect();
    let unmatched = matched.unmatched;
    Ok(FolderComparison { reference: references.to_owned(), distributions, materials, unmatched })
}

/// References and the models of the same name.
#[derive(Default)]
struct MatchedFolders {
    /// Name, reference, and a model of each folder, in alphabetical order.
    materials: Vec<(String, PathBuf, Vec<PathBuf>)>,
    /// References without a model in a folder, and models without a reference, with the reason.
    unmatched: Vec<String>,
    /// References in all.
    references: usize,
}

fn match_folders(references: &Path, models: &[&Path]) -> Result<MatchedFolders, FileError> {
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
