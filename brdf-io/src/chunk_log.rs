//! Work that can be taken up again: a file of chunks that only grows.

use std::fs::{File, OpenOptions};
use std::io::Write as _;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use crate::IoError;
use crate::bytes::Cursor;

/// A file that starts with a key, what is being made and of what, and goes on with chunks, each with its length
/// and a hash. A chunk that was cut off is not there.
#[derive(Debug)]
pub struct ChunkLog {
    path: PathBuf,
    file: File,
}

const MAGIC: &[u8; 8] = b"brdfwork";

impl ChunkLog {
    /// Begins a file, in place of one that may be there.
    ///
    /// # Errors
    ///
    /// [`IoError::File`].
    pub fn create(path: &Path, key: &[u8; 32]) -> Result<Self, IoError> {
        let mut file = File::create(path).map_err(IoError::file(path, "creating"))?;
        file.write_all(&[&MAGIC[..], key].concat()).map_err(IoError::file(path, "writing"))?;
        Ok(Self { path: path.to_owned(), file })
    }

    /// Opens a file that was begun with the same key and gives its whole chunks; begins one if there is none
    /// or its key is another.
    ///
    /// # Errors
    ///
    /// [`IoError::File`].
    pub fn resume(path: &Path, key: &[u8; 32]) -> Result<(Self, Vec<Vec<u8>>), IoError> {
        let bytes = match std::fs::read(path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => Vec::new(),
            Err(error) => return Err(IoError::file(path, "reading")(error)),
        };
        let head = [&MAGIC[..], key].concat();
        if !bytes.starts_with(&head) {
            return Ok((Self::create(path, key)?, Vec::new()));
        }
        let (mut chunks, mut end) = (Vec::new(), head.len());
        let mut cursor = Cursor::new(&bytes, end);
        while let Some(chunk) = whole_chunk(&mut cursor) {
            chunks.push(chunk.to_vec());
            end = cursor.offset();
        }
        let file = OpenOptions::new().append(true).open(path);
        let file = file.map_err(IoError::file(path, "opening"))?;
        file.set_len(end as u64).map_err(IoError::file(path, "cutting"))?;
        Ok((Self { path: path.to_owned(), file }, chunks))
    }

    /// Adds a chunk.
    ///
    /// # Errors
    ///
    /// [`IoError::File`].
    pub fn append(&mut self, chunk: &[u8]) -> Result<(), IoError> {
        let mut bytes = (chunk.len() as u64).to_le_bytes().to_vec();
        bytes.extend(chunk);
        bytes.extend(&Sha256::digest(chunk)[..]);
        self.file.write_all(&bytes).map_err(IoError::file(&self.path, "writing"))
    }

    /// Deletes the file: the work is done.
    ///
    /// # Errors
    ///
    /// [`IoError::File`].
    pub fn remove(self) -> Result<(), IoError> {
        std::fs::remove_file(&self.path).map_err(IoError::file(&self.path, "deleting"))
    }
}

fn whole_chunk<'a>(cursor: &mut Cursor<'a>) -> Option<&'a [u8]> {
    let length = usize::try_from(cursor.u64("length").ok()?).ok()?;
    let chunk = cursor.take(length, "chunk").ok()?;
    let hash = cursor.take(32, "hash").ok()?;
    (Sha256::digest(chunk)[..] == *hash).then_some(chunk)
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
