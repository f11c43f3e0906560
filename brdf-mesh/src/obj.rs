//! Wavefront OBJ.

use std::io::Cursor;
use std::path::Path;

use glam::{DVec2, DVec3};

use crate::error::MeshError;
use crate::soup::Soup;

/// Returns the triangles of an OBJ file; polygons become fans, materials are not read.
pub(crate) fn parse_obj(bytes: &[u8]) -> Result<Soup, MeshError> {
    let library = |problem: String| MeshError::Parse { format: "OBJ", problem };
    if std::str::from_utf8(bytes).is_err() {
        return Err(library("not text; expected a PLY or Wavefront OBJ file".to_owned()));
    }
    let options = tobj::LoadOptions {
        single_index: true,
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
    };
    // Materials are ours to give.
    let no_materials = |_: &Path| Ok((Vec::new(), std::collections::HashMap::default()));
    let (models, _) = tobj::load_obj_buf(&mut Cursor::new(bytes), &options, no_materials)
        .map_err(|error| library(error.to_string()))?;
    if models.is_empty() {
        return Err(MeshError::Missing {
            what: "faces".to_owned(),
            expected: "a PLY or Wavefront OBJ file with `v` and `f` lines",
        });
    }
    // Attributes count where every part has them.
    let all = |has: &dyn Fn(&tobj::Mesh) -> bool| models.iter().all(|model| has(&model.mesh));
    let has_normals = all(&|mesh| !mesh.normals.is_empty());
    let has_uv = all(&|mesh| !mesh.texcoords.is_empty());
    let mut soup =
        Soup { normals: has_normals.then(Vec::new), uv: has_uv.then(Vec::new), ..Soup::default() };
    for model in &models {
        let mesh = &model.mesh;
        let first = u32::try_from(soup.positions.len()).unwrap_or(u32::MAX);
        let vector = |v: &[f32; 3]| DVec3::from(v.map(f64::from));
        soup.positions.extend(mesh.positions.as_chunks().0.iter().map(vector));
        if let Some(normals) = &mut soup.normals {
            normals.extend(mesh.normals.as_chunks().0.iter().map(vector));
        }
        if let Some(uv) = &mut soup.uv {
            let places = mesh.texcoords.as_chunks::<2>().0.iter();
            uv.extend(places.map(|place| DVec2::from(place.map(f64::from))));
        }
        let corners = mesh.indices.as_chunks::<3>().0.iter();
        soup.triangles.extend(corners.map(|triangle| triangle.map(|at| first + at)));
    }
    Ok(soup)
}
