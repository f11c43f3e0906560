//! Folders of results that appear whole or not at all.

use std::fs;
use std::path::{Path, PathBuf};

use tempfile::TempDir;

use crate::FileError;
use crate::atomic::{make_readable, parent};

/// The name of the file by which a folder of ours is recognized, and how that file starts.
const MARK: (&str, &str) = ("report.json", "{\n  \"brdf\":");

/// Files of every folder of ours; textures have numbers.
const OUR_NAMES: [&str; 12] = [
    "contradictions.png",
    "coverage.png",
    "errors.svg",
    "material.safetensors",
    "model.safetensors",
    "sphere.png",
    "spheres.png",
    "spectrum.svg",
    "strip.png",
    "study.csv",
    "report.html",
    "report.json",
];

/// A folder of results under construction, beside the place where it will appear.
///
/// ```
/// let parent = tempfile::tempdir()?;
/// let place = parent.path().join("results");
/// let mut folder = brdf_files::OutputFolder::new(&place, false)?;
/// folder.write("report.json", b"{\n  \"brdf\": 1\n}")?;
/// assert!(!place.exists(), "not before it is whole");
/// folder.finish()?;
/// assert!(place.join("report.json").exists());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct OutputFolder {
    place: PathBuf,
    temporary: TempDir,
    names: Vec<String>,
    foreign: Vec<PathBuf>,
}

impl OutputFolder {
    /// Starts a folder. Nothing changes at `place` until [`OutputFolder::finish`].
    ///
    /// # Errors
    ///
    /// [`FileError::InTheWay`] if `place` holds something that this project did not write, unless
    /// `force`d; [`FileError::File`] if it cannot be written to.
    pub fn new(place: &Path, force: bool) -> Result<Self, FileError> {
        let mut foreign = Vec::new();
        if let Ok(metadata) = fs::symlink_metadata(place) {
            if !metadata.is_dir() {
                return Err(FileError::NotAFolder { path: place.to_owned() });
            }
            if place
                .canonicalize()
                .is_ok_and(|full| std::env::current_dir().is_ok_and(|d| d == full))
            {
                return Err(FileError::CurrentFolder { path: place.to_owned() });
            }
            foreign = foreign_entries(place)?;
            if !foreign.is_empty() && !force {
                return Err(FileError::InTheWay { path: place.to_owned(), found: "files" });
            }
        }
        let temporary = tempfile::Builder::new()
            .prefix(".brdf-")
            .suffix(".partial")
            .tempdir_in(parent(place))
            .map_err(FileError::file(place, "creating"))?;
        Ok(Self { place: place.to_owned(), temporary, names: Vec::new(), foreign })
    }

    /// Writes a file into the folder.
    ///
    /// # Errors
    ///
    /// [`FileError::File`].
    pub fn write(&mut self, name: &str, bytes: &[u8]) -> Result<(), FileError> {
        let path = self.temporary.path().join(name);
        fs::write(&path, bytes).map_err(FileError::file(&self.place.join(name), "writing"))?;
        self.names.push(name.to_owned());
        Ok(())
    }

    /// Creates a folder within the folder and returns its path, which is valid until [`OutputFolder::finish`].
    ///
    /// # Errors
    ///
    /// [`FileError::File`].
    pub fn create_folder(&mut self, name: &str) -> Result<PathBuf, FileError> {
        let path = self.temporary.path().join(name);
        fs::create_dir(&path).map_err(FileError::file(&self.place.join(name), "creating"))?;
        self.names.push(name.to_owned());
        Ok(path)
    }

    /// Checks that the disk has room for `needed` more bytes.
    ///
    /// # Errors
    ///
    /// [`FileError::DiskFull`] if it has not. A file system that does not tell is taken to have room.
    pub fn check_space(&self, needed: u64) -> Result<(), FileError> {
        match fs4::available_space(self.temporary.path()) {
            Ok(available) if available < needed => {
                Err(FileError::DiskFull { path: self.place.clone(), needed, available })
            }
            _ => Ok(()),
        }
    }

    /// Returns the place where the folder will be.
    pub fn place(&self) -> &Path {
        &self.place
    }

    /// Moves the folder to its place and returns that place.
    ///
    /// A folder of ours that stood there is replaced; files that we did not write stay, unless one of ours has the
    /// same name.
    ///
    /// # Errors
    ///
    /// [`FileError::File`].
    pub fn finish(self) -> Result<PathBuf, FileError> {
        let place = &self.place;
        let refused = |action| FileError::file(place, action);
        make_readable(self.temporary.path()).map_err(refused("finishing"))?;
        if !place.exists() {
            fs::rename(self.temporary.path(), place).map_err(refused("renaming to"))?;
        } else if self.foreign.is_empty() {
            let old = parent(place).join(format!(".brdf-old-{}", std::process::id()));
            fs::rename(place, &old).map_err(refused("moving away"))?;
            if let Err(error) = fs::rename(self.temporary.path(), place) {
                fs::rename(&old, place).map_err(refused("putting back"))?;
                return Err(refused("renaming to")(error));
            }
            fs::remove_dir_all(&old).map_err(refused("removing the old"))?;
        } else {
            for stale in our_entries(place)? {
                let removed = if stale.is_dir() {
                    fs::remove_dir_all(&stale)
                } else {
                    fs::remove_file(&stale)
                };
                removed.map_err(refused("removing the old"))?;
            }
            for name in &self.names {
                // A folder cannot be renamed onto another; the old one goes with the temporary.
                let old = place.join(name);
                if old.is_dir() {
                    let aside = self.temporary.path().join(format!("{name}.old"));
                    fs::rename(&old, aside).map_err(refused("moving away"))?;
                }
                fs::rename(self.temporary.path().join(name), place.join(name))
                    .map_err(refused("renaming into"))?;
            }
        }
        Ok(self.place)
    }
}

/// Entries of a folder that we did not write: all of them unless our mark is there.
fn foreign_entries(folder: &Path) -> Result<Vec<PathBuf>, FileError> {
    entries(folder).map(|(_, foreign)| foreign)
}

/// Entries of a folder that an earlier run of ours left.
fn our_entries(folder: &Path) -> Result<Vec<PathBuf>, FileError> {
    entries(folder).map(|(ours, _)| ours)
}

/// Ours, then foreign ones.
fn entries(folder: &Path) -> Result<(Vec<PathBuf>, Vec<PathBuf>), FileError> {
    let refused = || FileError::file(folder, "looking into");
    let marked = fs::read_to_string(folder.join(MARK.0)).is_ok_and(|t| t.starts_with(MARK.1));
    let all: Result<Vec<PathBuf>, _> =
        fs::read_dir(folder).map_err(refused())?.map(|entry| entry.map(|e| e.path())).collect();
    let all = all.map_err(refused())?;
    Ok(all.into_iter().partition(|path| marked && is_ours_in_folder(path)))
}

/// A file with a name of ours, or a view of a BTF that holds nothing but its images.
fn is_ours_in_folder(path: &Path) -> bool {
    let is_folder = fs::symlink_metadata(path).is_ok_and(|metadata| metadata.is_dir());
    if !is_folder {
        return is_our_name(path);
    }
    let mut pattern = file_name(path).chars().map(as_pattern).eq("tv000_pv000".chars());
    let entries = fs::read_dir(path)
        .map(|entries| entries.map(|entry| entry.map(|e| e.path())).collect::<Result<Vec<_>, _>>());
    if let Ok(Ok(entries)) = entries {
        let image = "00000 tl000 pl000 tv000 pv000.jpg";
        pattern &= entries.iter().all(|e| file_name(e).chars().map(as_pattern).eq(image.chars()));
    }
    pattern
}

/// All digits look alike.
fn as_pattern(character: char) -> char {
    if character.is_ascii_digit() { '0' } else { character }
}

fn file_name(path: &Path) -> String {
    path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default()
}

fn is_our_name(path: &Path) -> bool {
    let name = file_name(path);
    let is_numbered =
        ["factor-", "first-", "map-", "second-", "slices-", "view-"].iter().any(|prefix| {
            name.strip_prefix(prefix).and_then(|rest| rest.rsplit_once('.')).is_some_and(
                |(number, kind)| {
                    number.parse::<u32>().is_ok() && ["exr", "png", "svg"].contains(&kind)
                },
            )
        });
    OUR_NAMES.contains(&name.as_str()) || is_numbered
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_of_ours_is_replaced_and_a_foreign_one_is_not() {
        let root = tempfile::tempdir().unwrap();
        let place = root.path().join("out");
        let run = |force: bool, name: &str| -> Result<PathBuf, FileError> {
            let mut folder = OutputFolder::new(&place, force)?;
            folder.write("report.json", b"{\n  \"brdf\": 1}")?;
            folder.write(name, b"x")?;
            folder.finish()
        };
        run(false, "factor-1.png").unwrap();
        run(false, "factor-2.png").unwrap();
        assert!(!place.join("factor-1.png").exists(), "the stale factor is gone");

        fs::write(place.join("notes.txt"), "mine").unwrap();
        let refused = run(false, "factor-3.png").unwrap_err();
        assert!(matches!(refused, FileError::InTheWay { .. }), "{refused}");
        run(true, "factor-3.png").unwrap();
        assert_eq!(fs::read_to_string(place.join("notes.txt")).unwrap(), "mine");
        let left = fs::read_dir(root.path()).unwrap().count();
        assert_eq!(left, 1, "nothing temporary is left behind");
    }
}
