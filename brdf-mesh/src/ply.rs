//! PLY, text and binary.

use std::io::Cursor;

use glam::{DVec2, DVec3};
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{Header, PropertyAccess, PropertyAccessResult};

use crate::error::MeshError;
use crate::soup::Soup;

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

pub(crate) fn parse_ply(bytes: &[u8]) -> Result<Soup, MeshError> {
    // Its messages span lines.
    let library = |error: ParseError| MeshError::Parse {
        format: "PLY",
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
fn check(header: &Header, length: usize) -> Result<(), MeshError> {
    for name in ["vertex", "face"] {
        let Some(definition) = header.elements.get(name) else {
            return Err(MeshError::Missing {
                what: format!("element `{name}`"),
                expected: "a mesh with vertices and faces",
            });
        };
        let wanted: &[&[&str]] = if name == "vertex" { &NUMBERS[..3] } else { &[&CORNERS] };
        let known = |names: &&[&str]| {
            definition.properties.values().any(|p| names.contains(&p.name.as_str()))
        };
        if let Some(names) = wanted.iter().find(|names| !known(names)) {
            return Err(MeshError::Missing {
                what: format!("property `{}` of element `{name}`", names[0]),
                expected: "x, y, z of vertices and vertex_indices of faces",
            });
        }
    }
    // A byte each at the very least.
    match header.elements.values().find(|definition| definition.count > length) {
        Some(definition) => Err(MeshError::Claim { found: length, expected: definition.count }),
        None => Ok(()),
    }
}

/// The triangles of a polygon; of a point or a line one without area, so that it is counted.
fn fan(corners: &[i64], face: usize) -> Result<Vec<[u32; 3]>, MeshError> {
    let vertex = |at: i64| {
        u32::try_from(at).map_err(|_| MeshError::Parse {
            format: "PLY",
            problem: format!("face {face} names vertex {at}; expected 0 or more"),
        })
    };
    if let &[first] | &[first, _] = corners {
        return Ok(vec![[vertex(first)?; 3]]);
    }
    if corners.is_empty() {
        return Err(MeshError::Parse {
            format: "PLY",
            problem: format!("face {face} has no corners that are whole numbers"),
        });
    }
    (1..corners.len() - 1)
        .map(|at| Ok([vertex(corners[0])?, vertex(corners[at])?, vertex(corners[at + 1])?]))
        .collect()
}
