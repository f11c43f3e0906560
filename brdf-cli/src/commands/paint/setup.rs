//! `brdf paint setup`.

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use brdf_container::{
    MaterialFile, PaintScene, read_views, write_buffers, write_painting, write_scene,
};
use brdf_files::OutputFolder;
use brdf_image::encode_png;
use brdf_io::ReadOptions;
use brdf_mesh::Mesh;
use brdf_model::Brdf;
use brdf_paint::{
    GroundTruth, PaintView, PreparedView, SetupReport, TruthRecord, prepare, spiral_views,
    vertex_views,
};
use brdf_report::sorted_json;

use crate::args::{resolution, usage};
use crate::meshes::{UvArg, open_mesh};
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
pub(in crate::commands) struct Setup {
    /// Object to paint, PLY or OBJ, y up; or shape:torus
    mesh: PathBuf,

    /// Scene to write
    #[arg(short, long, value_name = "FOLDER", default_value = "scene")]
    output: PathBuf,

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

    /// Write into a folder that holds other files; paintings stay unless --truth renders them
    #[arg(long)]
    force: bool,

    /// Print what was made as JSON
    #[arg(long)]
    json: bool,
}

impl Setup {
    pub(in crate::commands) fn run(self, out: &mut impl Write) -> anyhow::Result<()> {
        if !matches!(self.truth.len(), 0 | 3) {
            let count = self.truth.len();
            return Err(usage(format!(
                "--truth: {count} materials; expected three, separated by commas"
            )));
        }
        let mut folder = OutputFolder::new(&self.output, self.force)?;
        let mesh = open_mesh(&self.mesh, self.uv.map(Into::into))?;
        if !mesh.lies_on_one_tile() {
            bail!(
                "{}: texture coordinates outside [0, 1] repeat a tile, but each place is painted for itself; give \
                 --uv sphere or atlas",
                self.mesh.display()
            );
        }
        let (views, mesh_uv) = (self.open_views(&mesh)?, mesh.uv_source());
        let [width, height] = self.size;
        let files: Vec<MaterialFile> = self
            .truth
            .iter()
            .map(|name| MaterialFile::open(name, &ReadOptions::default()))
            .collect::<Result<_, _>>()?;
        let truth = blended(&files);
        let (guides, exact) = (folder.create_folder("guides")?, folder.create_folder("buffers")?);
        let painted = if truth.is_some() || !self.output.join("painted").exists() {
            Some(folder.create_folder("painted")?)
        } else {
            None
        };
        let write = |place: &Path, name: String, bytes: Vec<u8>| {
            std::fs::write(place.join(&name), bytes).with_context(|| format!("writing {name}"))
        };
        let mut take = |view: PreparedView| -> anyhow::Result<()> {
            write(&guides, format!("{}.png", view.name), encode_png(&view.guide)?)?;
            write(&exact, format!("{}.exr", view.name), write_buffers(&view.buffers)?)?;
            if let (Some(image), Some(painted)) = (&view.painting, &painted) {
                write(painted, format!("{}.exr", view.name), write_painting(image)?)?;
            }
            Ok(())
        };
        let watch = Watch::start();
        let prepared = watch.run(|job| prepare(&mesh, &views, self.size, truth, job, &mut take))?;
        drop(watch);
        let materials = <[String; 3]>::try_from(self.truth.clone()).ok();
        let truth = materials.zip(prepared.scale);
        let truth = truth.map(|(materials, scale)| TruthRecord { materials, scale });
        let mesh = self.mesh.to_string_lossy().into_owned();
        let uv = mesh_uv;
        let scene = PaintScene { mesh, uv, size: self.size, views, truth };
        folder.write("scene.toml", write_scene(&scene)?.as_bytes())?;
        let report = SetupReport {
            brdf: env!("CARGO_PKG_VERSION").to_owned(),
            scene: self.output.to_string_lossy().into_owned(),
            views: scene.views.len(),
            size: scene.size,
            pixels: prepared.pixels,
            lit_pixels: prepared.lit_pixels,
            uv: scene.uv,
            truth: scene.truth.clone(),
        };
        let report = sorted_json(&report)?;
        folder.write("report.json", report.as_bytes())?;
        folder.finish()?;
        if self.json {
            out.write_all(report.as_bytes())?;
        } else {
            let count = scene.views.len();
            let folder = self.output.display();
            writeln!(
                out,
                "{folder}: {count} views of {width} × {height}, {} lit pixels",
                prepared.lit_pixels
            )?;
        }
        Ok(())
    }

    fn open_views(&self, mesh: &Mesh) -> anyhow::Result<Vec<PaintView>> {
        let views = match self.views.parse::<usize>() {
            Ok(12) => vertex_views(mesh),
            Ok(count) if (1..=1000).contains(&count) => spiral_views(mesh, count),
            Ok(count) => {
                return Err(usage(format!(
                    "--views {count}: expected 1 to 1000, or a file that lists views"
                )));
            }
            Err(_) => {
                let path = Path::new(&self.views);
                let text = std::fs::read_to_string(path)
                    .with_context(|| format!("{}: reading", path.display()))?;
                read_views(&text).with_context(|| path.display().to_string())?
            }
        };
        views.iter().try_for_each(|view| view.check(mesh))?;
        Ok(views)
    }
}

/// The blend of three materials, unscaled.
pub(super) fn blended(files: &[MaterialFile]) -> Option<GroundTruth<'_>> {
    let [a, b, c] = files else { return None };
    let brdfs: [&dyn Brdf; 3] = [a.brdf(), b.brdf(), c.brdf()];
    Some(GroundTruth { brdfs, scale: 1.0 })
}
