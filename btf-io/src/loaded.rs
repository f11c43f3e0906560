//! All images of a BTF, decoded and read block by block.

use std::ops::Range;

use btf_vq::{BtfLayout, BtfSource, Encoding, SourceError};
use half::f16;
use half::slice::HalfFloatSliceExt as _;
use rayon::prelude::*;

use super::{BtfError, BtfImages};
use crate::decode::{ImageKind, decode_image, image_size};
use crate::store::{BLOCK, BlockStore};
use brdf_files::FileError;
use brdf_job::Job;

/// Bytes of images that are decoded before they are put into their blocks.
const BATCH_BYTES: usize = 32 << 20;
/// Images decoded together at least, for each thread.
const LEAST_PER_THREAD: usize = 2;

/// A BTF whose images are decoded: in 8 bits if they are display-referred, in half precision if they are linear.
#[derive(Debug)]
pub struct LoadedBtf {
    layout: BtfLayout,
    store: BlockStore,
    negative_values: u64,
}

impl BtfImages {
    /// Decodes all images.
    ///
    /// More than `memory_limit` bytes of them go to a temporary file; a few images come on top. Work is counted in
    /// images.
    ///
    /// # Errors
    ///
    /// [`FileError::Content`] for an image that cannot be read or differs from the others, and if there is
    /// no room or the job is stopped.
    pub fn load(&self, memory_limit: usize, job: &Job<'_>) -> Result<LoadedBtf, FileError> {
        self.decode_all(memory_limit, job).map_err(FileError::content(self.path()))
    }

    fn decode_all(&self, memory_limit: usize, job: &Job<'_>) -> Result<LoadedBtf, BtfError> {
        let layout = self.layout().clone();
        let (images, texels) = (layout.image_count(), layout.texel_count());
        let value_size = value_size(layout.encoding);
        // A header that lies about the size is found before room is made for all images.
        self.decode(0, &mut vec![0; 3 * value_size * texels])?;
        let mut store = BlockStore::new(images, texels, value_size, memory_limit)?;
        let image_bytes = 3 * value_size * texels;
        let mut batch = vec![0; image_bytes * batch_size(image_bytes).min(images)];
        let mut negative_values = 0;
        job.begin(format!("reading {}", self.path().display()), images as u64);
        for first in (0..images).step_by(batch.len() / image_bytes) {
            job.check()?;
            let count = (images - first).min(batch.len() / image_bytes);
            let batch = &mut batch[..count * image_bytes];
            negative_values += self.decode_batch(first, image_bytes, batch, job)?;
            store.put(first, &batch.chunks_exact(image_bytes).collect::<Vec<_>>());
        }
        Ok(LoadedBtf { layout, store, negative_values })
    }

    /// Decodes consecutive images; returns how many values below zero they have.
    fn decode_batch(
        &self,
        first: usize,
        image_bytes: usize,
        out: &mut [u8],
        job: &Job<'_>,
    ) -> Result<u64, BtfError> {
        let decode = |(number, out): (usize, &mut [u8])| {
            self.decode(first + number, out).inspect(|_| job.advance(1))
        };
        let outcomes: Vec<Result<u64, BtfError>> =
            out.par_chunks_exact_mut(image_bytes).enumerate().map(decode).collect();
        // The first problem in the order of images, on any number of threads.
        outcomes.into_iter().sum()
    }

    /// Decodes an image, which must be like the first one.
    fn decode(&self, image: usize, out: &mut [u8]) -> Result<u64, BtfError> {
        let name = || self.name(image).to_owned();
        let problem = |problem| BtfError::Image { name: name(), problem };
        let bytes = self.read(image)?;
        let linear = ImageKind::of(&bytes).map_err(problem)?.is_linear();
        if linear != (self.layout().encoding == Encoding::Linear) {
            let other = self.name(0).to_owned();
            return Err(BtfError::MixedRanges { name: name(), linear, other });
        }
        let size = image_size(&bytes).map_err(problem)?;
        let expected = [self.layout().width, self.layout().height];
        if size != expected {
            let other = self.name(0).to_owned();
            return Err(BtfError::Sizes { name: name(), size, expected, other });
        }
        decode_image(&bytes, out).map_err(problem)
    }
}

/// How many images are decoded at once.
fn batch_size(image_bytes: usize) -> usize {
    (BATCH_BYTES / image_bytes.max(1)).clamp(LEAST_PER_THREAD * rayon::current_num_threads(), 1024)
}

/// Bytes of a stored value.
fn value_size(encoding: Encoding) -> usize {
    match encoding {
        Encoding::Srgb => 1,
        Encoding::Linear => 2,
    }
}

impl LoadedBtf {
    /// Returns how many values of linear images were below zero and became zero, as colours outside the gamut do.
    pub fn negative_values(&self) -> u64 {
        self.negative_values
    }

    fn image_bytes(&self, image: usize) -> Vec<u8> {
        let texels = self.layout.texel_count();
        let mut bytes: Vec<u8> = (0..texels.div_ceil(BLOCK))
            .flat_map(|block| self.store.piece(block, image).iter().copied())
            .collect();
        bytes.truncate(3 * value_size(self.layout.encoding) * texels);
        bytes
    }

    /// Stored values as f32.
    fn widen(&self, bytes: &[u8], out: &mut [f32]) {
        match self.layout.encoding {
            Encoding::Srgb => {
                for (value, &byte) in out.iter_mut().zip(bytes) {
                    *value = f32::from(byte) / 255.0;
                }
            }
            Encoding::Linear => {
                bytemuck::pod_collect_to_vec::<u8, f16>(bytes).convert_to_f32_slice(out);
            }
        }
    }
}

impl BtfSource for LoadedBtf {
    fn layout(&self) -> &BtfLayout {
        &self.layout
    }

    fn read_image(&self, image: usize, out: &mut [f32]) -> Result<(), SourceError> {
        self.widen(&self.image_bytes(image), out);
        Ok(())
    }

    fn read_texels(&self, texels: Range<usize>, out: &mut [f32]) -> Result<(), SourceError> {
        assert!(texels.end <= self.layout.texel_count(), "texels {texels:?} are not all there");
        assert_eq!(out.len(), 3 * texels.len() * self.store.images(), "room for all images");
        if texels.is_empty() {
            return Ok(());
        }
        let bytes_per_texel = 3 * value_size(self.layout.encoding);
        for (image, out) in out.chunks_exact_mut(3 * texels.len()).enumerate() {
            let mut rest = out;
            let mut at = texels.start;
            while at < texels.end {
                let (block, start) = (at / BLOCK, at % BLOCK);
                let count = (BLOCK - start).min(texels.end - at);
                let piece = self.store.piece(block, image);
                let (part, later) = rest.split_at_mut(3 * count);
                let bytes = &piece[start * bytes_per_texel..(start + count) * bytes_per_texel];
                self.widen(bytes, part);
                (rest, at) = (later, at + count);
            }
        }
        Ok(())
    }
}
