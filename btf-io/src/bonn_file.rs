//! Binary BTFs of the University of Bonn (`.btf`), as UBO2014 and its tools write them.

use std::ops::Range;
use std::path::Path;

use btf_vq::{BtfLayout, BtfSource, Encoding, SourceError};

use crate::bonn_factors::Factors;
use crate::bonn_header::{Packing, read_header, skip_rotations};
use crate::bonn_texels::Texels;
use brdf_files::{FileError, MappedFile};
use brdf_io::FormatError;

/// A `.btf` file of the University of Bonn, whose values are computed when they are asked for.
///
/// Three kinds are read: factors of each channel (signature `!DFMF08FCR`), factors of all channels together
/// (`!FMF12FCER`, `!FMF06FCR`, `!FMF06FC`), and all values (`!BDIF06R2!`). The layout follows the file readers of btflib,
/// the university's own library.
///
/// ```
/// use brdf_files::MappedFile;
/// use btf_io::BtfFile;
///
/// let error = BtfFile::new(MappedFile::from(b"!PVF06FCR".to_vec())).unwrap_err();
/// assert!(error.to_string().contains("!DFMF08FCR"), "another kind is refused by name");
/// ```
#[doc(alias = "DFMF")]
#[doc(alias = "FMF")]
#[doc(alias = "BDIF")]
#[derive(Debug)]
pub struct BtfFile {
    bytes: MappedFile,
    layout: BtfLayout,
    content: Content,
}

#[derive(Debug)]
#[expect(clippy::large_enum_variant, reason = "there is one for each file")]
enum Content {
    Factors(Factors),
    Texels(Texels),
}

impl BtfFile {
    /// Opens a file, maps it and reads its head.
    ///
    /// # Errors
    ///
    /// [`FileError::File`]; [`FileError::Content`] as for [`BtfFile::new`].
    pub fn open(path: &Path) -> Result<Self, FileError> {
        Self::new(MappedFile::open(path)?).map_err(FileError::content(path))
    }

    /// Reads the head of a file's bytes, and makes sure that what it announces is there.
    ///
    /// # Errors
    ///
    /// [`FormatError`] for another format, fields that contradict each other, and a file that ends
    /// early or goes on.
    pub fn new(bytes: MappedFile) -> Result<Self, FormatError> {
        let (layout, content) = read(&bytes)?;
        Ok(Self { bytes, layout, content })
    }

    /// Returns the number of texels without values; they are read as black.
    pub fn absent_texels(&self) -> usize {
        match &self.content {
            Content::Factors(_) => 0,
            Content::Texels(texels) => texels.absent(),
        }
    }
}

fn read(bytes: &[u8]) -> Result<(BtfLayout, Content), FormatError> {
    let (header, mut cursor) = read_header(bytes)?;
    let content = match header.packing {
        Packing::Texels => Content::Texels(Texels::read(bytes, &header, &mut cursor)?),
        packing => {
            if header.rotations {
                skip_rotations(&mut cursor)?;
            }
            Content::Factors(match packing {
                Packing::Factored { head } => {
                    Factors::read_joint(bytes, &header, &mut cursor, head)?
                }
                _ => Factors::read_decorrelated(bytes, &header, &mut cursor)?,
            })
        }
    };
    let layout = BtfLayout {
        width: header.width,
        height: header.height,
        views: header.views,
        encoding: Encoding::Linear,
        cosine_included: header.cosine_included,
    };
    Ok((layout, content))
}

impl BtfSource for BtfFile {
    fn layout(&self) -> &BtfLayout {
        &self.layout
    }

    /// Values below zero, which cut-off factorizations give, are read as zero; those that are no
    /// numbers are an error.
    fn read_texels(&self, texels: Range<usize>, out: &mut [f32]) -> Result<(), SourceError> {
        assert!(texels.end <= self.layout.texel_count(), "texels {texels:?} are not all there");
        let values = 3 * texels.len() * self.layout.image_count();
        assert_eq!(out.len(), values, "room for all images");
        if texels.is_empty() {
            return Ok(());
        }
        match &self.content {
            Content::Factors(factors) => factors.read_texels(&self.bytes, texels.clone(), out),
            Content::Texels(stored) => stored.read_texels(&self.bytes, texels.clone(), out),
        }
        if let Some(at) = out.iter().position(|value| !value.is_finite()) {
            let (image, texel) = (at / 3 / texels.len(), texels.start + at / 3 % texels.len());
            let (column, row) = (texel % self.layout.width, texel / self.layout.width);
            let place = format!("image {image}, column {column}, row {row}");
            return Err(FormatError::Missing {
                what: format!("usable value in {place}: it is {}", out[at]),
                expected: "finite numbers".to_owned(),
            }
            .into());
        }
        out.iter_mut().for_each(|value| *value = value.max(0.0));
        Ok(())
    }
}
