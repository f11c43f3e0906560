//! Files as bytes, memory-mapped.

use std::fs::File;
use std::io::Read as _;
use std::ops::Deref;
use std::path::Path;

use memmap2::Mmap;

use crate::FileError;

/// The content of a file as bytes: memory-mapped, or read where a pipe cannot be mapped. It dereferences to `[u8]`.
#[derive(Debug)]
pub struct MappedFile(Content);

#[derive(Debug)]
enum Content {
    Mapped(Mmap),
    Read(Vec<u8>),
}

/// Most bytes that are read from a pipe.
const MAX_PIPED: u64 = 1 << 30;

impl MappedFile {
    /// Opens a file and maps it, or reads a pipe of at most 1 GiB to its end.
    ///
    /// # Errors
    ///
    /// [`FileError::Folder`]; [`FileError::File`].
    pub fn open(path: &Path) -> Result<Self, FileError> {
        let file = File::open(path).map_err(FileError::file(path, "opening"))?;
        let metadata = file.metadata().map_err(FileError::file(path, "looking at"))?;
        if metadata.is_dir() {
            return Err(FileError::Folder { path: path.to_owned() });
        }
        if !metadata.is_file() || metadata.len() == 0 {
            let mut bytes = Vec::new();
            let mut limited = file.take(MAX_PIPED + 1);
            limited.read_to_end(&mut bytes).map_err(FileError::file(path, "reading"))?;
            if bytes.len() as u64 > MAX_PIPED {
                let error = std::io::Error::from(std::io::ErrorKind::FileTooLarge);
                return Err(FileError::file(path, "reading more than 1 GiB from a pipe")(error));
            }
            return Ok(Self(Content::Read(bytes)));
        }
        #[expect(
            unsafe_code,
            reason = "the mapping is private and read-only; a file that another process shortens \
                      meanwhile ends this process, as it would with any mapped reader"
        )]
        let mapping = unsafe { Mmap::map(&file) }.map_err(FileError::file(path, "mapping"))?;
        Ok(Self(Content::Mapped(mapping)))
    }
}

impl From<Vec<u8>> for MappedFile {
    /// Bytes from elsewhere than a file.
    fn from(bytes: Vec<u8>) -> Self {
        Self(Content::Read(bytes))
    }
}

impl AsRef<[u8]> for MappedFile {
    fn as_ref(&self) -> &[u8] {
        self
    }
}

impl Deref for MappedFile {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        match &self.0 {
            Content::Mapped(mapping) => mapping,
            Content::Read(bytes) => bytes,
        }
    }
}
