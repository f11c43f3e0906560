//! `brdf btf compress`.

use std::io::Write;
use std::path::PathBuf;
use std::time::Instant;

use btf_vq::{GridChoice, LightParametrization};

use super::encoding::{ModeArg, SizeArgs, Target};
use super::inputs::Inputs;
use super::loading::MemoryArgs;
use crate::outputs::ForceArgs;
use crate::progress::Watch;

/// Compress BTFs, or BRDFs, into nested codebooks
///
/// `refined` (the default) clusters texels and slices at every level and fills the bytes that --ratio
/// leaves. `paper` is multi-level vector quantization as published: exemplars come in Halton order and
/// --epsilon or --budget decide how many. `lpca` stores local principal components in bytes: a rival
/// that is as randomly readable. Several inputs share one set of books. Equal inputs and options give
/// equal bytes, whatever the number of threads.
///
/// BRDFs (anything that `brdf info` reads; a .npz archive is all its materials) become textures of one
/// texel, in linear radiance with the light's cosine; --ratio counts 90 × 90 × 180 × 3 floats of each.
///
/// Example: brdf btf compress wool -o wool.btfvq --ratio 700
#[derive(clap::Args)]
pub(in crate::commands) struct Compress {
    /// BTFs: folders or ZIP archives of images, or .btf files; or BRDFs
    #[arg(required = true, value_name = "IN")]
    inputs: Vec<PathBuf>,

    /// Compressed BTF to write
    #[arg(short, long, value_name = "FILE", default_value = "material.btfvq")]
    output: PathBuf,

    /// How books are made
    #[arg(long, value_enum, default_value_t = ModeArg::Refined)]
    mode: ModeArg,

    #[command(flatten)]
    sizes: SizeArgs,

    /// How light directions are laid out
    #[arg(long, value_enum, default_value_t = ParametrizationArg::Corrected)]
    parametrization: ParametrizationArg,

    /// Nodes along α, β, θv and φv [default: 11,11,7,16; 91,91,45,1 for BRDFs]
    #[arg(long, value_name = "A,B,T,P", value_parser = nodes)]
    grid: Option<[usize; 4]>,

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

choices! {
    enum ParametrizationArg for LightParametrization {
        /// The mirror direction in the middle of every slice
        Corrected => Corrected,
        /// Equation 3 of the paper as printed
        Eq3 => Eq3,
    }
}

fn nodes(text: &str) -> Result<[usize; 4], String> {
    let numbers: Result<Vec<usize>, _> = text.split(',').map(|n| n.trim().parse()).collect();
    let nodes = numbers.ok().and_then(|n| <[usize; 4]>::try_from(n).ok());
    nodes.ok_or_else(|| "expected four numbers, such as 11,11,7,16".to_owned())
}

impl Compress {
    pub(in crate::commands) fn run(self, out: &mut impl Write) -> anyhow::Result<()> {
        let start = Instant::now();
        let settings = self.sizes.settings(self.mode.into())?;
        let grid = GridChoice { nodes: self.grid, parametrization: self.parametrization.into() };
        let watch = Watch::start();
        let inputs = Inputs::open(&self.inputs, self.memory, &watch)?;
        let textures = inputs.textures(grid, self.mipmaps, &watch)?;
        let target = Target { output: &self.output, force: self.force, json: self.json, start };
        target.compress(&textures, &settings, None, watch, out)
    }
}
