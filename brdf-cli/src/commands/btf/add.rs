//! `brdf btf add`.

use std::io::Write;
use std::path::PathBuf;
use std::time::Instant;

use anyhow::{Context as _, bail};
use brdf_container::open_compressed_btf;
use btf_vq::{Base, BtfModel};

use super::encoding::{SizeArgs, Target};
use super::inputs::Inputs;
use super::loading::MemoryArgs;
use crate::outputs::ForceArgs;
use crate::progress::Watch;

/// Add textures to a compressed BTF, in its books
///
/// Rows that the books have stay as they are and serve the new textures where they fit; new rows are
/// appended, in the way in which the books were made. --ratio is that of the new textures to the bytes
/// that they add. Indices become wider where they have to, and scales are quantized again over all.
///
/// Example: brdf btf add wool.btfvq bricks -o both.btfvq
#[derive(clap::Args)]
pub(in crate::commands) struct Add {
    /// Compressed BTF
    model: PathBuf,

    /// BTFs, or BRDFs, as `brdf btf compress` takes them
    #[arg(required = true, value_name = "IN")]
    inputs: Vec<PathBuf>,

    /// Compressed BTF to write; it may be MODEL itself, with --force
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,

    #[command(flatten)]
    sizes: SizeArgs,

    /// Store coarser levels too
    #[arg(long)]
    mipmaps: bool,

    #[command(flatten)]
    memory: MemoryArgs,

    #[command(flatten)]
    force: ForceArgs,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl Add {
    pub(in crate::commands) fn run(self, out: &mut impl Write) -> anyhow::Result<()> {
        let start = Instant::now();
        let file = open_compressed_btf(&self.model)?;
        let BtfModel::Vq(model) = &file.model else {
            bail!(
                "{}: local principal components share nothing; compress the other textures apart",
                self.model.display()
            );
        };
        let settings = self.sizes.settings(file.made.mode)?;
        let (books, textures) = model.unpack();
        let watch = Watch::start();
        let inputs = Inputs::open(&self.inputs, self.memory, &watch)?;
        let added = inputs.textures(books.grid.into(), self.mipmaps, &watch)?;
        let base = Base { books, textures, made: file.made.clone(), bytes: file.bytes };
        let target = Target { output: &self.output, force: self.force, json: self.json, start };
        target
            .compress(&added, &settings, Some(&base), watch, out)
            .with_context(|| self.model.display().to_string())
    }
}
