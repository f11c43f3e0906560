//! What a BTF holds, as far as its names and headers say.

use btf_vq::Encoding;
use serde::Serialize;

use crate::image_set::BtfNotes;
use crate::input::BtfInput;

/// Size, directions and meaning of a BTF, as its names and headers give them.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BtfInfo {
    /// Kind of the BTF: `binary BTF` or `set of images`.
    pub kind: &'static str,
    /// Texels in a row.
    pub width: usize,
    /// Rows of texels.
    pub height: usize,
    /// Number of views.
    pub views: usize,
    /// Largest number of lights of a view.
    pub lights: Option<usize>,
    /// Number of images.
    pub images: usize,
    /// Meaning of the values: `sRGB, 8 bits` or `linear radiance`.
    pub encoding: &'static str,
    /// Whether values contain the cosine of the light's polar angle.
    pub cosine_included: bool,
    /// Bytes of the raw images, as the paper counts.
    pub raw_bytes: u64,
    /// Facts that are unusual, in sentences.
    pub notes: Vec<String>,
}

impl BtfInput {
    /// Returns size, directions and meaning of the BTF.
    pub fn info(&self) -> BtfInfo {
        let layout = self.layout();
        BtfInfo {
            kind: match self {
                Self::File(_) => "binary BTF",
                Self::Images(_) => "set of images",
            },
            width: layout.width,
            height: layout.height,
            views: layout.views.len(),
            lights: layout.views.iter().map(|view| view.lights.len()).max(),
            images: layout.image_count(),
            encoding: match layout.encoding {
                Encoding::Srgb => "sRGB, 8 bits",
                Encoding::Linear => "linear radiance",
            },
            cosine_included: layout.cosine_included,
            raw_bytes: layout.raw_bytes(),
            notes: self.notes().map_or_else(Vec::new, BtfNotes::sentences),
        }
    }
}
