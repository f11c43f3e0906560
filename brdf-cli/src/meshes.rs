//! Meshes that commands show materials on.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use brdf_mesh::{Camera, Mesh, UvSource};
use glam::DVec3;

use crate::args::numbers;

/// A mesh and where it is seen from.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct MeshArgs {
    /// Show the material on a mesh, PLY or OBJ, y up, or shape:torus
    #[arg(long, value_name = "FILE")]
    pub(crate) mesh: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) view: ViewArgs,

    /// Texture coordinates of the mesh [default: the file's, or those of the sphere]
    #[arg(long, value_enum, requires = "mesh")]
    pub(crate) uv: Option<UvArg>,
}

impl MeshArgs {
    /// The mesh, if one was asked for.
    pub(crate) fn open(&self) -> anyhow::Result<Option<Mesh>> {
        let open = |path: &PathBuf| open_mesh(path, self.uv.map(Into::into));
        self.mesh.as_ref().map(open).transpose()
    }
}

/// Where a mesh is seen from, and what it stands on.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct ViewArgs {
    /// Where the camera stands about the mesh: azimuth in degrees from +z towards +x, and elevation
    /// [default: 20,15]
    #[arg(
        long,
        value_name = "AZIMUTH,ELEVATION",
        value_parser = numbers::<2>("two numbers, such as 30,0"),
        allow_hyphen_values = true
    )]
    view_deg: Option<[f64; 2]>,

    /// Stand the mesh on grey ground that takes its shadow
    #[arg(long)]
    pub(crate) ground: bool,
}

impl ViewArgs {
    /// Whether anything was asked for.
    pub(crate) fn is_given(&self) -> bool {
        self.ground || self.view_deg.is_some()
    }

    /// A camera that shows all of a mesh.
    pub(crate) fn camera(&self, mesh: &Mesh) -> Camera {
        let [azimuth, elevation] = self.view_deg.unwrap_or([20.0, 15.0]).map(f64::to_radians);
        let (sin, cos) = azimuth.sin_cos();
        let from = DVec3::new(elevation.cos() * sin, elevation.sin(), elevation.cos() * cos);
        Camera::around(mesh.centre(), mesh.radius(), from)
    }
}

choices! {
    /// How a mesh comes by texture coordinates.
    pub(crate) enum UvArg for UvSource {
        /// Longitude and latitude about the centre, which every mesh has
        Sphere => Sphere,
        /// Unwrapped into charts that do not overlap
        Atlas => Atlas,
        /// Those of the file
        File => File,
    }
}

/// Opens a mesh and says what was repaired.
pub(crate) fn open_mesh(path: &Path, uv: Option<UvSource>) -> anyhow::Result<Mesh> {
    let (mesh, notes) = brdf_container::open_mesh(path, uv)?;
    for line in notes.lines() {
        writeln!(std::io::stderr(), "{}: {line}", path.display())?;
    }
    Ok(mesh)
}
