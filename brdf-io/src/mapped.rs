//! Files as bytes, memory-mapped.

use std::fs::File;
use std::ops::Deref;
use std::path::Path;

use memmap2::Mmap;

use crate::IoError;

/// The content of a file.
#[derive(Debug)]
pub struct MappedFile(Option<Mmap>);

impl MappedFile {
    /// Maps a file; an empty one needs no mapping.
    ///
    /// # Errors
    ///
    /// [`IoError::Folder`]; [`IoError::File`].
    pub fn open(path: &Path) -> Result<Self, IoError> {
        let file = File::open(path).map_err(IoError::file(path, "opening"))?;
        let metadata = file.metadata().map_err(IoError::file(path, "looking at"))?;
        if metadata.is_dir() {
            return Err(IoError::Folder { path: path.to_owned() });
        }
        if metadata.len() == 0 {
            return Ok(Self(None));
        }
        #[expect(
            unsafe_code,
            reason = "the mapping is private and read-only; a file that another process shortens \
                      meanwhile ends this process, as it would with any mapped reader"
        )]
        let mapping = unsafe { Mmap::map(&file) }.map_err(IoError::file(path, "mapping"))?;
        Ok(Self(Some(mapping)))
    }
}

impl Deref for MappedFile {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        self.0.as_deref().unwrap_or(&[])
    }
}
