//! Decoded images block by block of texels, in memory or in a file without a name.
//!
//! A block holds 64 consecutive texels of all images, `[image][64 texels][3 channels]`: what fits a
//! texel in one direction is wanted for all directions at once. The last block is filled with zeros.

use std::fs::File;

use memmap2::{Advice, MmapMut};
use rayon::prelude::*;

use crate::error::BtfError;

/// Texels of a block; 192 bytes of an image lie together.
pub(crate) const BLOCK: usize = 64;

/// Space on the disk that stays free.
const SPARE: u64 = 64 << 20;

/// Values of `size` bytes for each channel of a number of images.
#[derive(Debug)]
pub(crate) struct BlockStore {
    bytes: MmapMut,
    images: usize,
    /// Bytes of 64 texels of one image.
    piece: usize,
}

impl BlockStore {
    /// Room for images of `texels` texels with `value_size` bytes in each of three channels; in a
    /// temporary file if it takes more than `memory_limit` bytes.
    pub(crate) fn new(
        images: usize,
        texels: usize,
        value_size: usize,
        memory_limit: usize,
    ) -> Result<Self, BtfError> {
        let piece = 3 * BLOCK * value_size;
        let sizes = [images, texels.div_ceil(BLOCK), piece];
        let needed = sizes.iter().try_fold(1_u64, |n, &side| n.checked_mul(side as u64));
        let needed = needed.unwrap_or(u64::MAX);
        let bytes = match usize::try_from(needed) {
            Ok(length) if length <= memory_limit => in_memory(length)?,
            _ => in_file(needed, memory_limit)?,
        };
        Ok(Self { bytes, images, piece })
    }

    /// Puts images from number `first` on, each given as its bytes row by row.
    pub(crate) fn put(&mut self, first: usize, pictures: &[&[u8]]) {
        let piece = self.piece;
        self.bytes.par_chunks_mut(self.images * piece).enumerate().for_each(|(block, bytes)| {
            let places = bytes[first * piece..].chunks_exact_mut(piece);
            for (place, picture) in places.zip(pictures) {
                let start = block * piece;
                let taken = &picture[start..picture.len().min(start + piece)];
                place[..taken.len()].copy_from_slice(taken);
            }
        });
    }

    /// The 64 texels of a block in an image.
    pub(crate) fn piece(&self, block: usize, image: usize) -> &[u8] {
        let start = (block * self.images + image) * self.piece;
        &self.bytes[start..start + self.piece]
    }

    /// Number of images.
    pub(crate) fn images(&self) -> usize {
        self.images
    }
}

fn in_memory(length: usize) -> Result<MmapMut, BtfError> {
    let mapping = MmapMut::map_anon(length).map_err(storage("memory", length as u64))?;
    // Each image touches every block. A system without large pages is slower, not wrong.
    #[cfg(target_os = "linux")]
    let _ = mapping.advise(Advice::HugePage);
    Ok(mapping)
}

fn in_file(needed: u64, limit: usize) -> Result<MmapMut, BtfError> {
    let folder = std::env::temp_dir();
    let free = fs4::available_space(&folder).map_err(storage("looking for space", needed))?;
    if needed.saturating_add(SPARE) > free {
        return Err(BtfError::NoRoom { needed, limit, folder, free });
    }
    let file = tempfile::tempfile().map_err(storage("a temporary file", needed))?;
    reserve(&file, needed)?;
    #[expect(
        unsafe_code,
        reason = "the file has no name, so that no other process can shorten or change it"
    )]
    let mapping = unsafe { MmapMut::map_mut(&file) };
    mapping.map_err(storage("mapping a temporary file", needed))
}

/// Takes the space at once: a disk that fills up later would end the process.
fn reserve(file: &File, needed: u64) -> Result<(), BtfError> {
    fs4::FileExt::allocate(file, needed)
        .and_then(|()| file.set_len(needed))
        .map_err(storage("space on the disk", needed))
}

fn storage(action: &'static str, needed: u64) -> impl FnOnce(std::io::Error) -> BtfError {
    move |problem| BtfError::Storage { action, needed, problem }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Images of 100 texels: a whole block and a part of one.
    fn filled(memory_limit: usize) -> BlockStore {
        let mut store = BlockStore::new(3, 100, 1, memory_limit).unwrap();
        let pictures: Vec<Vec<u8>> = (1..=3).map(|value| vec![value; 300]).collect();
        store.put(0, &[&pictures[0]]);
        store.put(1, &[&pictures[1], &pictures[2]]);
        store
    }

    #[test]
    fn memory_and_file_hold_the_same() {
        for store in [filled(usize::MAX), filled(0)] {
            for image in 0..3 {
                let value = u8::try_from(image).unwrap() + 1;
                assert!(store.piece(0, image).iter().all(|&b| b == value), "image {image}");
                assert!(store.piece(1, image)[..108].iter().all(|&b| b == value), "image {image}");
                assert!(store.piece(1, image)[108..].iter().all(|&b| b == 0), "image {image}");
            }
        }
    }

    #[test]
    fn more_than_fits_anywhere_is_refused() {
        let error = BlockStore::new(1 << 30, 1 << 30, 2, 1 << 20).unwrap_err();
        assert!(matches!(error, BtfError::NoRoom { .. }), "{error}");
    }
}
