//! `brdf relight`: objects under light from everywhere.

mod bench;
mod compare;
mod loading;
mod precompute;
mod render;
mod sweep;
mod turntable;

use std::io::Write;

use clap::Subcommand;

/// Relight an object under environment maps, shadows included
///
/// `precompute` finds how the object answers light from everywhere and takes a minute or so; after that, new light and
/// new views take milliseconds: `render`, `turntable`. `bench` times them, `compare` says what was lost, and
/// `sweep` shows it.
#[derive(Subcommand)]
pub(super) enum Relight {
    Precompute(precompute::Precompute),
    Render(render::Render),
    Turntable(turntable::Turntable),
    Bench(bench::Bench),
    Compare(compare::Compare),
    Sweep(sweep::Sweep),
}

impl Relight {
    pub(super) fn run(self, out: &mut impl Write) -> anyhow::Result<()> {
        match self {
            Self::Precompute(command) => command.run(out),
            Self::Render(command) => command.run(out),
            Self::Turntable(command) => command.run(out),
            Self::Bench(command) => command.run(out),
            Self::Compare(command) => command.run(out),
            Self::Sweep(command) => command.run(out),
        }
    }
}
