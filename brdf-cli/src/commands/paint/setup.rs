//! `brdf paint setup`.

use std::io::Write;
use std::path::{Path, PathBuf};

use brdf_container::{SceneSetup, read_views};
use brdf_files::FileError;
use brdf_mesh::Mesh;
use brdf_paint::{PaintView, spiral_views, vertex_views};
use brdf_report::sorted_json;

use crate::args::{resolution, usage};
use crate::meshes::{UvArg, open_mesh};
use crate::outputs::FolderArgs;
use crate::progress::Watch;

/// Prepare views of an object for painting
///
/// Writes scene.toml (cameras and lights), guides/NAME.png to paint over, and buffers/NAME.exr with normal,
/// light, view and texture coordinates of every pixel. With --truth the paintings are rendered instead, and
/// `extract` also judges views and lights that were not painted.
///
/// Photographs: give their cameras and lights with --views, and save them as painted/NAME.png, .jpg or .exr.
///
/// Example: brdf paint setup bunny.ply -o scene/
#[derive(clap::Args)]
#[command(mut_arg("output", |arg| arg.default_value("scene")))]
pub(in crate::commands) struct Setup {
    /// Object to paint, PLY or OBJ, y up; or shape:torus
    mesh: PathBuf,

    #[command(flatten)]
    folder: FolderArgs,

    /// How many, evenly from all sides (12: the corners of an icosahedron), or a file of views (TOML, `[[view]]`
    /// with name, eye, target, up, fov_deg, and light_direction or light_position; perhaps white and shadows)
    #[arg(long, value_name = "COUNT|FILE", default_value = "12")]
    views: String,

    /// Pixels along each side of the pictures, or WIDTHxHEIGHT
    #[arg(long, default_value = "512", value_parser = resolution)]
    size: [usize; 2],

    /// Texture coordinates [default: the file's, or those of the sphere]
    #[arg(long, value_enum)]
    uv: Option<UvArg>,

    /// Render the paintings: three materials, blended over the surface
    #[arg(long, value_name = "MODEL,MODEL,MODEL", value_delimiter = ',')]
    truth: Vec<String>,

    /// Print what was made as JSON
    #[arg(long)]
    json: bool,
}

impl Setup {
    pub(in crate::commands) fn run(self, out: &mut impl Write) -> anyhow::Result<()> {
        let truth = match &self.truth[..] {
            [] => None,
            [a, b, c] => Some([a, b, c].map(String::clone)),
            other => {
                let count = other.len();
                return Err(usage(format!(
                    "--truth: {count} materials; expected three, separated by commas"
                )));
            }
        };
        let mut folder = self.folder.create()?;
        let mesh = open_mesh(&self.mesh, self.uv.map(Into::into))?;
        let setup = SceneSetup {
            mesh: &mesh,
            mesh_name: self.mesh.to_string_lossy().into_owned(),
            views: self.open_views(&mesh)?,
            size: self.size,
            truth,
        };
        let watch = Watch::start();
        let report = watch.run(|job| setup.write(&mut folder, env!("CARGO_PKG_VERSION"), job))?;
        drop(watch);
        let json = sorted_json(&report)?;
        folder.write("report.json", json.as_bytes())?;
        folder.finish()?;
        if self.json {
            out.write_all(json.as_bytes())?;
        } else {
            let [width, height] = self.size;
            let (views, lit) = (report.views, report.lit_pixels);
            writeln!(
                out,
                "{}: {views} views of {width} × {height}, {lit} lit pixels",
                report.scene
            )?;
        }
        Ok(())
    }

    fn open_views(&self, mesh: &Mesh) -> anyhow::Result<Vec<PaintView>> {
        match self.views.parse::<usize>() {
            Ok(12) => Ok(vertex_views(mesh)),
            Ok(count) if (1..=1000).contains(&count) => Ok(spiral_views(mesh, count)),
            Ok(count) => Err(usage(format!(
                "--views {count}: expected 1 to 1000, or a file that lists views"
            ))),
            Err(_) => {
                let path = Path::new(&self.views);
                let text =
                    std::fs::read_to_string(path).map_err(FileError::file(path, "reading"))?;
                Ok(read_views(&text).map_err(FileError::content(path))?)
            }
        }
    }
}
