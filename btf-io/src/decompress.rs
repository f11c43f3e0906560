//! Compressed BTFs as folders of images again.

use brdf_files::FileError;
use brdf_job::Job;
use brdf_param::spherical_direction;
use btf_synth::ubo_directions;
use btf_vq::BtfReader;
use glam::DVec3;
use serde::Serialize;

use crate::ubo_writer::{UboWriter, WrittenImages};

/// `report.json` of a folder of decompressed images. The first key marks the folder as ours.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DecompressReport {
    /// Version of the program.
    pub brdf: String,
    /// Number of images.
    pub images: usize,
    /// Texels in a row.
    pub width: usize,
    /// Rows of texels.
    pub height: usize,
    /// Share of values that were clipped, in [0, 1].
    pub clipped: f64,
}

impl DecompressReport {
    /// Returns the report on what a program of this version wrote.
    pub fn new(version: &str, [width, height]: [usize; 2], written: &WrittenImages) -> Self {
        let (images, clipped) = (written.images, written.clipped_share());
        Self { brdf: version.to_owned(), images, width, height, clipped }
    }
}

/// Writes the finest level of a texture from the 81 views of [`ubo_directions`] under lights from the same 81, and
/// returns what was written.
///
/// # Errors
///
/// As [`UboWriter::write_views`].
pub fn write_decompressed(
    reader: &BtfReader<'_>,
    writer: &mut UboWriter,
    job: &Job<'_>,
) -> Result<WrittenImages, FileError> {
    let direction = |(theta, phi): (u32, u32)| {
        spherical_direction(f64::from(theta).to_radians(), f64::from(phi).to_radians())
    };
    let directions: Vec<DVec3> = ubo_directions().into_iter().map(direction).collect();
    writer.write_views(|view, out| reader.linear_images(0, directions[view], &directions, out), job)
}
