//! Where images lie: a folder and those below it, or a ZIP archive.

use std::fs::{self, File};
use std::io::{self, Cursor, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use zip::ZipArchive;
use zip::result::ZipError;

use crate::error::BtfError;
use brdf_files::{FileError, MappedFile};

/// Folders in folders that are looked into; databases have two or three.
const DEEPEST: usize = 12;
/// Files or entries that are looked at; a BTF has 6561 or 22,801.
const MOST_FILES: usize = 1 << 20;
/// Bytes of one image file, unpacked.
const LONGEST: u64 = 256 << 20;
/// Bytes that are set aside before any was read, whatever a header claims.
const FIRST_ALLOCATION: u64 = 1 << 20;

/// How a ZIP archive starts: an entry, or the end of an empty one.
pub(crate) const ZIP_MAGIC: [&[u8]; 2] = [b"PK\x03\x04", b"PK\x05\x06"];

/// Files with names, in the order of their names.
pub(crate) struct Files {
    names: Vec<String>,
    place: Place,
}

enum Place {
    Folder(PathBuf),
    /// With the index of each name's entry.
    Archive(ZipArchive<Cursor<Shared>>, Vec<usize>),
}

/// A mapped file that the readers of several threads share.
#[derive(Clone)]
struct Shared(Arc<MappedFile>);

impl AsRef<[u8]> for Shared {
    fn as_ref(&self) -> &[u8] {
        &self.0
    }
}

impl std::fmt::Debug for Files {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Files({})", self.names.len())
    }
}

impl Files {
    /// The files of a folder and those below it. Links to folders are not followed, hidden files and
    /// those whose names are not UTF-8 left out.
    pub(crate) fn in_folder(root: &Path) -> Result<Self, FileError> {
        let mut names = Vec::new();
        walk(root, "", DEEPEST, &mut names).map_err(FileError::content(root))?;
        names.sort_unstable();
        Ok(Self { names, place: Place::Folder(root.to_owned()) })
    }

    /// The entries of an archive.
    pub(crate) fn in_archive(path: &Path, bytes: MappedFile) -> Result<Self, FileError> {
        Self::archive(bytes).map_err(FileError::content(path))
    }

    fn archive(bytes: MappedFile) -> Result<Self, BtfError> {
        let archive =
            ZipArchive::new(Cursor::new(Shared(Arc::new(bytes)))).map_err(|e| archive_error(&e))?;
        if archive.len() > MOST_FILES {
            return Err(BtfError::TooMany { what: "entries", limit: MOST_FILES });
        }
        let mut entries: Vec<(String, usize)> = (0..archive.len())
            .filter_map(|index| archive.name_for_index(index).map(|name| (name.to_owned(), index)))
            .filter(|(name, _)| !name.ends_with('/') && !is_hidden(base_name(name)))
            .collect();
        entries.sort_unstable();
        let (names, indices) = entries.into_iter().unzip();
        Ok(Self { names, place: Place::Archive(archive, indices) })
    }

    /// Paths within the folder or archive, with `/` between folders.
    pub(crate) fn names(&self) -> &[String] {
        &self.names
    }

    /// The bytes of a file.
    pub(crate) fn read(&self, index: usize) -> Result<Vec<u8>, BtfError> {
        let name = &self.names[index];
        match &self.place {
            Place::Folder(root) => read_file(root, name),
            // Readers share the bytes and the list of entries; a copy is two counters.
            Place::Archive(archive, entries) => read_entry(archive.clone(), entries[index], name),
        }
    }
}

fn read_file(root: &Path, name: &str) -> Result<Vec<u8>, BtfError> {
    let failed = |action| file_error(name, action);
    let file = File::open(root.join(name)).map_err(failed("opening"))?;
    let length = file.metadata().map_err(failed("looking at"))?.len();
    read_limited(file, length, name)
}

fn read_entry(
    mut archive: ZipArchive<Cursor<Shared>>,
    index: usize,
    name: &str,
) -> Result<Vec<u8>, BtfError> {
    if archive.by_index_raw(index).map_err(|e| entry_error(name, &e))?.encrypted() {
        return Err(BtfError::Encrypted { name: name.to_owned() });
    }
    let entry = archive.by_index(index).map_err(|e| entry_error(name, &e))?;
    let length = entry.size();
    read_limited(entry, length, name)
}

/// Reads to the end, whatever length is claimed, unless that is too far.
fn read_limited(reader: impl Read, claimed: u64, name: &str) -> Result<Vec<u8>, BtfError> {
    let too_long = || BtfError::TooLong { name: name.to_owned(), limit: LONGEST };
    if claimed > LONGEST {
        return Err(too_long());
    }
    let mut bytes = Vec::with_capacity(usize::try_from(claimed.min(FIRST_ALLOCATION)).unwrap_or(0));
    reader.take(LONGEST + 1).read_to_end(&mut bytes).map_err(file_error(name, "reading"))?;
    if bytes.len() as u64 > LONGEST { Err(too_long()) } else { Ok(bytes) }
}

/// Appends the names of files below `root` joined with `prefix`, which is empty or ends in `/`.
fn walk(root: &Path, prefix: &str, depth: usize, names: &mut Vec<String>) -> Result<(), BtfError> {
    let folder = root.join(prefix);
    let failed = |action| file_error(prefix, action);
    for entry in fs::read_dir(&folder).map_err(failed("listing"))? {
        let entry = entry.map_err(failed("listing"))?;
        let file_name = entry.file_name();
        let Some(base) = file_name.to_str().filter(|base| !is_hidden(base)) else { continue };
        let name = format!("{prefix}{base}");
        if entry.file_type().map_err(failed("looking at"))?.is_dir() {
            if depth > 0 {
                walk(root, &format!("{name}/"), depth - 1, names)?;
            }
        } else if names.len() < MOST_FILES {
            names.push(name);
        } else {
            return Err(BtfError::TooMany { what: "files", limit: MOST_FILES });
        }
    }
    Ok(())
}

/// The last part of a path with `/` between folders; archives made elsewhere also have `\`.
pub(crate) fn base_name(name: &str) -> &str {
    name.rsplit(['/', '\\']).next().unwrap_or(name)
}

/// Whether a file is one that systems put beside others, such as `._name`.
fn is_hidden(base_name: &str) -> bool {
    base_name.starts_with('.')
}

fn archive_error(problem: &ZipError) -> BtfError {
    BtfError::Archive { problem: problem.to_string() }
}

fn entry_error(name: &str, problem: &ZipError) -> BtfError {
    BtfError::Archive { problem: format!("{name}: {problem}") }
}

fn file_error(name: &str, action: &'static str) -> impl FnOnce(io::Error) -> BtfError {
    let name = if name.is_empty() { "." } else { name }.to_owned();
    move |problem| BtfError::File { name, action, problem }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_bytes_than_an_image_has_are_refused_whatever_is_claimed() {
        for claimed in [10, LONGEST + 1, u64::MAX] {
            let error = read_limited(io::repeat(0), claimed, "bomb.png").unwrap_err();
            assert!(matches!(error, BtfError::TooLong { .. }), "{error}");
        }
    }
}
