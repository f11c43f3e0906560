//! `brdf paint`: materials from painted or photographed pictures.

mod extract;
mod preview;
mod setup;

use std::io::Write;

use clap::Subcommand;

/// Make materials from pictures of an object, painted or photographed
///
/// `setup` makes a scene: guides to paint over and buffers that know what each pixel shows. Save the
/// paintings as painted/NAME.png in the scene, transparent where nothing is meant; `extract` makes a
/// material of them and `preview` shows it on another object.
#[derive(Subcommand)]
pub(super) enum Paint {
    Setup(setup::Setup),
    Extract(extract::Extract),
    Preview(preview::Preview),
}

impl Paint {
    pub(super) fn run(self, out: &mut impl Write) -> anyhow::Result<()> {
        match self {
            Self::Setup(command) => command.run(out),
            Self::Extract(command) => command.run(out),
            Self::Preview(command) => command.run(out),
        }
    }
}
