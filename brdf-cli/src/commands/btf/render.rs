//! `brdf btf render`.

use std::io::Write;

use brdf_image::ToneMap;
use brdf_render::{MeshView, Shape, TexturedView, render_mesh, render_textured};
use btf_vq::TexturedBtf;

use super::loading::ModelArgs;
use crate::args::{LightArgs, positive, usage};
use crate::meshes::MeshArgs;
use crate::outputs::PictureArgs;
use crate::progress::Watch;

/// Render a compressed BTF on a shape or a mesh
///
/// The tile repeats; coarser levels, where the file has them, are taken where a pixel sees more than
/// a texel.
///
/// Example: brdf btf render wool.btfvq --shape cylinder --env grace.hdr -o cloth.png
///
/// Example: brdf btf render wool.btfvq --mesh shape:torus --tiles 12 -o ring.png
#[derive(clap::Args)]
#[command(mut_arg("output", |arg| arg.default_value("btf.png")))]
pub(in crate::commands) struct Render {
    #[command(flatten)]
    model: ModelArgs,

    #[command(flatten)]
    picture: PictureArgs,

    /// What the material lies on
    #[arg(long, value_enum, default_value_t = ShapeArg::Sphere, conflicts_with = "mesh")]
    shape: ShapeArg,

    #[command(flatten)]
    mesh: MeshArgs,

    #[command(flatten)]
    light: LightArgs,

    /// Pixels in a row
    #[arg(long, default_value_t = 512, value_parser = clap::value_parser!(u32).range(16..=4096))]
    size: u32,

    /// Light samples per pixel under an environment
    #[arg(long, default_value_t = 256, value_parser = clap::value_parser!(u32).range(1..=65_536))]
    samples: u32,

    /// Tiles across the shape, or along u and v of a mesh
    #[arg(long, default_value_t = 4.0, value_parser = positive)]
    tiles: f64,

    /// Tilt of the shape towards the camera, degrees [default: 60 for a plane, 15 for a cylinder]
    #[arg(long, value_name = "DEG", allow_hyphen_values = true, conflicts_with = "mesh")]
    tilt_deg: Option<f64>,
}

choices! {
    enum ShapeArg for Shape {
        /// A square in perspective
        Plane => Plane,
        /// A sphere
        Sphere => Sphere,
        /// An upright cylinder
        Cylinder => Cylinder,
    }
}

impl Render {
    pub(in crate::commands) fn run(self, _out: &mut impl Write) -> anyhow::Result<()> {
        self.picture.check()?;
        if self.mesh.mesh.is_none() && self.mesh.view.is_given() {
            return Err(usage("--view-deg and --ground: shapes have neither; give a --mesh"));
        }
        let model = self.model.open()?;
        let material =
            TexturedBtf { reader: model.reader()?, cosine_included: model.cosine_included() };
        let light = self.light.open()?;
        let mesh = self.mesh.open()?;
        let (size, samples, tiles) = (self.size as usize, self.samples, self.tiles);
        let watch = Watch::start();
        watch.step("rendering");
        let film = if let Some(mesh) = &mesh {
            let view = MeshView { size, samples, tiles, has_ground: self.mesh.view.ground };
            render_mesh(mesh, &material, &light, &self.mesh.view.camera(mesh), &view)
        } else {
            let tilt = self.tilt_deg.map(f64::to_radians);
            let shape = self.shape.into();
            render_textured(&material, shape, &light, &TexturedView { size, samples, tiles, tilt })
        };
        drop(watch);
        self.picture.write_film(&film, ToneMap::exposed_for)
    }
}
