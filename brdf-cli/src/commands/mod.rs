//! The command line: one module per subcommand.

mod btf;
mod compare;
mod completions;
mod convert;
mod eval;
mod factor;
mod info;
mod paint;
mod plot;
mod relight;
mod render;
mod sample;
mod study;

use std::io::Write;

use clap::{Parser, Subcommand};

/// Measured materials, small, fast and visible: factor BRDFs into textures, say what was lost,
/// show it.
///
/// A MODEL or REFERENCE is a measured file (MERL .binary, RGL .bsdf, Cornell .brdf, UTIA .bin, ALTA
/// text, a table with a header; recognized by content), a model that `brdf factor` wrote, or
/// preset:NAME for a built-in material. Values are in sr⁻¹ without the cosine, linear RGB; angles
/// are in degrees.
#[derive(Parser)]
#[command(name = "brdf", version, arg_required_else_help = true, propagate_version = true)]
pub(crate) struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Factor(Box<factor::Factor>),
    Info(info::Info),
    Compare(compare::Compare),
    Render(render::Render),
    Plot(plot::PlotArgs),
    Study(study::Study),
    Eval(eval::Eval),
    Sample(sample::Sample),
    #[command(subcommand)]
    Btf(btf::Btf),
    #[command(subcommand)]
    Paint(paint::Paint),
    #[command(subcommand)]
    Relight(relight::Relight),
    Convert(convert::Convert),
    Completions(completions::Completions),
}

impl Cli {
    pub(crate) fn run(self, out: &mut impl Write) -> anyhow::Result<()> {
        match self.command {
            Command::Factor(command) => command.run(out),
            Command::Info(command) => command.run(out),
            Command::Compare(command) => command.run(out),
            Command::Render(command) => command.run(out),
            Command::Plot(command) => command.run(out),
            Command::Study(command) => command.run(out),
            Command::Eval(command) => command.run(out),
            Command::Sample(command) => command.run(out),
            Command::Btf(command) => command.run(out),
            Command::Paint(command) => command.run(out),
            Command::Relight(command) => command.run(out),
            Command::Convert(command) => command.run(out),
            Command::Completions(command) => command.run(out),
        }
    }
}
