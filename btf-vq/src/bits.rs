//! Rows of entries of a few bits, lowest bit first, read in place.

/// Returns the bits of an index into a book of `rows` rows: ⌈log₂ rows⌉, and 0 for a single row.
///
/// ```
/// assert_eq!([1, 2, 5].map(btf_vq::index_bits), [0, 1, 3]);
/// ```
pub fn index_bits(rows: usize) -> u32 {
    rows.saturating_sub(1).checked_ilog2().map_or(0, |log| log + 1)
}

/// Bytes of entries of equal size, rounded up.
pub(crate) fn packed_len(entries: usize, entry_bits: u32) -> Option<usize> {
    Some(entries.checked_mul(entry_bits as usize)?.div_ceil(8))
}

/// Most bits of an entry: it has to fit into eight bytes at any bit offset.
pub(crate) const MAX_ENTRY_BITS: u32 = 56;

/// Most bits of two entries that share eight bytes at any bit offset, each.
const PAIRED_BITS: usize = 28;

/// Entries one after another.
pub(crate) fn pack(entries: impl Iterator<Item = u64>, entry_bits: u32) -> Vec<u8> {
    let mut bytes = Vec::new();
    let (mut word, mut filled) = (0_u64, 0);
    for entry in entries {
        word |= entry << filled;
        filled += entry_bits;
        while filled >= 8 {
            bytes.push((word & 0xff) as u8);
            word >>= 8;
            filled -= 8;
        }
    }
    if filled > 0 {
        bytes.push((word & 0xff) as u8);
    }
    bytes
}

/// Packed entries of at most [`MAX_ENTRY_BITS`] bits.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PackedEntries<'a> {
    bytes: &'a [u8],
    bits: usize,
    mask: u64,
}

impl<'a> PackedEntries<'a> {
    pub(crate) fn new(bytes: &'a [u8], bits: u32) -> Self {
        Self { bytes, bits: bits as usize, mask: (1 << bits) - 1 }
    }

    /// Entry `at`; zeros past the end.
    #[inline]
    pub(crate) fn get(&self, at: usize) -> u64 {
        let bit = at * self.bits;
        (self.word(bit >> 3) >> (bit & 7)) & self.mask
    }

    /// Entries `at` and `at + 1`, mostly by a single load; zeros past the end.
    #[inline]
    pub(crate) fn pair(&self, at: usize) -> [u64; 2] {
        if self.bits > PAIRED_BITS {
            return [self.get(at), self.get(at + 1)];
        }
        let bit = at * self.bits;
        let word = self.word(bit >> 3) >> (bit & 7);
        [word & self.mask, (word >> self.bits) & self.mask]
    }

    #[inline]
    fn word(&self, at: usize) -> u64 {
        match self.bytes.get(at..at + 8).and_then(|bytes| bytes.try_into().ok()) {
            Some(bytes) => u64::from_le_bytes(bytes),
            None => self.last_word(at),
        }
    }

    #[cold]
    fn last_word(&self, at: usize) -> u64 {
        let mut bytes = [0; 8];
        let rest = self.bytes.get(at..).unwrap_or_default();
        let count = rest.len().min(8);
        bytes[..count].copy_from_slice(&rest[..count]);
        u64::from_le_bytes(bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_come_back_at_every_width() {
        for bits in 1..=MAX_ENTRY_BITS {
            let mask = (1_u64 << bits) - 1;
            let entries: Vec<u64> =
                (0..100_u64).map(|i| i.wrapping_mul(0x9e37_79b9_7f4a_7c15) & mask).collect();
            let bytes = pack(entries.iter().copied(), bits);
            assert_eq!(Some(bytes.len()), packed_len(100, bits));
            let packed = PackedEntries::new(&bytes, bits);
            for (at, entry) in entries.iter().enumerate() {
                assert_eq!(packed.get(at), *entry, "{bits} bits, entry {at}");
            }
            for (at, pair) in entries.windows(2).enumerate() {
                assert_eq!(packed.pair(at), *pair, "{bits} bits, entries {at} and {}", at + 1);
            }
        }
    }

    #[test]
    fn a_single_row_needs_no_index() {
        assert_eq!(
            [0, 1, 2, 3, 4, 5, 790, 1024, 1025].map(index_bits),
            [0, 0, 1, 2, 2, 3, 10, 10, 11]
        );
    }
}
