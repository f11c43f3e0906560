//! `brdf btf compare`.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::bail;
use brdf_io::{Btf, open_btf_model};
use brdf_model::{Channels, cosine_rms};
use btf_vq::colour::from_luma_chroma;
use btf_vq::{BtfReader, BtfSource, NodeTable, Resampler, TEXEL_BLOCK, Taps};
use glam::DVec3;
use rayon::prelude::*;
use serde_json::json;

use super::brdfs::{RAW_BYTES, RadianceBrdf, is_brdf, open_brdfs, tabulate, texture_name};
use super::fidelity::{Fidelity, all_taps, compare, to_byte, to_bytes};
use super::loading::{MemoryArgs, ModelArgs, OpenModel, load};
use crate::numbers::{bytes, significant};
use crate::progress::Progress;

/// Say how near a compressed BTF is to its images
///
/// PSNR over all values of all images in 8-bit sRGB; MSSIM over all images (11 × 11 Gaussian windows,
/// Y Cb Cr weighted .8 .1 .1). Linear images are encoded first, 1 as white. The floor is that of
/// the resampling alone: texels on the grid, not compressed.
///
/// BRDFs are compared with the textures of their names, by the cosine-weighted root mean square of
/// 80,000 pairs over that of the BRDF.
///
/// Example: brdf btf compare wool wool.btfvq
#[derive(clap::Args)]
pub(in crate::commands) struct Compare {
    /// BTF, or BRDFs as `brdf btf compress` takes them
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

/// How near a BRDF is, over both hemispheres, weighted by the light's cosine.
#[derive(Clone, Debug, serde::Serialize)]
struct BrdfFidelity {
    name: String,
    /// Root mean square, sr⁻¹.
    rms: f64,
    /// The same over that of the BRDF.
    relative: f64,
    /// The same of the BRDF on the grid, not compressed.
    floor: Option<f64>,
    /// Pairs that the BRDF has no data for.
    without_data: usize,
}

/// Of the pairs on which BRDFs are compared.
const SEED: u64 = 1;

impl Compare {
    pub(in crate::commands) fn run(self, out: &mut impl Write) -> anyhow::Result<ExitCode> {
        if is_brdf(&self.input) {
            return self.compare_brdfs(out);
        }
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
        let taps = all_taps(&source, reader.grid());
        let progress = Progress::new(if self.no_floor { 1 } else { 3 } * taps.len() as u64);
        progress.step("comparing");
        let decoded = |at: usize, rgb: &mut [u8]| {
            let mut image = vec![[0.0; 3]; layout.texel_count()];
            reader.image(0, &taps[at], &mut image);
            to_bytes(&image, reader.encoding(), rgb);
        };
        let fidelity = compare(&source, 1, &decoded, &progress)?;
        let floor = if self.no_floor {
            None
        } else {
            progress.step("resampling for the floor");
            Some(floor(&source, &reader, &taps, &progress)?)
        };
        drop(progress);
        self.report(&model, fidelity, floor, source.layout().raw_bytes(), out)
    }

    /// Every BRDF of the input with the texture of its name.
    fn compare_brdfs(&self, out: &mut impl Write) -> anyhow::Result<ExitCode> {
        let file = open_btf_model(&self.model.model)?;
        let textures = file.model.textures();
        let subjects = open_brdfs(&self.input)?;
        let progress = Progress::new(subjects.len() as u64);
        progress.step("comparing");
        let compared: anyhow::Result<Vec<BrdfFidelity>> = subjects
            .par_iter()
            .map(|subject| {
                let name = texture_name(subject);
                let texture = textures.iter().position(|texture| texture.name == name);
                let reader = texture.and_then(|at| Some((at, file.model.reader(at)?)));
                let Some((at, reader)) = reader else {
                    bail!("{}: no texture {name}", self.model.model.display());
                };
                let brdf = subject.brdf();
                let rms = |radiance: &(dyn Fn(DVec3, DVec3) -> [f32; 3] + Sync),
                           cosine_included| {
                    let decoded = RadianceBrdf { radiance, cosine_included };
                    cosine_rms(brdf, &decoded, Channels::Rgb, SEED)
                };
                let decoded = rms(
                    &|wi, wo| reader.linear(0, 0, &reader.taps(wi, wo)),
                    textures[at].cosine_included,
                );
                let floor = if self.no_floor {
                    None
                } else {
                    let mut table = NodeTable::new(*reader.grid())?;
                    tabulate(&mut table, brdf)?;
                    let grid = reader.grid();
                    Some(rms(&|wi, wo| table.interpolate(0, &Taps::new(grid, wi, wo)), true))
                };
                progress.done(1);
                Ok(BrdfFidelity {
                    name,
                    rms: decoded.absolute,
                    relative: decoded.relative,
                    floor: floor.map(|floor| floor.relative),
                    without_data: decoded.without_data,
                })
            })
            .collect();
        drop(progress);
        self.report_brdfs(&compared?, file.bytes, out)
    }

    fn report_brdfs(
        &self,
        brdfs: &[BrdfFidelity],
        size: usize,
        out: &mut impl Write,
    ) -> anyhow::Result<ExitCode> {
        let ratio = (RAW_BYTES * brdfs.len() as u64) as f64 / size as f64;
        let mean = |of: &dyn Fn(&BrdfFidelity) -> f64| {
            brdfs.iter().map(of).sum::<f64>() / brdfs.len().max(1) as f64
        };
        let (rms, relative) = (mean(&|b| b.rms), mean(&|b| b.relative));
        let floor = (!self.no_floor).then(|| mean(&|b| b.floor.unwrap_or(0.0)));
        if self.json {
            let report = json!({
                "input": self.input, "model": self.model.model, "rms": rms, "relative": relative,
                "floor": floor, "bytes": size, "ratio": ratio, "brdfs": brdfs,
            });
            writeln!(out, "{}", serde_json::to_string_pretty(&report)?)?;
            return Ok(ExitCode::SUCCESS);
        }
        writeln!(out, "{}: {} (1:{ratio:.0})", self.model.model.display(), bytes(size))?;
        writeln!(out, "  cosine-weighted RMS over that of the BRDF, and on the grid alone")?;
        let shown = |floor: Option<f64>| floor.map_or_else(String::new, significant);
        for brdf in brdfs {
            let (relative, floor) = (significant(brdf.relative), shown(brdf.floor));
            let holes = match brdf.without_data {
                0 => String::new(),
                count => format!("  {count} pairs without data"),
            };
            writeln!(out, "  {:24} {relative:>10} {floor:>10}{holes}", brdf.name)?;
        }
        writeln!(out, "  {:24} {:>10} {:>10}", "mean", significant(relative), shown(floor))?;
        Ok(ExitCode::SUCCESS)
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
    let blocks_in_all = source.layout().texel_count().div_ceil(TEXEL_BLOCK) as u64;
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
        for (target, block) in rgb.chunks_mut(3 * TEXEL_BLOCK).zip(&blocks) {
            let len = block.len() / images;
            target.copy_from_slice(&block[at * len..][..len]);
        }
    };
    compare(source, 1, &decoded, progress)
}
