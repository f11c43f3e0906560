//! `brdf btf add`.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use anyhow::bail;
use brdf_io::open_btf_model;
use btf_vq::BtfModel;

use super::encoding::{Job, ModeArg, SizeArgs, Start};
use super::inputs::Inputs;
use super::loading::MemoryArgs;
use crate::args::ForceArgs;

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
    pub(in crate::commands) fn run(self, out: &mut impl Write) -> anyhow::Result<ExitCode> {
        let start = Instant::now();
        let file = open_btf_model(&self.model)?;
        let BtfModel::Vq(model) = &file.model else {
            bail!(
                "{}: local principal components share nothing; compress the other textures apart",
                self.model.display()
            );
        };
        let (books, materials) = model.unpack();
        let mode = if file.made.mode == "paper" { ModeArg::Paper } else { ModeArg::Refined };
        self.sizes.check(mode)?;
        let inputs = Inputs::open(&self.inputs, books.grid.into(), self.mipmaps, self.memory)?;
        if let Some(name) = materials
            .iter()
            .map(|m| &m.info.name)
            .find(|name| inputs.infos.iter().any(|info| info.name == **name))
        {
            bail!("{}: has a texture {name} already; rename the input", self.model.display());
        }
        inputs.with_sets(|sets| {
            match sets.iter().find(|set| set.encoding() != books.encoding) {
                Some(set) => bail!(
                    "{}: values are {:?}; those of the inputs are {:?}",
                    self.model.display(),
                    books.encoding,
                    set.encoding()
                ),
                None => Ok(()),
            }
        })?;
        let start_from = Start { books, materials, made: file.made.clone(), bytes: file.bytes };
        let job = Job { mode, sizes: &self.sizes, inputs: &inputs, start: Some(start_from) };
        job.run(&self.output, &self.force, self.json, start, out)
    }
}
