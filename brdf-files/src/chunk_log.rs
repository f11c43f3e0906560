//! Work that can be taken up again: a file of chunks that only grows.

use std::fs::{File, OpenOptions};
use std::io::Write as _;
use std::path::{Path, PathBuf};

use hmac_sha256::Hash;

use crate::FileError;

/// A log of finished pieces of long work, from which an interrupted run can go on.
///
/// The file starts with a key, which stands for what is being made and of what, and goes on with chunks, each with
/// its length and a hash. A chunk that was cut off is left out.
///
/// ```
/// use brdf_files::ChunkLog;
///
/// let folder = tempfile::tempdir()?;
/// let (path, key) = (folder.path().join("work"), [7; 32]);
/// ChunkLog::create(&path, &key)?.append(b"first piece")?;
///
/// let (log, chunks) = ChunkLog::resume(&path, &key)?;
/// assert_eq!(chunks, [b"first piece"]);
/// log.remove()?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct ChunkLog {
    path: PathBuf,
    file: File,
}

const MAGIC: &[u8; 8] = b"brdfwork";

impl ChunkLog {
    /// Creates a log, in place of one that may be there.
    ///
    /// # Errors
    ///
    /// [`FileError::File`].
    pub fn create(path: &Path, key: &[u8; 32]) -> Result<Self, FileError> {
        let mut file = File::create(path).map_err(FileError::file(path, "creating"))?;
        file.write_all(&[&MAGIC[..], key].concat()).map_err(FileError::file(path, "writing"))?;
        Ok(Self { path: path.to_owned(), file })
    }

    /// Opens a log that was begun with the same key and returns it with its whole chunks. Creates one if there is
    /// none or its key is another.
    ///
    /// # Errors
    ///
    /// [`FileError::File`].
    pub fn resume(path: &Path, key: &[u8; 32]) -> Result<(Self, Vec<Vec<u8>>), FileError> {
        let bytes = match std::fs::read(path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => Vec::new(),
            Err(error) => return Err(FileError::file(path, "reading")(error)),
        };
        let head = [&MAGIC[..], key].concat();
        if !bytes.starts_with(&head) {
            return Ok((Self::create(path, key)?, Vec::new()));
        }
        let (mut chunks, mut end) = (Vec::new(), head.len());
        while let Some((chunk, length)) = whole_chunk(&bytes[end..]) {
            chunks.push(chunk.to_vec());
            end += length;
        }
        let file = OpenOptions::new().append(true).open(path);
        let file = file.map_err(FileError::file(path, "opening"))?;
        file.set_len(end as u64).map_err(FileError::file(path, "cutting"))?;
        Ok((Self { path: path.to_owned(), file }, chunks))
    }

    /// Adds a chunk to the end of the file.
    ///
    /// # Errors
    ///
    /// [`FileError::File`].
    pub fn append(&mut self, chunk: &[u8]) -> Result<(), FileError> {
        let mut bytes = (chunk.len() as u64).to_le_bytes().to_vec();
        bytes.extend(chunk);
        bytes.extend(Hash::hash(chunk));
        self.file.write_all(&bytes).map_err(FileError::file(&self.path, "writing"))
    }

    /// Removes the file: the work is done.
    ///
    /// # Errors
    ///
    /// [`FileError::File`].
    pub fn remove(self) -> Result<(), FileError> {
        std::fs::remove_file(&self.path).map_err(FileError::file(&self.path, "deleting"))
    }
}

/// The first chunk of what is left of a file, and the bytes that it takes with its length and hash.
fn whole_chunk(bytes: &[u8]) -> Option<(&[u8], usize)> {
    let (length, rest) = bytes.split_first_chunk::<8>()?;
    let length = usize::try_from(u64::from_le_bytes(*length)).ok()?;
    let (chunk, rest) = rest.split_at_checked(length)?;
    let (hash, _) = rest.split_first_chunk::<32>()?;
    (Hash::hash(chunk) == *hash).then_some((chunk, 8 + length + 32))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_chunks_come_back_and_work_goes_on() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("work");
        let key = [7; 32];
        let (mut log, none) = ChunkLog::resume(&path, &key).unwrap();
        assert!(none.is_empty());
        log.append(b"first").unwrap();
        log.append(b"").unwrap();
        log.append(b"a third that is cut off").unwrap();
        drop(log);
        let bytes = std::fs::read(&path).unwrap();
        std::fs::write(&path, &bytes[..bytes.len() - 40]).unwrap();
        let (mut log, chunks) = ChunkLog::resume(&path, &key).unwrap();
        assert_eq!(chunks, [&b"first"[..], b""]);
        log.append(b"third").unwrap();
        drop(log);
        let (_, chunks) = ChunkLog::resume(&path, &key).unwrap();
        assert_eq!(chunks, [&b"first"[..], b"", b"third"]);
        let mut spoilt = std::fs::read(&path).unwrap();
        spoilt[50] ^= 1;
        std::fs::write(&path, spoilt).unwrap();
        assert!(ChunkLog::resume(&path, &key).unwrap().1.is_empty(), "a hash that does not fit");
        let (log, chunks) = ChunkLog::resume(&path, &[8; 32]).unwrap();
        assert!(chunks.is_empty(), "of another task");
        log.remove().unwrap();
        assert!(!path.exists());
    }
}
