//! `brdf completions`.

use std::io::Write;

use clap::CommandFactory as _;
use clap_complete::Shell;

use super::Cli;

/// Print a completion script for a shell
///
/// Example: brdf completions bash > ~/.local/share/bash-completion/completions/brdf
#[derive(clap::Args)]
pub(super) struct Completions {
    /// Which shell
    shell: Shell,
}

impl Completions {
    pub(super) fn run(self, out: &mut impl Write) -> anyhow::Result<()> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut Cli::command(), "brdf", &mut script);
        out.write_all(&script)?;
        Ok(())
    }
}
