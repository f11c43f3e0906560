//! Little-endian values at checked offsets.

use crate::FormatError;

/// A place in a byte slice that only moves forward, and never past the end.
#[derive(Clone, Debug)]
pub struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Cursor<'a> {
    /// Returns a cursor at an offset.
    pub fn new(bytes: &'a [u8], at: usize) -> Self {
        Self { bytes, at }
    }

    /// Returns the offset of the next byte.
    pub fn offset(&self) -> usize {
        self.at
    }

    /// Returns the next `len` bytes, of what a message calls `what`.
    ///
    /// # Errors
    ///
    /// [`FormatError::PastEnd`].
    pub fn take(&mut self, len: usize, what: &str) -> Result<&'a [u8], FormatError> {
        let taken = slice(self.bytes, self.at as u64, len, what)?;
        self.at += len;
        Ok(taken)
    }

    /// Returns the next bytes as an array.
    ///
    /// # Errors
    ///
    /// [`FormatError::PastEnd`].
    pub fn array<const N: usize>(&mut self, what: &str) -> Result<[u8; N], FormatError> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N, what)?);
        Ok(array)
    }

    /// Returns the next number, little-endian.
    ///
    /// # Errors
    ///
    /// [`FormatError::PastEnd`].
    pub fn u8(&mut self, what: &str) -> Result<u8, FormatError> {
        self.array::<1>(what).map(|[byte]| byte)
    }

    /// Returns the next number, little-endian.
    ///
    /// # Errors
    ///
    /// [`FormatError::PastEnd`].
    pub fn u16(&mut self, what: &str) -> Result<u16, FormatError> {
        self.array(what).map(u16::from_le_bytes)
    }

    /// Returns the next number, little-endian.
    ///
    /// # Errors
    ///
    /// [`FormatError::PastEnd`].
    pub fn u32(&mut self, what: &str) -> Result<u32, FormatError> {
        self.array(what).map(u32::from_le_bytes)
    }

    /// Returns the next number, little-endian.
    ///
    /// # Errors
    ///
    /// [`FormatError::PastEnd`].
    pub fn u64(&mut self, what: &str) -> Result<u64, FormatError> {
        self.array(what).map(u64::from_le_bytes)
    }
}

/// `len` bytes at `offset`, if they are there.
pub(crate) fn slice<'a>(
    bytes: &'a [u8],
    offset: u64,
    len: usize,
    what: &str,
) -> Result<&'a [u8], FormatError> {
    usize::try_from(offset)
        .ok()
        .and_then(|start| bytes.get(start..start.checked_add(len)?))
        .ok_or_else(|| FormatError::PastEnd { offset, what: what.to_owned(), length: bytes.len() })
}

/// Returns the f64 values of little-endian bytes; a remainder is left out.
pub fn f64_values(bytes: &[u8]) -> impl ExactSizeIterator<Item = f64> + '_ {
    bytes.as_chunks::<8>().0.iter().map(|chunk| f64::from_le_bytes(*chunk))
}

/// Returns the f32 values of little-endian bytes; a remainder is left out.
pub fn f32_values(bytes: &[u8]) -> Vec<f32> {
    bytes.as_chunks::<4>().0.iter().map(|chunk| f32::from_le_bytes(*chunk)).collect()
}
