//! `brdf paint preview`.

use std::io::Write;
use std::path::PathBuf;

use brdf_container::read_painted;
use brdf_files::{FileError, MappedFile};
use brdf_image::ToneMap;
use brdf_render::{MeshView, render_mesh};

use crate::args::LightArgs;
use crate::meshes::{ViewArgs, open_mesh};
use crate::outputs::PictureArgs;
use crate::progress::Watch;

/// Show a painted material on an object
///
/// A material over the sphere's texture coordinates, the default, fits any mesh; one over an atlas or a file's
/// coordinates fits meshes with the same.
///
/// Example: brdf paint preview material/ --mesh dragon.ply --light-deg 30,40 -o dragon.png
#[derive(clap::Args)]
#[command(mut_arg("output", |arg| arg.default_value("preview.png")))]
pub(in crate::commands) struct Preview {
    /// Folder that `brdf paint extract` wrote, or its material.safetensors
    material: PathBuf,

    /// Object to show it on, PLY or OBJ, y up, or shape:torus
    #[arg(long, value_name = "FILE")]
    mesh: PathBuf,

    #[command(flatten)]
    picture: PictureArgs,

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
}

impl Preview {
    pub(in crate::commands) fn run(self, _out: &mut impl Write) -> anyhow::Result<()> {
        self.picture.check()?;
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
        let is_lit_all_over = self.light.env.is_some();
        self.picture.write_film(&film, |film| match is_lit_all_over {
            true => ToneMap::exposed_for(film),
            false => ToneMap { exposure: 1.0 },
        })
    }
}
