//! `brdf btf synth`.

use std::io::Write;
use std::path::PathBuf;
use std::time::Instant;

use brdf_report::synth_text;
use btf_io::{
    Relief, Roughness, SurfaceFiles, SynthReport, UboWriter, read_surface, write_synthesized,
};
use btf_synth::SynthOptions;
use clap::ValueEnum;

use crate::args::{not_negative, usage};
use crate::outputs::{FolderArgs, show};
use crate::progress::Watch;

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
#[command(mut_arg("output", |arg| arg.default_value("btf")))]
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

    #[command(flatten)]
    folder: FolderArgs,

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

impl Synth {
    pub(in crate::commands) fn run(self, out: &mut impl Write) -> anyhow::Result<()> {
        let start = Instant::now();
        let files = self.files()?;
        let maps = read_surface(&files)?;
        let options = SynthOptions { samples: self.samples, bounce_rays: self.bounce_rays };
        let mut writer =
            UboWriter::new(&self.folder.output, maps.width(), maps.height(), self.folder.force)?;
        let watch = Watch::start();
        let written = watch.run(|job| write_synthesized(&maps, &options, &mut writer, job))?;
        drop(watch);
        let seconds = start.elapsed().as_secs_f64();
        let version = env!("CARGO_PKG_VERSION");
        let report = SynthReport::new(version, &files, &maps, &options, &written, seconds);
        let json = serde_json::to_string_pretty(&report)?;
        let place = writer.finish(&json)?;
        show(out, self.json, &report, || synth_text(&report, &place))
    }

    /// The files of the surface and how they are read.
    fn files(&self) -> anyhow::Result<SurfaceFiles> {
        let relief = match (&self.height, &self.normal) {
            (Some(path), _) => Relief::Heights(path.clone()),
            (None, Some(path)) => Relief::Normals(path.clone()),
            (None, None) => return Err(usage("expected --height or --normal")),
        };
        let roughness = match self.roughness.parse::<f32>() {
            Ok(value) if (0.0..=1.0).contains(&value) => Roughness::Constant(value),
            Ok(value) => {
                return Err(usage(format!("--roughness {value}: expected 0 to 1, or a file")));
            }
            Err(_) => Roughness::Map {
                path: PathBuf::from(&self.roughness),
                channel: self.roughness_channel as usize,
            },
        };
        Ok(SurfaceFiles {
            relief,
            albedo: self.albedo.clone(),
            roughness,
            size: self.size,
            height_scale: self.height_scale,
            is_inverted: self.invert,
        })
    }
}
