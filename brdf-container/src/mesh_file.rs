//! Meshes by what people call them.

use std::path::Path;

use brdf_files::{FileError, MappedFile};
use brdf_mesh::{Mesh, MeshError, MeshNotes, Soup, UvSource, parse_mesh};

/// The mesh that needs no file.
pub const TORUS: &str = "shape:torus";
/// Texels of the page that charts are packed on: distances between them hold for maps up to this size.
const ATLAS_SIZE: usize = 256;

/// Opens a PLY or OBJ file, or [`TORUS`], and returns the mesh with the texture coordinates asked for, and what was
/// repaired.
///
/// # Errors
///
/// [`FileError::File`]; [`FileError::Content`] for content that is no mesh, has no texture coordinates where those of the
/// file are asked for, or cannot be unwrapped.
pub fn open_mesh(path: &Path, uv: Option<UvSource>) -> Result<(Mesh, MeshNotes), FileError> {
    let (mesh, notes) = if path == Path::new(TORUS) {
        Mesh::new(Soup::torus()).map_err(FileError::content(path))?
    } else {
        parse_mesh(&MappedFile::open(path)?).map_err(FileError::content(path))?
    };
    let mesh = match uv {
        None => mesh,
        Some(UvSource::Sphere) => mesh.with_sphere_coordinates(),
        Some(UvSource::Atlas) => mesh.with_atlas(ATLAS_SIZE).map_err(FileError::content(path))?,
        Some(UvSource::File) if mesh.uv_source() == UvSource::File => mesh,
        Some(UvSource::File) => {
            return Err(FileError::content(path)(MeshError::NoTextureCoordinates));
        }
    };
    Ok((mesh, notes))
}
