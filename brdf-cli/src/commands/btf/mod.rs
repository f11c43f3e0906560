//! `brdf btf`: bidirectional texture functions.

mod add;
mod compare;
mod compress;
mod decompress;
mod encoding;
mod eval;
mod info;
mod inputs;
mod loading;
mod render;
mod sample;
mod study;
mod synth;

use std::io::Write;

use clap::Subcommand;

/// Work with bidirectional texture functions (BTFs): images of a surface for pairs of view and light
///
/// IN is a folder or ZIP archive of images named by angles (UBO2003, ATRIUM, UTIA) or a .btf file
/// (UBO2014). MODEL is what `brdf btf compress` wrote.
#[derive(Subcommand)]
pub(super) enum Btf {
    Synth(synth::Synth),
    Info(info::Info),
    Compress(compress::Compress),
    Add(add::Add),
    Compare(compare::Compare),
    Decompress(decompress::Decompress),
    Eval(eval::Eval),
    Sample(sample::Sample),
    Render(render::Render),
    Study(study::Study),
}

impl Btf {
    pub(super) fn run(self, out: &mut impl Write) -> anyhow::Result<()> {
        match self {
            Self::Synth(command) => command.run(out),
            Self::Info(command) => command.run(out),
            Self::Compress(command) => command.run(out),
            Self::Add(command) => command.run(out),
            Self::Compare(command) => command.run(out),
            Self::Decompress(command) => command.run(out),
            Self::Eval(command) => command.run(out),
            Self::Sample(command) => command.run(out),
            Self::Render(command) => command.run(out),
            Self::Study(command) => command.run(out),
        }
    }
}
