//! `brdf relight render`.

use std::io::Write;
use std::path::PathBuf;

use brdf_image::ToneMap;
use brdf_relight::{RelitScene, render};

use super::loading::{LightArgs, Loaded, ShotArgs, mesh_of};
use crate::outputs::PictureArgs;
use crate::progress::Watch;

/// Show a precomputed object under an environment
///
/// Example: brdf relight render bunny.prt --env grace.hdr --rotate-deg 40 -o a.png
#[derive(clap::Args)]
#[command(mut_arg("output", |arg| arg.default_value("relit.png")))]
pub(in crate::commands) struct Render {
    /// File that `brdf relight precompute` wrote
    object: PathBuf,

    #[command(flatten)]
    light: LightArgs,

    #[command(flatten)]
    shot: ShotArgs,

    #[command(flatten)]
    picture: PictureArgs,
}

impl Render {
    pub(in crate::commands) fn run(self, _out: &mut impl Write) -> anyhow::Result<()> {
        self.picture.check()?;
        let watch = Watch::start();
        watch.step("relighting");
        let loaded = Loaded::open(&self.object)?;
        let file = loaded.parse()?;
        let mesh = mesh_of(&file)?;
        let lit = self.light.light()?.coefficients(self.light.rule());
        let mut relit = RelitScene::default();
        relit.relight(&file.parts, &lit);
        let shot = self.shot.orbit().render_params(&mesh, 0.0);
        let (film, negative) = render(&file.parts, &relit, &shot);
        drop(watch);
        if negative > 0 {
            let points = (shot.size * shot.points).pow(2);
            writeln!(
                std::io::stderr(),
                "{negative} of {points} points are below 0 in a channel, set to 0"
            )?;
        }
        self.picture.write_film(&film, ToneMap::exposed_for)
    }
}
