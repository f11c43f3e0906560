//! `brdf btf compare`.

use std::io::Write;
use std::path::PathBuf;

use anyhow::Context as _;
use brdf_container::{BrdfComparison, TextureComparison, open_compressed_btf};
use brdf_report::{brdf_comparison_text, texture_comparison_text};
use btf_vq::{BtfSource as _, compare_brdfs, compare_texture, resampling_floor};

use super::inputs::{is_brdf, named, open_brdfs};
use super::loading::{MemoryArgs, ModelArgs, load};
use crate::outputs::show;
use crate::progress::Watch;

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

impl Compare {
    pub(in crate::commands) fn run(self, out: &mut impl Write) -> anyhow::Result<()> {
        if is_brdf(&self.input) {
            return self.compare_brdfs(out);
        }
        let model = self.model.open()?;
        let watch = Watch::start();
        let source = load(&self.input, self.memory, &watch)?;
        let reader = model.reader()?;
        let (fidelity, floor) = watch
            .run(|job| {
                let [decoded, floor] = job.split([1.0, 2.0]);
                let fidelity = compare_texture(&source, &reader, &decoded)?;
                let has_floor = !self.no_floor;
                let floor = has_floor.then(|| resampling_floor(&source, &reader, &floor));
                Ok::<_, btf_vq::VqError>((fidelity, floor.transpose()?))
            })
            .with_context(|| self.model.model.display().to_string())?;
        drop(watch);
        let size = model.file.bytes;
        let comparison = TextureComparison {
            input: self.input.to_string_lossy().into_owned(),
            model: self.model.model.to_string_lossy().into_owned(),
            fidelity,
            floor,
            bytes: size,
            ratio: source.layout().raw_bytes() as f64 / size as f64,
        };
        show(out, self.json, &comparison, || texture_comparison_text(&comparison))
    }

    /// Every BRDF of the input with the texture of its name.
    fn compare_brdfs(&self, out: &mut impl Write) -> anyhow::Result<()> {
        let file = open_compressed_btf(&self.model.model)?;
        let files = open_brdfs(&self.input)?;
        let watch = Watch::start();
        let brdfs =
            watch.run(|job| compare_brdfs(&file.model, &named(&files), !self.no_floor, job));
        drop(watch);
        let model = self.model.model.to_string_lossy();
        let brdfs = brdfs.with_context(|| model.clone().into_owned())?;
        let comparison =
            BrdfComparison::new(&self.input.to_string_lossy(), &model, brdfs, file.bytes);
        show(out, self.json, &comparison, || brdf_comparison_text(&comparison))
    }
}
