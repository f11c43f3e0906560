//! `brdf paint preview`.

use std::io::Write;
use std::path::PathBuf;

use brdf_container::read_painted;
use brdf_files::{FileError, MappedFile, write_atomically};
use brdf_image::{ToneMap, encode_png};
use brdf_render::{MeshView, render_mesh};

use crate::args::{ForceArgs, LightArgs, positive, usage};
use crate::meshes::{ViewArgs, open_mesh};
use crate::progress::Watch;

/// Show a painted material on an object
///
/// A material over the sphere's texture coordinates, the default, fits any mesh; one over an atlas or a file's
/// coordinates fits meshes with the same.
///
/// Example: brdf paint preview material/ --mesh dragon.ply --light-deg 30,40 -o dragon.png
#[derive(clap::Args)]
pub(in crate::commands) struct Preview {
    /// Folder that `brdf paint extract` wrote, or its material.safetensors
    material: PathBuf,

    /// Object to show it on, PLY or OBJ, y up, or shape:torus
    #[arg(long, value_name = "FILE")]
    mesh: PathBuf,

    /// Picture to write, PNG
    #[arg(short, long, value_name = "FILE", default_value = "preview.png")]
    output: PathBuf,

    #[command(flatten)]
    view: ViewArgs,

    #[command(flatten)]
    light: LightArgs,

    /// Pixels along each side
    #[arg(long, default_value_t = 512, value_parser = clap::value_parser!(u32).range(16..=4096))]
    size: u32,

    /// Light samples per pixel under an environment
    #[arg(long, default_value_t = 256, value_parser = clap::value_parser!(u32).range(1..=65_536))]
    samples: u32,

    /// Factor from linear values to what is shown as white [default: 1 under one light]
    #[arg(long, value_parser = positive)]
    exposure: Option<f64>,

    #[command(flatten)]
    force: ForceArgs,
}

impl Preview {
    pub(in crate::commands) fn run(self, _out: &mut impl Write) -> anyhow::Result<()> {
        if !self.output.extension().is_some_and(|e| e.eq_ignore_ascii_case("png")) {
            let name = self.output.display();
            return Err(usage(format!("{name}: expected a name that ends in .png")));
        }
        let path = if self.material.is_dir() {
            self.material.join("material.safetensors")
        } else {
            self.material.clone()
        };
        let bytes = MappedFile::open(&path)?;
        let file = read_painted(&bytes).map_err(FileError::content(&path))?;
        let mesh = open_mesh(&self.mesh, Some(file.record.uv))?;
        let light_source = self.light.open()?;
        let view = MeshView {
            size: self.size as usize,
            samples: self.samples,
            has_ground: self.view.ground,
            ..MeshView::default()
        };
        let watch = Watch::start();
        watch.step("rendering");
        let camera = self.view.camera(&mesh);
        let film = render_mesh(&mesh, &file.material, &light_source, &camera, &view);
        drop(watch);
        // Paintings are in [0, 1], and so is what is lit like them.
        let usual = if self.light.env.is_some() {
            ToneMap::exposed_for(&film)
        } else {
            ToneMap { exposure: 1.0 }
        };
        let tone = self.exposure.map_or(usual, |exposure| ToneMap { exposure });
        write_atomically(&self.output, &encode_png(&tone.apply(&film))?, self.force.overwrite())?;
        writeln!(std::io::stderr(), "{}", self.output.display())?;
        Ok(())
    }
}
