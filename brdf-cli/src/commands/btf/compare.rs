//! `brdf btf compare`.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{anyhow, bail};
use brdf_io::Btf;
use brdf_render::SsimWorkspace;
use btf_vq::colour::{from_luma_chroma, linear_to_srgb};
use btf_vq::{BLOCK, BtfReader, BtfSource, Encoding, Resampler, Taps};
use rayon::prelude::*;
use serde_json::json;

use super::loading::{MemoryArgs, ModelArgs, OpenModel, load};
use crate::numbers::{bytes, significant};
use crate::progress::Progress;

/// Say how near a compressed BTF is to its images
///
/// PSNR over all values of all images in 8-bit sRGB; MSSIM over all images (11 × 11 Gaussian windows,
/// Y Cb Cr weighted .8 .1 .1). Linear images are encoded first, 1 as white. The floor is that of
/// the resampling alone: texels on the grid, not compressed.
///
/// Example: brdf btf compare wool wool.btfvq
#[derive(clap::Args)]
pub(in crate::commands) struct Compare {
    /// BTF
    #[arg(value_name = "IN")]
    input: PathBuf,

    #[command(flatten)]
    model: ModelArgs,

    /// Leave out the floor, which takes most of the time
    #[arg(long)]
    no_floor: bool,

    #[command(flatten)]
    memory: MemoryArgs,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// How near images are.
#[derive(Clone, Copy, Debug, serde::Serialize)]
struct Fidelity {
    psnr: f64,
    mssim: f64,
}

impl Compare {
    pub(in crate::commands) fn run(self, out: &mut impl Write) -> anyhow::Result<ExitCode> {
        let model = self.model.open()?;
        let source = load(&self.input, self.memory)?;
        let reader = model.reader()?;
        let (layout, size) = (source.layout(), reader.size(0));
        if size != (layout.width, layout.height) {
            bail!(
                "{}: textures of {} × {} texels; expected {} × {} as in {}",
                self.model.model.display(),
                size.0,
                size.1,
                layout.width,
                layout.height,
                self.input.display()
            );
        }
        let taps = all_taps(&source, &reader);
        let progress = Progress::new(if self.no_floor { 1 } else { 3 } * taps.len() as u64);
        progress.step("comparing");
        let decoded = |at: usize, rgb: &mut [u8]| {
            let mut image = vec![[0.0; 3]; layout.texel_count()];
            reader.image(0, &taps[at], &mut image);
            for (target, value) in rgb.as_chunks_mut::<3>().0.iter_mut().zip(image) {
                *target = value.map(|v| to_byte(v, reader.encoding()));
            }
        };
        let fidelity = compare(&source, &decoded, &progress)?;
        let floor = if self.no_floor {
            None
        } else {
            progress.step("resampling for the floor");
            Some(floor(&source, &reader, &taps, &progress)?)
        };
        drop(progress);
        self.report(&model, fidelity, floor, source.layout().raw_bytes(), out)
    }

    fn report(
        &self,
        model: &OpenModel,
        fidelity: Fidelity,
        floor: Option<Fidelity>,
        raw_bytes: u64,
        out: &mut impl Write,
    ) -> anyhow::Result<ExitCode> {
        let size = model.file.bytes;
        #[expect(clippy::cast_precision_loss, reason = "a ratio")]
        let ratio = raw_bytes as f64 / size as f64;
        if self.json {
            let report = json!({
                "input": self.input, "model": self.model.model,
                "psnr": fidelity.psnr, "mssim": fidelity.mssim, "floor": floor,
                "bytes": size, "ratio": ratio,
            });
            writeln!(out, "{}", serde_json::to_string_pretty(&report)?)?;
            return Ok(ExitCode::SUCCESS);
        }
        let shown = |f: Fidelity| {
            format!("PSNR {} dB, MSSIM {}", significant(f.psnr), significant(f.mssim))
        };
        writeln!(out, "{}: {} (1:{ratio:.0})", self.model.model.display(), bytes(size))?;
        writeln!(out, "  {}", shown(fidelity))?;
        if let Some(floor) = floor {
            writeln!(out, "  {} at best, by the resampling alone", shown(floor))?;
        }
        Ok(ExitCode::SUCCESS)
    }
}

/// Where the directions of every image lie.
fn all_taps(source: &Btf, reader: &BtfReader<'_>) -> Vec<Taps> {
    let views = source.layout().views.iter();
    views.flat_map(|view| view.lights.iter().map(|wi| reader.taps(*wi, view.wo))).collect()
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to a byte")]
fn to_byte(value: f32, encoding: Encoding) -> u8 {
    let encoded = match encoding {
        Encoding::Srgb => value,
        Encoding::Linear => linear_to_srgb(value.max(0.0)),
    };
    (encoded * 255.0).round().clamp(0.0, 255.0) as u8
}

/// Compares all images of a source with others, 8-bit RGB, that `decode` makes.
fn compare(
    source: &Btf,
    decode: &(dyn Fn(usize, &mut [u8]) + Sync),
    progress: &Progress,
) -> anyhow::Result<Fidelity> {
    let layout = source.layout();
    let (images, values) = (layout.image_count(), 3 * layout.texel_count());
    let start = || {
        let ssim = SsimWorkspace::new(layout.width, layout.height);
        (ssim, vec![0.0_f32; values], vec![0_u8; values], vec![0_u8; values])
    };
    let each: Result<Vec<(u64, f64)>, btf_vq::SourceError> = (0..images)
        .into_par_iter()
        .map_init(start, |(ssim, wide, reference, other), at| {
            source.read_image(at, wide)?;
            for (byte, v) in reference.iter_mut().zip(&*wide) {
                *byte = to_byte(*v, layout.encoding);
            }
            decode(at, other);
            let squares =
                reference.iter().zip(&*other).map(|(a, b)| u64::from(a.abs_diff(*b)).pow(2));
            let squares = squares.sum();
            progress.done(1);
            Ok((squares, ssim.mean_ssim(reference, other)))
        })
        .collect();
    let each = each.map_err(|e| anyhow!(e))?;
    let squares: u64 = each.iter().map(|e| e.0).sum();
    #[expect(clippy::cast_precision_loss, reason = "means")]
    let (mse, mssim) = (
        squares as f64 / (values * images) as f64,
        each.iter().map(|e| e.1).sum::<f64>() / images as f64,
    );
    Ok(Fidelity { psnr: 10.0 * (255.0 * 255.0 / mse).log10(), mssim })
}

/// The same of texels that were resampled and not compressed.
fn floor(
    source: &Btf,
    reader: &BtfReader<'_>,
    taps: &[Taps],
    progress: &Progress,
) -> anyhow::Result<Fidelity> {
    let (grid, encoding) = (*reader.grid(), reader.encoding());
    let resampler = Resampler::new(source.layout(), grid)?;
    let nodes = grid.node_count();
    let places: Vec<_> = taps.iter().map(|t| t.nodes(&grid)).collect();
    let blocks_in_all = source.layout().texel_count().div_ceil(BLOCK) as u64;
    let (blocks, _) =
        resampler.map_blocks(source, 0..source.layout().texel_count(), |texels, values| {
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
            progress.done(places.len() as u64 / blocks_in_all);
            bytes
        })?;
    progress.step("comparing with the floor");
    let images = places.len();
    let decoded = |at: usize, rgb: &mut [u8]| {
        for (target, block) in rgb.chunks_mut(3 * BLOCK).zip(&blocks) {
            let len = block.len() / images;
            target.copy_from_slice(&block[at * len..][..len]);
        }
    };
    compare(source, &decoded, progress)
}
