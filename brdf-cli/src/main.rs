//! The `brdf` command: parse, run, exit code.

#[macro_use]
mod choices;

mod advice;
mod args;
mod commands;
mod meshes;
mod outputs;
mod progress;

use std::io::{self, Write as _};
use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::{CommandFactory as _, Parser as _};

fn main() -> ExitCode {
    let command = commands::Cli::parse();
    let mut out = io::BufWriter::new(io::stdout().lock());
    match command.run(&mut out).and_then(|()| Ok(out.flush()?)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => explain(&error),
    }
}

/// One line on standard error: 2 for usage, 1 for everything else. A reader that closed the pipe
/// has what it wanted.
fn explain(error: &anyhow::Error) -> ExitCode {
    let pipe_closed = error.chain().any(|cause| {
        cause.downcast_ref::<io::Error>().is_some_and(|e| e.kind() == io::ErrorKind::BrokenPipe)
    });
    if pipe_closed {
        return ExitCode::SUCCESS;
    }
    if error.is::<args::Usage>() {
        let _ = commands::Cli::command().error(ErrorKind::ArgumentConflict, error).print();
        return ExitCode::from(2);
    }
    if error.is::<advice::AlreadySaid>() {
        return ExitCode::FAILURE;
    }
    let _ = writeln!(io::stderr(), "brdf: {error:#}{}", advice::on_error(error));
    ExitCode::FAILURE
}
