//! Output that appears whole or not at all.

use std::fs;
use std::io::{ErrorKind, Write};
use std::path::Path;

use tempfile::NamedTempFile;

use crate::{FileError, MappedFile};

/// How pictures of this project are recognized: their Software text.
const PICTURE_MARK: &[u8] = b"Software\0brdf";
/// How its plots are recognized: the comment at their head.
const PLOT_MARK: &[u8] = b"<!-- brdf plot -->";
/// How its tables of directions begin.
const TABLE_HEADER: &[u8] = b"theta_i_deg,phi_i_deg,theta_o_deg,phi_o_deg";

/// The files that may be overwritten.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Overwrite {
    /// Files that this project wrote: containers, its pictures, tables with its header.
    Ours,
    /// Any file.
    Anything,
}

/// Writes a file under a temporary name beside its place, then renames it, so that it appears whole or not at all.
///
/// Where something that is no plain file stands there (a pipe, a device), the bytes go straight into it.
///
/// ```
/// use brdf_files::{FileError, Overwrite, write_atomically};
///
/// let folder = tempfile::tempdir()?;
/// let notes = folder.path().join("notes.txt");
/// std::fs::write(&notes, "written by somebody else")?;
/// let refused = write_atomically(&notes, b"data", Overwrite::Ours);
/// assert!(matches!(refused, Err(FileError::InTheWay { .. })));
/// write_atomically(&notes, b"data", Overwrite::Anything)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
///
/// [`FileError::InTheWay`] for a file that must not be overwritten; [`FileError::Folder`];
/// [`FileError::File`]. The old file stays whole.
pub fn write_atomically(path: &Path, bytes: &[u8], overwrite: Overwrite) -> Result<(), FileError> {
    check_overwrite(path, overwrite)?;
    if fs::metadata(path).is_ok_and(|metadata| !metadata.is_file()) {
        return fs::write(path, bytes).map_err(FileError::file(path, "writing"));
    }
    let folder = parent(path);
    let mut file = NamedTempFile::new_in(folder).map_err(FileError::file(path, "creating"))?;
    file.write_all(bytes).map_err(FileError::file(path, "writing"))?;
    make_readable(file.path()).map_err(FileError::file(path, "writing"))?;
    file.persist(path).map_err(|e| FileError::file(path, "renaming to")(e.error))?;
    Ok(())
}

/// Checks that [`write_atomically`] may write a file: worth knowing before work that takes long.
///
/// # Errors
///
/// [`FileError::InTheWay`] for a file that must not be overwritten; [`FileError::Folder`].
pub fn check_overwrite(path: &Path, overwrite: Overwrite) -> Result<(), FileError> {
    let Ok(metadata) = fs::metadata(path) else { return Ok(()) };
    if metadata.is_dir() {
        return Err(FileError::Folder { path: path.to_owned() });
    }
    if metadata.is_file() && overwrite == Overwrite::Ours {
        let content = MappedFile::open(path)?;
        if !content.is_empty() && !is_ours(&content) {
            return Err(FileError::InTheWay { path: path.to_owned(), found: "a file" });
        }
    }
    Ok(())
}

/// A container, a picture with our mark, or a table with our header.
fn is_ours(content: &[u8]) -> bool {
    let is_table = content.starts_with(TABLE_HEADER);
    let is_picture = content.starts_with(b"\x89PNG")
        && content.windows(PICTURE_MARK.len()).take(4096).any(|w| w == PICTURE_MARK);
    let is_plot = content.starts_with(b"<svg")
        && content.windows(PLOT_MARK.len()).take(4096).any(|w| w == PLOT_MARK);
    is_table || is_picture || is_plot || is_container(content)
}

/// A safetensors file, as all containers of this project are: the length of a header, then the start of a JSON
/// object.
fn is_container(content: &[u8]) -> bool {
    let Some((length, rest)) = content.split_first_chunk::<8>() else { return false };
    rest.starts_with(b"{\"")
        || rest.first() == Some(&b'{') && u64::from_le_bytes(*length) <= rest.len() as u64
}

pub(crate) fn parent(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Temporary files and folders are private; results should have the permissions of any new file.
#[cfg(unix)]
pub(crate) fn make_readable(path: &Path) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt as _;
    let mode = if fs::metadata(path)?.is_dir() { 0o755 } else { 0o644 };
    match fs::set_permissions(path, fs::Permissions::from_mode(mode)) {
        Err(error) if error.kind() != ErrorKind::Unsupported => Err(error),
        _ => Ok(()),
    }
}

#[cfg(not(unix))]
pub(crate) fn make_readable(_path: &Path) -> std::io::Result<()> {
    Ok(())
}
