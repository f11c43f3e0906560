//! Little-endian values at checked offsets.

use crate::FormatError;

/// A reading position in a byte slice, which only moves forward and never past the end.
///
/// ```
/// let mut cursor = brdf_io::Cursor::new(&[2, 0, 7], 0);
/// assert_eq!(cursor.u16("the count")?, 2);
/// assert_eq!(cursor.offset(), 2);
/// assert!(cursor.u32("the first value").is_err(), "one byte is left");
/// # Ok::<(), brdf_io::FormatError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Cursor<'a> {
    /// Returns a cursor at the offset `at`, in bytes.
    pub fn new(bytes: &'a [u8], at: usize) -> Self {
        Self { bytes, at }
    }

    /// Returns the offset of the next byte, from the start of the slice.
    pub fn offset(&self) -> usize {
        self.at
    }

    /// Returns the next `len` bytes and moves past them; `what` names them in the error.
    ///
    /// # Errors
    ///
    /// [`FormatError::PastEnd`].
    pub fn take(&mut self, len: usize, what: &str) -> Result<&'a [u8], FormatError> {
        let taken = slice(self.bytes, self.at as u64, len, what)?;
        self.at += len;
        Ok(taken)
    }

    /// Returns the next `N` bytes as an array and moves past them.
    ///
    /// # Errors
    ///
    /// [`FormatError::PastEnd`].
    pub fn array<const N: usize>(&mut self, what: &str) -> Result<[u8; N], FormatError> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N, what)?);
        Ok(array)
    }

    /// Returns the next byte and moves past it.
    ///
    /// # Errors
    ///
    /// [`FormatError::PastEnd`].
    pub fn u8(&mut self, what: &str) -> Result<u8, FormatError> {
        self.array::<1>(what).map(|[byte]| byte)
    }

    /// Returns the next two bytes as a little-endian number and moves past them.
    ///
    /// # Errors
    ///
    /// [`FormatError::PastEnd`].
    pub fn u16(&mut self, what: &str) -> Result<u16, FormatError> {
        self.array(what).map(u16::from_le_bytes)
    }

    /// Returns the next four bytes as a little-endian number and moves past them.
    ///
    /// # Errors
    ///
    /// [`FormatError::PastEnd`].
    pub fn u32(&mut self, what: &str) -> Result<u32, FormatError> {
        self.array(what).map(u32::from_le_bytes)
    }

    /// Returns the next eight bytes as a little-endian number and moves past them.
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

/// Returns the `f64` values of little-endian bytes; up to seven bytes that remain are left out.
pub fn f64_values(bytes: &[u8]) -> impl ExactSizeIterator<Item = f64> + '_ {
    bytes.as_chunks::<8>().0.iter().map(|chunk| f64::from_le_bytes(*chunk))
}

/// Returns the `f32` values of little-endian bytes; up to three bytes that remain are left out.
///
/// ```
/// assert_eq!(brdf_io::f32_values(&[0, 0, 128, 63, 9]), [1.0]);
/// ```
pub fn f32_values(bytes: &[u8]) -> Vec<f32> {
    bytes.as_chunks::<4>().0.iter().map(|chunk| f32::from_le_bytes(*chunk)).collect()
}
