//! `brdf render`.

use std::io::Write;

use brdf_container::MaterialFile;
use brdf_model::Brdf;
use brdf_render::{MeshView, SphereView, Uniform, render_mesh, render_sphere};
use brdf_report::line_up;

use crate::args::{LightArgs, ReadArgs, usage};
use crate::meshes::MeshArgs;
use crate::outputs::PictureArgs;
use crate::progress::Watch;

/// Render materials on spheres or on a mesh, side by side
///
/// All pictures share camera, light and exposure: that which shows 99 % of the first picture
/// unclipped, unless --exposure says otherwise. From the second material on, its difference from
/// the first follows, brightened four times. Under an environment, scattered measurements take
/// minutes. A directional light has irradiance π, so that a white
/// diffuser facing it shows as 1. Pixels where a material has no data are chequered violet.
///
/// Example: brdf render preset:ggx brdf-out/model.safetensors --env grace.hdr -o spheres.png
///
/// Example: brdf render preset:ggx --mesh bunny.ply --ground -o bunny.png
#[derive(clap::Args)]
#[command(mut_arg("output", |arg| arg.default_value("spheres.png")))]
pub(super) struct Render {
    /// Materials, the reference first
    #[arg(required = true)]
    models: Vec<String>,

    #[command(flatten)]
    picture: PictureArgs,

    #[command(flatten)]
    mesh: MeshArgs,

    #[command(flatten)]
    light: LightArgs,

    /// Side of each picture in pixels [default: 256, of a mesh 512]
    #[arg(long, value_parser = clap::value_parser!(u32).range(16..=4096))]
    size: Option<u32>,

    /// Light samples per pixel under an environment
    #[arg(long, default_value_t = 512, value_parser = clap::value_parser!(u32).range(1..=65_536))]
    samples: u32,

    #[command(flatten)]
    read: ReadArgs,
}

impl Render {
    pub(super) fn run(self, _out: &mut impl Write) -> anyhow::Result<()> {
        self.picture.check()?;
        if self.mesh.mesh.is_none() && self.mesh.view.is_given() {
            return Err(usage("--view-deg and --ground: spheres have neither; give a --mesh"));
        }
        let files: Vec<MaterialFile> =
            self.models.iter().map(|model| self.read.open(model)).collect::<anyhow::Result<_>>()?;
        let materials: Vec<(String, &dyn Brdf)> =
            files.iter().map(|file| (file.short_name(), file.brdf())).collect();
        let light = self.light.open()?;
        let mesh = self.mesh.open()?;
        let size = self.size.map(|size| size as usize);
        let watch = Watch::start();
        watch.step("rendering");
        let render = |brdf: &dyn Brdf| match &mesh {
            Some(mesh) => {
                let view = MeshView {
                    samples: self.samples,
                    has_ground: self.mesh.view.ground,
                    ..MeshView::default()
                };
                let view = MeshView { size: size.unwrap_or(view.size), ..view };
                render_mesh(mesh, &Uniform(brdf), &light, &self.mesh.view.camera(mesh), &view)
            }
            None => {
                let view = SphereView { samples: self.samples, ..SphereView::default() };
                let view = SphereView { size: size.unwrap_or(view.size), ..view };
                render_sphere(brdf, &light, &view)
            }
        };
        let picture = line_up(&materials, &render, self.picture.exposure);
        drop(watch);
        self.picture.write(&picture)
    }
}
