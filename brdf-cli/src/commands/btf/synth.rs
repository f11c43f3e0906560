//! `brdf btf synth`.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use anyhow::Context as _;
use brdf_io::{UboWriter, WrittenImages, read_albedo, read_map};
use btf_synth::{
    LIGHT_COUNT, Map, Reflectance, SurfaceMaps, SurfaceScene, SynthOptions, heights_from_normals,
};
use clap::ValueEnum;
use serde::Serialize;

use crate::args::{not_negative, usage};
use crate::numbers::{percent, significant};
use crate::progress::Progress;

/// Synthesize the images of a surface from its maps
///
/// A virtual gonioreflectometer: a height field with albedo and roughness, repeated in both
/// directions, is seen from the 81 directions of the UBO2003 measurements under lights from the
/// same 81, with shadows, occlusion and one diffuse bounce; images are rectified to the mean height.
/// The folder has the layout of those measurements: tvTTT_pvPPP/NNNNN tlTTT plPPP tvTTT pvPPP.jpg,
/// degrees, sRGB, 1 for a white diffuser that faces the light. Maps are PNG or JPEG of any sizes;
/// each is scaled to the images' size as a whole.
///
/// Example: brdf btf synth --height wool_depth.png --albedo wool_albedo.png -o wool
#[derive(clap::Args)]
#[command(group(clap::ArgGroup::new("relief").required(true).args(["height", "normal"])))]
pub(in crate::commands) struct Synth {
    /// Map of heights, white on top
    #[arg(long, value_name = "FILE")]
    height: Option<PathBuf>,

    /// Map of colours, sRGB
    #[arg(long, value_name = "FILE")]
    albedo: PathBuf,

    /// Map of normals, green up; heights are integrated from it, instead of --height
    #[arg(long, value_name = "FILE")]
    normal: Option<PathBuf>,

    /// Roughness from 0 to 1, or a map of it
    #[arg(long, value_name = "NUMBER|FILE", default_value = "0.6")]
    roughness: String,

    /// Channel of the roughness map
    #[arg(long, value_enum, default_value_t = ChannelArg::G)]
    roughness_channel: ChannelArg,

    /// Height of white over black in the map, as a share of the tile's width; of heights made from
    /// normals, of the highest point over the lowest
    #[arg(long, value_name = "SHARE", default_value_t = 0.06, value_parser = not_negative)]
    height_scale: f64,

    /// Turn hills into valleys
    #[arg(long)]
    invert: bool,

    /// Folder to write; one that brdf wrote is replaced
    #[arg(short, long, value_name = "FOLDER", default_value = "btf")]
    output: PathBuf,

    /// Side of the images in texels
    #[arg(long, default_value_t = 256, value_parser = clap::value_parser!(u16).range(1..=1024))]
    size: u16,

    /// Samples per texel
    #[arg(long, default_value_t = SynthOptions::default().samples,
        value_parser = clap::value_parser!(u32).range(1..=4096))]
    samples: u32,

    /// Rays per texel that gather light from the rest of the surface; 0 for direct light alone
    #[arg(long, default_value_t = SynthOptions::default().bounce_rays,
        value_parser = clap::value_parser!(u32).range(0..=4096))]
    bounce_rays: u32,

    /// Write into a folder that holds other files
    #[arg(long)]
    force: bool,

    /// Print report.json on standard output
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ChannelArg {
    /// Red
    R,
    /// Green
    G,
    /// Blue
    B,
}

/// Reflectance at normal incidence of most dielectrics (index of refraction 1.5).
const F0: f32 = 0.04;

#[derive(Serialize)]
struct Report {
    brdf: &'static str,
    images: usize,
    size: u16,
    seconds: f64,
    /// Share of the values that were clipped.
    clipped: f64,
    peak: f32,
    bytes: u64,
    /// Lowest and highest point in units of the tile's width.
    height_range: [f32; 2],
    height_scale: f64,
    samples: u32,
    bounce_rays: u32,
    height: Option<PathBuf>,
    albedo: PathBuf,
    normal: Option<PathBuf>,
    roughness: String,
    invert: bool,
}

impl Synth {
    pub(in crate::commands) fn run(self, out: &mut impl Write) -> anyhow::Result<ExitCode> {
        let start = Instant::now();
        let maps = self.surface()?;
        let options = SynthOptions { samples: self.samples, bounce_rays: self.bounce_rays };
        let mut writer = UboWriter::new(&self.output, maps.width(), maps.height(), self.force)?;
        let progress = Progress::new(LIGHT_COUNT as u64);
        progress.step("shadows and bounces");
        let scene = SurfaceScene::new(&maps, Reflectance::Ggx { f0: F0 }, &options)?;
        let mut images = vec![0.0; 3 * LIGHT_COUNT * scene.width() * scene.height()];
        for view in 0..LIGHT_COUNT {
            progress.step(format!("view {} of {LIGHT_COUNT}", view + 1));
            scene.synthesize_view(view, &mut images);
            writer.write_view(view, &images)?;
            progress.done(1);
        }
        drop(progress);
        let report = self.report(&maps, &writer.written(), start.elapsed().as_secs_f64());
        let json = serde_json::to_string_pretty(&report)?;
        let place = writer.finish(&json)?;
        if self.json {
            writeln!(out, "{json}")?;
        } else {
            print(&report, &place, out)?;
        }
        Ok(ExitCode::SUCCESS)
    }

    /// The surface that the maps describe.
    fn surface(&self) -> anyhow::Result<SurfaceMaps> {
        let size = usize::from(self.size);
        let heights = self.heights()?;
        let albedo = read_albedo(&self.albedo)?;
        let roughness = self.roughness()?;
        Ok(SurfaceMaps::from_maps(size, &heights, &albedo, &roughness)?)
    }

    /// Heights in units of the tile's width.
    fn heights(&self) -> anyhow::Result<Map> {
        #[expect(clippy::cast_possible_truncation, reason = "heights are stored as f32")]
        let scale = self.height_scale as f32;
        // Normals know no scale: their heights are stretched to it. Those of a map count from black.
        let heights = match (&self.height, &self.normal) {
            (Some(path), _) => first(read_map(path)?).scaled(scale),
            (None, Some(path)) => normal_heights(path)?.stretched(scale),
            (None, None) => return Err(usage("expected --height or --normal")),
        };
        Ok(if self.invert { heights.inverted() } else { heights })
    }

    fn roughness(&self) -> anyhow::Result<Map> {
        if let Ok(value) = self.roughness.parse::<f32>() {
            if !(0.0..=1.0).contains(&value) {
                return Err(usage(format!("--roughness {value}: expected 0 to 1, or a file")));
            }
            return Ok(Map::constant(1, 1, value)?);
        }
        let mut channels = read_map(Path::new(&self.roughness))?;
        // A grey map has one channel, which every choice means.
        let index = (self.roughness_channel as usize).min(channels.len() - 1);
        Ok(channels.swap_remove(index))
    }

    fn report(&self, maps: &SurfaceMaps, written: &WrittenImages, seconds: f64) -> Report {
        let range = maps
            .heights()
            .iter()
            .fold([0.0_f32; 2], |[low, high], &height| [low.min(height), high.max(height)]);
        Report {
            brdf: env!("CARGO_PKG_VERSION"),
            images: written.images,
            size: self.size,
            seconds,
            clipped: written.clipped_share(),
            peak: written.peak,
            bytes: written.bytes,
            height_range: range,
            height_scale: self.height_scale,
            samples: self.samples,
            bounce_rays: self.bounce_rays,
            height: self.height.clone(),
            albedo: self.albedo.clone(),
            normal: self.normal.clone(),
            roughness: self.roughness.clone(),
            invert: self.invert,
        }
    }
}

/// Of a coloured map of heights the first channel stands for all.
fn first(mut channels: Vec<Map>) -> Map {
    channels.swap_remove(0)
}

fn normal_heights(path: &Path) -> anyhow::Result<Map> {
    let channels: [Map; 3] = read_map(path)?
        .try_into()
        .ok()
        .with_context(|| format!("{}: a grey image; expected normals", path.display()))?;
    Ok(heights_from_normals(&channels)?)
}

fn print(report: &Report, place: &Path, out: &mut impl Write) -> std::io::Result<()> {
    let [low, high] = report.height_range;
    writeln!(
        out,
        "{} images of {}² texels in {} s, {} MB",
        report.images,
        report.size,
        significant(report.seconds),
        report.bytes / 1_000_000
    )?;
    writeln!(out, "heights from {low:.4} to {high:.4} of the tile's width, mean 0")?;
    writeln!(
        out,
        "clipped: {} of the values; the largest is {}",
        percent(report.clipped),
        significant(f64::from(report.peak))
    )?;
    writeln!(out, "{}", place.display())
}
