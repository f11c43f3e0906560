//! `brdf relight render`.

use std::io::Write;
use std::path::PathBuf;

use brdf_files::write_atomically;
use brdf_image::{ToneMap, encode_png};
use brdf_relight::{RelitScene, render};

use super::loading::{LightArgs, Loaded, ShotArgs, mesh_of};
use crate::args::{ForceArgs, positive, usage};
use crate::progress::Watch;

/// Show a precomputed object under an environment
///
/// Example: brdf relight render bunny.prt --env grace.hdr --rotate-deg 40 -o a.png
#[derive(clap::Args)]
pub(in crate::commands) struct Render {
    /// File that `brdf relight precompute` wrote
    object: PathBuf,

    #[command(flatten)]
    light: LightArgs,

    #[command(flatten)]
    shot: ShotArgs,

    /// Picture to write, PNG
    #[arg(short, long, value_name = "FILE", default_value = "relit.png")]
    output: PathBuf,

    /// Factor from linear values to what is shown as white
    #[arg(long, value_parser = positive)]
    exposure: Option<f64>,

    #[command(flatten)]
    force: ForceArgs,
}

impl Render {
    pub(in crate::commands) fn run(self, _out: &mut impl Write) -> anyhow::Result<()> {
        if !self.output.extension().is_some_and(|e| e.eq_ignore_ascii_case("png")) {
            let name = self.output.display();
            return Err(usage(format!("{name}: expected a name that ends in .png")));
        }
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
        let tone = self
            .exposure
            .map_or_else(|| ToneMap::exposed_for(&film), |exposure| ToneMap { exposure });
        write_atomically(&self.output, &encode_png(&tone.apply(&film))?, self.force.overwrite())?;
        drop(watch);
        let mut err = std::io::stderr();
        if negative > 0 {
            let points = (shot.size * shot.points).pow(2);
            writeln!(err, "{negative} of {points} points are below 0 in a channel, set to 0")?;
        }
        writeln!(err, "{}", self.output.display())?;
        Ok(())
    }
}
