//! Bidirectional texture functions of any kind, recognized by content.

use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use btf_vq::{BtfLayout, BtfSource, SourceError};

use super::{BtfFile, BtfImages, BtfNotes, LoadedBtf};
use crate::bonn_header::is_bonn;
use crate::files::ZIP_MAGIC;
use brdf_files::{FileError, MappedFile};
use brdf_io::FormatError;
use brdf_io::quoted;
use brdf_job::Job;

/// A BTF whose directions and size are known, and of which nothing is decoded yet.
#[derive(Debug)]
#[non_exhaustive]
#[expect(clippy::large_enum_variant, reason = "there is one for each file")]
pub enum BtfInput {
    /// One image for each view and light.
    Images(BtfImages),
    /// A `.btf` file.
    File(Arc<BtfFile>),
}

/// A BTF that can be read block by block.
#[derive(Debug)]
#[non_exhaustive]
pub enum Btf {
    /// One image for each view and light.
    Images(LoadedBtf),
    /// A `.btf` file.
    File(Arc<BtfFile>),
}

/// Opens a folder or a ZIP archive of images, or a `.btf` file; which of them is found by content.
///
/// # Errors
///
/// [`FileError`] for what cannot be read or is none of these.
pub fn open_btf(path: &Path) -> Result<BtfInput, FileError> {
    if path.is_dir() {
        return BtfImages::in_folder(path).map(BtfInput::Images);
    }
    let bytes = MappedFile::open(path)?;
    if ZIP_MAGIC.iter().any(|magic| bytes.starts_with(magic)) {
        return BtfImages::in_archive(path, bytes).map(BtfInput::Images);
    }
    if is_bonn(&bytes) {
        let file = BtfFile::new(bytes).map_err(FileError::content(path))?;
        return Ok(BtfInput::File(Arc::new(file)));
    }
    let start = String::from_utf8_lossy(&bytes[..bytes.len().min(16)]);
    Err(FileError::content(path)(FormatError::Missing {
        what: format!("BTF: it starts with {}", quoted(&start)),
        expected: "a folder or ZIP archive of images named by angles, or a .btf file".to_owned(),
    }))
}

impl BtfInput {
    /// Returns size and directions.
    pub fn layout(&self) -> &BtfLayout {
        match self {
            Self::Images(images) => images.layout(),
            Self::File(file) => file.layout(),
        }
    }

    /// Returns what is unusual about a set of images, or `None` for a `.btf` file.
    pub fn notes(&self) -> Option<&BtfNotes> {
        match self {
            Self::Images(images) => Some(images.notes()),
            Self::File(_) => None,
        }
    }

    /// Decodes what has to be decoded as a whole; see [`BtfImages::load`].
    ///
    /// # Errors
    ///
    /// [`FileError::Content`] for images that cannot be read.
    pub fn load(&self, memory_limit: usize, job: &Job<'_>) -> Result<Btf, FileError> {
        match self {
            Self::Images(images) => images.load(memory_limit, job).map(Btf::Images),
            Self::File(file) => Ok(Btf::File(Arc::clone(file))),
        }
    }
}

impl BtfSource for Btf {
    fn layout(&self) -> &BtfLayout {
        match self {
            Self::Images(images) => images.layout(),
            Self::File(file) => file.layout(),
        }
    }

    fn read_image(&self, image: usize, out: &mut [f32]) -> Result<(), SourceError> {
        match self {
            Self::Images(images) => images.read_image(image, out),
            Self::File(file) => file.read_image(image, out),
        }
    }

    fn read_texels(&self, texels: Range<usize>, out: &mut [f32]) -> Result<(), SourceError> {
        match self {
            Self::Images(images) => images.read_texels(texels, out),
            Self::File(file) => file.read_texels(texels, out),
        }
    }
}
