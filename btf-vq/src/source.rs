//! Where a BTF comes from: a set of images, one for each pair of view and light.

use std::ops::Range;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::SourceError;

/// Number of texels that go through the matrices together, as 192 columns; also the block of the sources' stores.
pub const TEXEL_BLOCK: usize = 64;

/// The meaning of the numbers of a BTF.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Encoding {
    /// Display-referred sRGB in [0, 1], as 8-bit images hold it.
    Srgb,
    /// Linear radiance, Rec. 709 primaries, 0 and above.
    Linear,
}

/// A viewing direction and the lights under which the material was seen from there.
#[derive(Clone, Debug, PartialEq)]
pub struct BtfView {
    /// Unit direction to the viewer, z along the normal of the sample plane.
    pub wo: DVec3,
    /// Unit directions to the lights, as they really stood; they need not be those of other views.
    pub lights: Vec<DVec3>,
}

/// Size and directions of a BTF, and the meaning of its values.
#[derive(Clone, Debug, PartialEq)]
pub struct BtfLayout {
    /// Texels in a row.
    pub width: usize,
    /// Rows; the first is the one with the largest y, as in an image seen from above.
    pub height: usize,
    /// Views in the order of the images.
    pub views: Vec<BtfView>,
    /// Meaning of the numbers.
    pub encoding: Encoding,
    /// Whether values contain the cosine of the light's polar angle.
    pub cosine_included: bool,
}

impl BtfLayout {
    /// Returns the number of images: for each view, one for each of its lights.
    pub fn image_count(&self) -> usize {
        self.views.iter().map(|view| view.lights.len()).sum()
    }

    /// Returns the number of texels of one image.
    pub fn texel_count(&self) -> usize {
        self.width * self.height
    }

    /// Returns the bytes of the raw images: 8 bits a channel, or 12 for linear radiance, as the paper counts.
    pub fn raw_bytes(&self) -> u64 {
        let values = 3 * self.image_count() as u64 * self.texel_count() as u64;
        match self.encoding {
            Encoding::Srgb => values,
            Encoding::Linear => values * 3 / 2,
        }
    }
}

/// A BTF that can be read block by block of texels: the seam between files, or formulas, and this crate.
pub trait BtfSource: Sync {
    /// Returns size and directions.
    fn layout(&self) -> &BtfLayout;

    /// Writes the values of consecutive texels (row-major) in all images into `out[image][texel][rgb]`, images view
    /// by view, each view's lights in order; as [`BtfLayout::encoding`] says.
    ///
    /// # Errors
    ///
    /// What the source says if it cannot be read.
    ///
    /// # Panics
    ///
    /// If `texels` goes past the last one or `out` has another size.
    fn read_texels(&self, texels: Range<usize>, out: &mut [f32]) -> Result<(), SourceError>;

    /// Writes a whole image into `out[texel][rgb]`. Sources that keep images together do this faster than by blocks.
    ///
    /// By itself it reads all images of each block of texels; sources that hold images should do better.
    ///
    /// # Errors
    ///
    /// What the source says if it cannot be read.
    ///
    /// # Panics
    ///
    /// If there is no such image or `out` has another size.
    fn read_image(&self, image: usize, out: &mut [f32]) -> Result<(), SourceError> {
        let layout = self.layout();
        let mut block = Vec::new();
        for (first, out) in (0..).step_by(TEXEL_BLOCK).zip(out.chunks_mut(3 * TEXEL_BLOCK)) {
            block.resize(layout.image_count() * out.len(), 0.0);
            self.read_texels(first..first + out.len() / 3, &mut block)?;
            out.copy_from_slice(&block[image * out.len()..][..out.len()]);
        }
        Ok(())
    }
}
