//! `brdf btf decompress`.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use brdf_io::UboWriter;
use brdf_param::spherical_direction;
use btf_synth::{LIGHT_COUNT, ubo_directions};
use btf_vq::Encoding;
use btf_vq::colour::srgb_to_linear;
use rayon::prelude::*;
use serde_json::json;

use super::loading::ModelArgs;
use crate::numbers::percent;
use crate::progress::Progress;

/// Write the images of a compressed BTF
///
/// 81 views under 81 lights in the layout of UBO2003, JPEG of quality 95; linear radiance is encoded
/// in sRGB with 1 as white, and what is brighter is clipped and counted.
///
/// Example: brdf btf decompress wool.btfvq -o wool-again
#[derive(clap::Args)]
pub(in crate::commands) struct Decompress {
    #[command(flatten)]
    model: ModelArgs,

    /// Folder to write; one that brdf wrote is replaced
    #[arg(short, long, value_name = "FOLDER", default_value = "btf")]
    output: PathBuf,

    /// Write into a folder that holds other files
    #[arg(long)]
    force: bool,

    /// Print report.json on standard output
    #[arg(long)]
    json: bool,
}

impl Decompress {
    pub(in crate::commands) fn run(self, out: &mut impl Write) -> anyhow::Result<ExitCode> {
        let model = self.model.open()?;
        let reader = model.reader()?;
        let (width, height) = reader.size(0);
        let mut writer = UboWriter::new(&self.output, width, height, self.force)?;
        let directions: Vec<glam::DVec3> = ubo_directions()
            .iter()
            .map(|&(theta, phi)| {
                spherical_direction(f64::from(theta).to_radians(), f64::from(phi).to_radians())
            })
            .collect();
        let progress = Progress::new(LIGHT_COUNT as u64);
        let mut values = vec![0.0; LIGHT_COUNT * 3 * width * height];
        for (view, wo) in directions.iter().enumerate() {
            progress.step(format!("view {} of {LIGHT_COUNT}", view + 1));
            values.par_chunks_exact_mut(3 * width * height).zip(&directions).for_each(
                |(out, wi)| {
                    let mut image = vec![[0.0; 3]; width * height];
                    reader.image(0, &reader.taps(*wi, *wo), &mut image);
                    for (target, value) in out.as_chunks_mut::<3>().0.iter_mut().zip(image) {
                        *target = value.map(|v| match reader.encoding() {
                            Encoding::Srgb => srgb_to_linear(v.max(0.0)),
                            Encoding::Linear => v.max(0.0),
                        });
                    }
                },
            );
            writer.write_view(view, &values)?;
            progress.done(1);
        }
        drop(progress);
        let written = writer.written();
        let report = json!({
            "brdf": env!("CARGO_PKG_VERSION"),
            "images": written.images,
            "width": width,
            "height": height,
            "clipped": written.clipped_share(),
        });
        // The key by which the folder is known to be ours stands first.
        let report = serde_json::to_string_pretty(&report)?;
        let place = writer.finish(&report)?;
        if self.json {
            writeln!(out, "{report}")?;
        } else {
            let clipped = percent(written.clipped_share());
            writeln!(out, "{}: {} images, {clipped} clipped", place.display(), written.images)?;
        }
        Ok(ExitCode::SUCCESS)
    }
}
