//! Surfaces from files of maps, and their images as a folder.

use std::path::{Path, PathBuf};

use brdf_files::FileError;
use brdf_io::FormatError;
use brdf_job::Job;
use btf_synth::{
    Map, Reflectance, SurfaceMaps, SurfaceScene, SynthError, SynthOptions, heights_from_normals,
};
use serde::Serialize;

use crate::maps::{read_albedo, read_map};
use crate::ubo_writer::{UboWriter, WrittenImages};

/// Reflectance at normal incidence of most dielectrics (index of refraction 1.5).
const F0: f32 = 0.04;

/// The relief of a surface: a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Relief {
    /// A map of heights, white on top.
    Heights(PathBuf),
    /// A map of normals, green up, from which heights are integrated.
    Normals(PathBuf),
}

/// The roughness of a surface, in [0, 1].
#[derive(Clone, Debug, PartialEq)]
pub enum Roughness {
    /// The same everywhere.
    Constant(f32),
    /// A channel of a map; a grey map has one, which every number means.
    Map {
        /// Path of the map.
        path: PathBuf,
        /// Number of the channel, from 0.
        channel: usize,
    },
}

/// The files of a surface, PNG or JPEG of any sizes, and how they are read.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceFiles {
    /// Heights or normals.
    pub relief: Relief,
    /// Colours, sRGB.
    pub albedo: PathBuf,
    /// Roughness of the surface.
    pub roughness: Roughness,
    /// Side of the images, texels.
    pub size: u16,
    /// Height of white over black, as a share of the tile's width; of heights made from normals, of the highest point
    /// over the lowest.
    pub height_scale: f64,
    /// Whether hills are turned into valleys.
    pub is_inverted: bool,
}

/// Problems of [`read_surface`] and [`write_synthesized`].
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SynthesisError {
    /// A file that cannot be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// Maps or options that make no surface.
    #[error(transparent)]
    Synth(#[from] SynthError),
}

/// Returns the surface that files describe.
///
/// # Errors
///
/// [`SynthesisError`].
pub fn read_surface(files: &SurfaceFiles) -> Result<SurfaceMaps, SynthesisError> {
    #[expect(clippy::cast_possible_truncation, reason = "heights are stored as f32")]
    let scale = files.height_scale as f32;
    // Normals know no scale: their heights are stretched to it. Those of a map count from black.
    let heights = match &files.relief {
        // Of a coloured map of heights the first channel stands for all.
        Relief::Heights(path) => read_map(path)?.swap_remove(0).scaled(scale),
        Relief::Normals(path) => heights_from_normals(&normals(path)?)?.stretched(scale),
    };
    let heights = if files.is_inverted { heights.inverted() } else { heights };
    let albedo = read_albedo(&files.albedo)?;
    let roughness = match &files.roughness {
        Roughness::Constant(value) => Map::constant(1, 1, *value)?,
        Roughness::Map { path, channel } => {
            let mut channels = read_map(path)?;
            let index = (*channel).min(channels.len() - 1);
            channels.swap_remove(index)
        }
    };
    Ok(SurfaceMaps::from_maps(usize::from(files.size), &heights, &albedo, &roughness)?)
}

fn normals(path: &Path) -> Result<[Map; 3], FileError> {
    read_map(path)?.try_into().map_err(|channels: Vec<Map>| {
        FileError::content(path)(FormatError::Missing {
            what: format!("normals in an image of {} channels", channels.len()),
            expected: "a colour image".to_owned(),
        })
    })
}

/// Writes the images of a dielectric surface from all views under all lights, and returns what was written.
///
/// # Errors
///
/// [`SynthesisError::Synth`] for options out of range; as [`UboWriter::write_views`].
pub fn write_synthesized(
    maps: &SurfaceMaps,
    options: &SynthOptions,
    writer: &mut UboWriter,
    job: &Job<'_>,
) -> Result<WrittenImages, SynthesisError> {
    let [preparing, views] = job.split([1.0, 9.0]);
    preparing.begin("shadows and bounces", 1);
    let scene = SurfaceScene::new(maps, Reflectance::Ggx { f0: F0 }, options)?;
    preparing.advance(1);
    Ok(writer.write_views(|view, out| scene.synthesize_view(view, out), &views)?)
}

/// `report.json` of a folder of synthesized images. The first key marks the folder as ours.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SynthReport {
    /// Version of the program.
    pub brdf: String,
    /// Number of images.
    pub images: usize,
    /// Side of the images, texels.
    pub size: u16,
    /// Time that the synthesis took, seconds.
    pub seconds: f64,
    /// Share of the values that were clipped, in [0, 1].
    pub clipped: f64,
    /// Largest value, before clipping.
    pub peak: f32,
    /// Bytes of all images.
    pub bytes: u64,
    /// Lowest and highest point in units of the tile's width.
    pub height_range: [f32; 2],
    /// Height of white over black, as a share of the tile's width.
    pub height_scale: f64,
    /// Samples per texel.
    pub samples: u32,
    /// Rays per texel that gathered light.
    pub bounce_rays: u32,
    /// The map of heights, if there was one.
    pub height: Option<PathBuf>,
    /// The map of colours.
    pub albedo: PathBuf,
    /// The map of normals, if there was one.
    pub normal: Option<PathBuf>,
    /// Roughness: a number, or the file of a map.
    pub roughness: String,
    /// Whether hills were turned into valleys.
    pub invert: bool,
}

impl SynthReport {
    /// Returns the report of a program of this version.
    pub fn new(
        version: &str,
        files: &SurfaceFiles,
        maps: &SurfaceMaps,
        options: &SynthOptions,
        written: &WrittenImages,
        seconds: f64,
    ) -> Self {
        let widened = |[low, high]: [f32; 2], &height: &f32| [low.min(height), high.max(height)];
        let (height, normal) = match &files.relief {
            Relief::Heights(path) => (Some(path.clone()), None),
            Relief::Normals(path) => (None, Some(path.clone())),
        };
        Self {
            brdf: version.to_owned(),
            images: written.images,
            size: files.size,
            seconds,
            clipped: written.clipped_share(),
            peak: written.peak,
            bytes: written.bytes,
            height_range: maps.heights().iter().fold([0.0; 2], widened),
            height_scale: files.height_scale,
            samples: options.samples,
            bounce_rays: options.bounce_rays,
            height,
            albedo: files.albedo.clone(),
            normal,
            roughness: match &files.roughness {
                Roughness::Constant(value) => value.to_string(),
                Roughness::Map { path, .. } => path.to_string_lossy().into_owned(),
            },
            invert: files.is_inverted,
        }
    }
}
