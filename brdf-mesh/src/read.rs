//! Meshes from files of either format.

use crate::error::MeshError;
use crate::mesh::Mesh;
use crate::soup::MeshNotes;

/// Reads a mesh from the bytes of a PLY or OBJ file, repairs it, and returns it with notes on what was done.
/// Polygons become fans of triangles.
///
/// ```
/// let (mesh, notes) = brdf_mesh::parse_mesh(b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n")?;
/// assert_eq!((mesh.triangles().len(), notes.open_edges), (2, 4));
/// # Ok::<(), brdf_mesh::MeshError>(())
/// ```
///
/// # Errors
///
/// [`MeshError`] for content that is no usable mesh.
pub fn parse_mesh(bytes: &[u8]) -> Result<(Mesh, MeshNotes), MeshError> {
    if bytes.starts_with(b"ply") {
        #[cfg(feature = "ply")]
        return Mesh::new(crate::ply::parse_ply(bytes)?);
        #[cfg(not(feature = "ply"))]
        return Err(MeshError::Missing {
            what: "reader of PLY".to_owned(),
            expected: "the feature `ply`",
        });
    }
    #[cfg(feature = "obj")]
    return Mesh::new(crate::obj::parse_obj(bytes)?);
    #[cfg(not(feature = "obj"))]
    Err(MeshError::Missing { what: "reader of OBJ".to_owned(), expected: "the feature `obj`" })
}

#[cfg(all(test, feature = "ply", feature = "obj"))]
mod tests {
    use glam::{DVec2, DVec3};

    use super::*;
    use crate::mesh::UvSource;

    const SQUARE: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\n\
        property float y\nproperty float z\nproperty float u\nproperty float v\nelement face 1\n\
        property list uchar int vertex_indices\nend_header\n\
        0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n0 1 0 0 1\n4 0 1 2 3\n";

    #[test]
    fn a_polygon_becomes_a_fan() {
        let (mesh, notes) = parse_mesh(SQUARE.as_bytes()).unwrap();
        assert_eq!((notes.vertices, notes.triangles, notes.open_edges), (4, 2, 4));
        assert!(notes.has_texture_coordinates && mesh.uv_source() == UvSource::File);
        assert!(mesh.normals().iter().all(|n| (*n - DVec3::Z).length() < 1e-12));
        let hit = mesh.hit(DVec3::new(0.25, 0.75, 2.0), DVec3::NEG_Z, 0.0).unwrap();
        let surface = mesh.surface(&hit);
        assert!((surface.uv - DVec2::new(0.25, 0.75)).length() < 1e-12, "{}", surface.uv);
        assert!((surface.tangent - DVec3::X).length() < 1e-12, "u runs along x");
    }

    #[test]
    fn an_obj_with_split_corners_is_the_same() {
        let obj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
            vn 0 0 2\nusemtl none\nf 1/1/1 2/2/1 3/3/1 4/4/1\n";
        let (mesh, notes) = parse_mesh(obj.as_bytes()).unwrap();
        assert_eq!((notes.triangles, notes.normals_made), (2, 0));
        assert_eq!(mesh.normals()[0], DVec3::Z, "of unit length");
    }

    #[test]
    fn broken_files_are_refused_in_a_line() {
        let huge = SQUARE.replace("vertex 4", "vertex 4000000000");
        let negative = SQUARE.replace("4 0 1 2 3", "4 0 1 2 -3");
        let past = SQUARE.replace("4 0 1 2 3", "4 0 1 2 9");
        let cut = &SQUARE[..SQUARE.len() - 12];
        let faceless = SQUARE.replace("vertex_indices", "something_else");
        for broken in [&huge, &negative, &past, cut, &faceless, "ply\n", "", "v 1 2\nf 1 2 3\n"] {
            let error = parse_mesh(broken.as_bytes()).unwrap_err().to_string();
            assert!(!error.is_empty() && !error.contains('\n'), "{error}");
        }
        assert!(parse_mesh(&[0xff, 0xfe, 0x00]).is_err());
    }
}
