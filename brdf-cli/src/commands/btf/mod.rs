//! `brdf btf`: bidirectional texture functions.

mod synth;

use std::io::Write;
use std::process::ExitCode;

use clap::Subcommand;

/// Work with bidirectional texture functions: images of a surface for pairs of view and light
#[derive(Subcommand)]
pub(super) enum Btf {
    Synth(synth::Synth),
}

impl Btf {
    pub(super) fn run(self, out: &mut impl Write) -> anyhow::Result<ExitCode> {
        match self {
            Self::Synth(command) => command.run(out),
        }
    }
}
