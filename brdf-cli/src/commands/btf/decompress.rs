//! `brdf btf decompress`.

use std::io::Write;

use brdf_report::percent;
use btf_io::{DecompressReport, UboWriter, write_decompressed};

use super::loading::ModelArgs;
use crate::outputs::{FolderArgs, show};
use crate::progress::Watch;

/// Write the images of a compressed BTF
///
/// 81 views under 81 lights in the layout of UBO2003, JPEG of quality 95; linear radiance is encoded
/// in sRGB with 1 as white, and what is brighter is clipped and counted.
///
/// Example: brdf btf decompress wool.btfvq -o wool-again
#[derive(clap::Args)]
#[command(mut_arg("output", |arg| arg.default_value("btf")))]
pub(in crate::commands) struct Decompress {
    #[command(flatten)]
    model: ModelArgs,

    #[command(flatten)]
    folder: FolderArgs,

    /// Print report.json on standard output
    #[arg(long)]
    json: bool,
}

impl Decompress {
    pub(in crate::commands) fn run(self, out: &mut impl Write) -> anyhow::Result<()> {
        let model = self.model.open()?;
        let reader = model.reader()?;
        let (width, height) = reader.size(0);
        let mut writer = UboWriter::new(&self.folder.output, width, height, self.folder.force)?;
        let watch = Watch::start();
        let written = watch.run(|job| write_decompressed(&reader, &mut writer, job))?;
        drop(watch);
        let report = DecompressReport::new(env!("CARGO_PKG_VERSION"), [width, height], &written);
        let json = serde_json::to_string_pretty(&report)?;
        let place = writer.finish(&json)?;
        show(out, self.json, &report, || {
            let (place, clipped) = (place.display(), percent(report.clipped));
            format!("{place}: {} images, {clipped} clipped\n", report.images)
        })
    }
}
