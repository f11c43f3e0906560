//! Triangle meshes: PLY and Wavefront OBJ.

use std::io::Cursor;
use std::path::Path;

use brdf_render::{Mesh, MeshNotes, Soup};
use glam::{DVec2, DVec3};
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{Header, PropertyAccess, PropertyAccessResult};

use crate::{FormatError, IoError, MappedFile};

/// Reads a mesh and repairs it; polygons become fans of triangles.
///
/// # Errors
///
/// [`IoError::File`]; [`IoError::Format`] for content that is no usable mesh.
pub fn read_mesh(path: &Path) -> Result<(Mesh, MeshNotes), IoError> {
    let bytes = MappedFile::open(path)?;
    parse_mesh(&bytes).map_err(IoError::format(path))
}

/// A mesh from the bytes of a PLY or OBJ file.
///
/// # Errors
///
/// [`FormatError::Library`], [`FormatError::Missing`], [`FormatError::Mesh`].
pub fn parse_mesh(bytes: &[u8]) -> Result<(Mesh, MeshNotes), FormatError> {
    let soup = if bytes.starts_with(b"ply") { parse_ply(bytes)? } else { parse_obj(bytes)? };
    Ok(Mesh::new(soup)?)
}

fn parse_obj(bytes: &[u8]) -> Result<Soup, FormatError> {
    let library = |problem: String| FormatError::Library { what: "OBJ", problem };
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
        return Err(FormatError::Missing {
            what: "faces".to_owned(),
            expected: "a PLY or Wavefront OBJ file with `v` and `f` lines".to_owned(),
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

/// Properties that are read, by all their names.
const NUMBERS: [&[&str]; 8] = [
    &["x"],
    &["y"],
    &["z"],
    &["nx"],
    &["ny"],
    &["nz"],
    &["u", "s", "texture_u", "texture_s"],
    &["v", "t", "texture_v", "texture_t"],
];
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];

/// A vertex or a face.
#[derive(Default)]
struct Element {
    numbers: [f64; NUMBERS.len()],
    corners: Vec<i64>,
}

impl Element {
    fn number(&mut self, name: &str, value: f64) -> PropertyAccessResult {
        match NUMBERS.iter().position(|names| names.contains(&name)) {
            Some(at) => {
                self.numbers[at] = value;
                PropertyAccessResult::Set
            }
            None => PropertyAccessResult::Ignored,
        }
    }

    fn list<T: Into<i64>>(&mut self, name: &str, values: Vec<T>) -> PropertyAccessResult {
        if !CORNERS.contains(&name) {
            return PropertyAccessResult::Ignored;
        }
        self.corners = values.into_iter().map(Into::into).collect();
        PropertyAccessResult::Set
    }
}

/// One method for each type of number that a file may use.
macro_rules! numbers {
    ($($name:ident: $number:ty),*) => {
        $(fn $name(&mut self, name: &str, value: $number) -> PropertyAccessResult {
            self.number(name, f64::from(value))
        })*
    };
}

macro_rules! lists {
    ($($name:ident: $number:ty),*) => {
        $(fn $name(&mut self, name: &str, values: Vec<$number>) -> PropertyAccessResult {
            self.list(name, values)
        })*
    };
}

impl PropertyAccess for Element {
    fn new() -> Self {
        Self::default()
    }

    numbers!(set_char: i8, set_uchar: u8, set_short: i16, set_ushort: u16, set_int: i32);
    numbers!(set_uint: u32, set_float: f32, set_double: f64);
    lists!(set_list_char: i8, set_list_uchar: u8, set_list_short: i16, set_list_ushort: u16);
    lists!(set_list_int: i32, set_list_uint: u32);
}

fn parse_ply(bytes: &[u8]) -> Result<Soup, FormatError> {
    // Its messages span lines.
    let library = |error: ParseError| FormatError::Library {
        what: "PLY",
        problem: error.to_string().split_whitespace().collect::<Vec<_>>().join(" "),
    };
    let parser = Parser::<Element>::new();
    let mut reader = Reader::new(Cursor::new(bytes));
    let header = parser.read_header(&mut reader).map_err(library)?;
    check(&header, bytes.len())?;
    let mut soup = Soup::default();
    for definition in header.elements.values() {
        let elements =
            parser.read_payload_for_element(&mut reader, definition, &header).map_err(library)?;
        match definition.name.as_str() {
            "vertex" => {
                let has = |first: usize, count: usize| {
                    NUMBERS[first..first + count].iter().all(|names| {
                        definition.properties.values().any(|p| names.contains(&p.name.as_str()))
                    })
                };
                let three = |at: usize| {
                    let of = |e: &Element| DVec3::from_slice(&e.numbers[at..at + 3]);
                    elements.iter().map(of).collect::<Vec<_>>()
                };
                soup.positions = three(0);
                soup.normals = has(3, 3).then(|| three(3));
                let uv = |e: &Element| DVec2::from_slice(&e.numbers[6..8]);
                soup.uv = has(6, 2).then(|| elements.iter().map(uv).collect());
            }
            "face" => {
                for (face, element) in elements.iter().enumerate() {
                    soup.triangles.extend(fan(&element.corners, face)?);
                }
            }
            _ => {}
        }
    }
    Ok(soup)
}

/// Elements that the file cannot hold are refused before room is made for them.
fn check(header: &Header, length: usize) -> Result<(), FormatError> {
    for name in ["vertex", "face"] {
        let Some(definition) = header.elements.get(name) else {
            return Err(FormatError::Missing {
                what: format!("element `{name}`"),
                expected: "a mesh with vertices and faces".to_owned(),
            });
        };
        let wanted: &[&[&str]] = if name == "vertex" { &NUMBERS[..3] } else { &[&CORNERS] };
        let known = |names: &&[&str]| {
            definition.properties.values().any(|p| names.contains(&p.name.as_str()))
        };
        if let Some(names) = wanted.iter().find(|names| !known(names)) {
            return Err(FormatError::Missing {
                what: format!("property `{}` of element `{name}`", names[0]),
                expected: "x, y, z of vertices and vertex_indices of faces".to_owned(),
            });
        }
    }
    // A byte each at the very least.
    match header.elements.values().find(|definition| definition.count > length) {
        Some(definition) => Err(FormatError::Size {
            found: length,
            expected: definition.count,
            hint: " or more for the elements its header claims",
        }),
        None => Ok(()),
    }
}

/// The triangles of a polygon; of a point or a line one without area, so that it is counted.
fn fan(corners: &[i64], face: usize) -> Result<Vec<[u32; 3]>, FormatError> {
    let vertex = |at: i64| {
        u32::try_from(at).map_err(|_| FormatError::Library {
            what: "PLY",
            problem: format!("face {face} names vertex {at}; expected 0 or more"),
        })
    };
    if let &[first] | &[first, _] = corners {
        return Ok(vec![[vertex(first)?; 3]]);
    }
    if corners.is_empty() {
        return Err(FormatError::Library {
            what: "PLY",
            problem: format!("face {face} has no corners that are whole numbers"),
        });
    }
    (1..corners.len() - 1)
        .map(|at| Ok([vertex(corners[0])?, vertex(corners[at])?, vertex(corners[at + 1])?]))
        .collect()
}

#[cfg(test)]
mod tests {
    use brdf_render::UvSource;

    use super::*;

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
