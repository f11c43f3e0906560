//! How near a compressed BTF is to its images, and to BRDFs.

use brdf_image::SsimWorkspace;
use brdf_job::Job;
use brdf_model::{Brdf, Channels, cosine_rms, linear_to_srgb};
use glam::DVec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::TEXEL_BLOCK;
use crate::brdfs::{RadianceBrdf, tabulate};
use crate::colour::from_luma_chroma;
use crate::decode::Taps;
use crate::error::VqError;
use crate::grid::AngularGrid;
use crate::reader::{BtfModel, BtfReader};
use crate::resample::Resampler;
use crate::source::{BtfSource, Encoding};
use crate::texels::NodeTable;

/// The fidelity of decoded images to the original ones, in two measures.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Fidelity {
    /// Peak signal-to-noise ratio over all values in 8-bit sRGB, dB.
    pub psnr: f64,
    /// Structural similarity, mean over images.
    pub mssim: f64,
}

/// Returns the taps of the directions of every image of a source, in order.
pub fn image_taps(source: &dyn BtfSource, grid: &AngularGrid) -> Vec<Taps> {
    let views = source.layout().views.iter();
    views.flat_map(|view| view.lights.iter().map(|wi| Taps::new(grid, *wi, view.wo))).collect()
}

/// A display value of 8 bits.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to a byte")]
fn to_byte(value: f32, encoding: Encoding) -> u8 {
    let encoded = match encoding {
        Encoding::Srgb => value,
        Encoding::Linear => linear_to_srgb(value.max(0.0)),
    };
    (encoded * 255.0).round().clamp(0.0, 255.0) as u8
}

/// Texels as an image of bytes.
pub(crate) fn to_bytes(texels: &[[f32; 3]], encoding: Encoding, rgb: &mut [u8]) {
    for (target, value) in rgb.as_chunks_mut::<3>().0.iter_mut().zip(texels) {
        *target = value.map(|v| to_byte(v, encoding));
    }
}

/// Compares every `step`-th image of a source with another, 8-bit RGB, that `decode` makes. Work is counted in
/// images.
pub(crate) fn compare_images(
    source: &dyn BtfSource,
    step: usize,
    decode: &(dyn Fn(usize, &mut [u8]) + Sync),
    job: &Job<'_>,
) -> Result<Fidelity, VqError> {
    let layout = source.layout();
    let values = 3 * layout.texel_count();
    let chosen: Vec<usize> = (0..layout.image_count()).step_by(step).collect();
    job.begin("comparing", chosen.len() as u64);
    let start = || {
        let ssim = SsimWorkspace::new(layout.width, layout.height);
        (ssim, vec![0.0_f32; values], vec![0_u8; values], vec![0_u8; values])
    };
    let each: Vec<(u64, f64)> = chosen
        .par_iter()
        .map_init(start, |(ssim, wide, reference, other), at| {
            job.check()?;
            source.read_image(*at, wide).map_err(VqError::Source)?;
            for (byte, v) in reference.iter_mut().zip(&*wide) {
                *byte = to_byte(*v, layout.encoding);
            }
            decode(*at, other);
            let squares =
                reference.iter().zip(&*other).map(|(a, b)| u64::from(a.abs_diff(*b)).pow(2));
            let squares = squares.sum();
            job.advance(1);
            Ok((squares, ssim.mean_ssim(reference, other)))
        })
        .collect::<Result<_, VqError>>()?;
    let squares: u64 = each.iter().map(|e| e.0).sum();
    let (mse, mssim) = (
        squares as f64 / (values * each.len()) as f64,
        each.iter().map(|e| e.1).sum::<f64>() / each.len() as f64,
    );
    Ok(Fidelity { psnr: 10.0 * (255.0 * 255.0 / mse).log10(), mssim })
}

/// Compares a decoded texture with the images that it was made from: PSNR over all values of all images in 8-bit
/// sRGB, SSIM over all images. Linear images are encoded first, 1 as white.
///
/// # Errors
///
/// [`VqError::Mixed`] for another size; [`VqError::Source`]; [`VqError::Stopped`].
pub fn compare_texture(
    source: &dyn BtfSource,
    reader: &BtfReader<'_>,
    job: &Job<'_>,
) -> Result<Fidelity, VqError> {
    let (layout, size) = (source.layout(), reader.size(0));
    if size != (layout.width, layout.height) {
        return Err(VqError::Mixed {
            what: "sizes",
            found: format!("{} × {} texels", size.0, size.1),
            expected: format!("{} × {} as the images have", layout.width, layout.height),
        });
    }
    let taps = image_taps(source, reader.grid());
    let decoded = |at: usize, rgb: &mut [u8]| {
        let mut image = vec![[0.0; 3]; layout.texel_count()];
        reader.image(0, &taps[at], &mut image);
        to_bytes(&image, reader.encoding(), rgb);
    };
    compare_images(source, 1, &decoded, job)
}

/// Compares the images with texels that were resampled to the grid of a texture and not compressed. No compression
/// on this grid can come closer.
///
/// # Errors
///
/// [`VqError::Source`]; [`VqError::Header`] for directions that cannot be resampled; [`VqError::Stopped`].
pub fn resampling_floor(
    source: &dyn BtfSource,
    reader: &BtfReader<'_>,
    job: &Job<'_>,
) -> Result<Fidelity, VqError> {
    let [resampling, comparing] = job.split([1.0, 1.0]);
    let taps = image_taps(source, reader.grid());
    let (grid, encoding) = (*reader.grid(), reader.encoding());
    let resampler = Resampler::new(source.layout(), grid)?;
    let nodes = grid.node_count();
    let places: Vec<_> = taps.iter().map(|t| t.nodes(&grid)).collect();
    let texels = source.layout().texel_count();
    resampling.begin("resampling for the floor", texels as u64);
    let (blocks, _) = resampler.map_blocks(source, 0..texels, |texels, values| {
        if resampling.is_stopped() {
            return Vec::new();
        }
        let mut bytes = Vec::with_capacity(3 * texels.len() * places.len());
        for place in &places {
            for texel in values.chunks_exact(3 * nodes) {
                let mut sum = [0.0_f32; 3];
                for (node, weight) in place {
                    for (channel, sum) in sum.iter_mut().enumerate() {
                        *sum += weight * texel[channel * nodes + node];
                    }
                }
                let rgb = from_luma_chroma(encoding, sum);
                bytes.extend(rgb.map(|v| to_byte(v, encoding)));
            }
        }
        resampling.advance(texels.len() as u64);
        bytes
    })?;
    resampling.check()?;
    let images = places.len();
    let decoded = |at: usize, rgb: &mut [u8]| {
        for (target, block) in rgb.chunks_mut(3 * TEXEL_BLOCK).zip(&blocks) {
            let len = block.len() / images;
            target.copy_from_slice(&block[at * len..][..len]);
        }
    };
    compare_images(source, 1, &decoded, &comparing)
}

/// The error of a decoded BRDF over both hemispheres, weighted by the light's cosine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BrdfFidelity {
    /// Name of the texture.
    pub name: String,
    /// Root mean square error, sr⁻¹.
    pub rms: f64,
    /// Root mean square error over the root mean square of the BRDF.
    pub relative: f64,
    /// Relative error of the BRDF on the grid, not compressed; `None` where it was not asked for.
    pub floor: Option<f64>,
    /// Pairs that the BRDF has no data for.
    pub without_data: usize,
}

/// Of the pairs on which BRDFs are compared.
const SEED: u64 = 1;

/// Compares BRDFs with the textures of their names in a model.
///
/// # Errors
///
/// [`VqError::NoTexture`] for a BRDF that the model does not hold; [`VqError::Stopped`].
pub fn compare_brdfs(
    model: &BtfModel,
    brdfs: &[(String, &dyn Brdf)],
    has_floor: bool,
    job: &Job<'_>,
) -> Result<Vec<BrdfFidelity>, VqError> {
    let textures = model.textures();
    job.begin("comparing", brdfs.len() as u64);
    brdfs
        .par_iter()
        .map(|(name, brdf)| {
            job.check()?;
            let texture = textures.iter().position(|texture| texture.name == *name);
            let reader = texture.and_then(|at| Some((at, model.reader(at)?)));
            let Some((at, reader)) = reader else {
                return Err(VqError::NoTexture { name: name.clone() });
            };
            let rms = |radiance: &(dyn Fn(DVec3, DVec3) -> [f32; 3] + Send + Sync),
                       cosine_included| {
                let decoded = RadianceBrdf { radiance, cosine_included };
                cosine_rms(*brdf, &decoded, Channels::Rgb, SEED)
            };
            let decoded = rms(
                &|wi, wo| reader.linear(0, 0, &reader.taps(wi, wo)),
                textures[at].cosine_included,
            );
            let floor = if has_floor {
                let mut table = NodeTable::new(*reader.grid())?;
                tabulate(&mut table, *brdf)?;
                let grid = reader.grid();
                Some(rms(&|wi, wo| table.interpolate(0, &Taps::new(grid, wi, wo)), true))
            } else {
                None
            };
            job.advance(1);
            Ok(BrdfFidelity {
                name: name.clone(),
                rms: decoded.absolute,
                relative: decoded.relative,
                floor: floor.map(|floor| floor.relative),
                without_data: decoded.without_data,
            })
        })
        .collect()
}
