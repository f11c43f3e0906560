//! Transport of objects.

use std::borrow::Cow;

use brdf_relight::{
    BrdfMaps, Chunk, ClusteredTransport, Codec, Codes, Coding, MapStack, Part, RelightRecord,
    SparseTransport, SparseVectors, Surface, Transport,
};
use bytemuck::Pod;
use glam::DVec3;
use safetensors::tensor::Dtype;
use serde::{Deserialize, Serialize};

use crate::error::ContainerError;
use crate::head::{Head, library, read_record, serialize, tensors_of};
use crate::kind::Kind;
use brdf_io::{Cursor, f32_values};

/// Transport and how it was made; arrays lie in the file's bytes where those are aligned.
#[derive(Clone, Debug)]
pub struct RelightFile<'a> {
    /// The object, and its ground if it has one.
    pub parts: Vec<Part<'a>>,
    /// How it was made.
    pub record: RelightRecord,
}

#[derive(Serialize, Deserialize)]
struct Record {
    #[serde(flatten)]
    head: Head,
    /// Terms of each part.
    terms: Vec<usize>,
    made: RelightRecord,
}

/// Returns the bytes of transport's file.
///
/// # Errors
///
/// [`ContainerError::Library`] if they cannot be put together.
pub fn write_relight(
    parts: &[Part<'_>],
    record: &RelightRecord,
) -> Result<Vec<u8>, ContainerError> {
    #[expect(clippy::cast_possible_truncation, reason = "vertices are stored as f32")]
    let floats = |vectors: &[DVec3]| -> Vec<u8> {
        vectors.iter().flat_map(|v| v.to_array()).flat_map(|v| (v as f32).to_le_bytes()).collect()
    };
    let mut tensors: Vec<(String, Dtype, Vec<usize>, Vec<u8>)> = Vec::new();
    for (index, part) in parts.iter().enumerate() {
        let Part { surface, maps, transport, .. } = part;
        let mut add = |name: &str, kind, shape: &[usize], bytes| {
            tensors.push((name_of(index, name), kind, shape.to_vec(), bytes));
        };
        let vertices = surface.positions.len();
        add("positions", Dtype::F32, &[vertices, 3], floats(&surface.positions));
        add("normals", Dtype::F32, &[vertices, 3], floats(&surface.normals));
        let corners = surface.triangles.as_flattened();
        add("triangles", Dtype::U32, &[surface.triangles.len(), 3], little(corners));
        for (name, map) in [("light", &maps.light), ("view", &maps.view)] {
            let shape = [map.resolution(), map.resolution(), map.width()];
            add(name, Dtype::F32, &shape, little(map.texels()));
        }
        let sparse = match transport {
            Transport::Wavelets(sparse) => sparse,
            Transport::Clusters(clustered) => {
                let (components, clusters, first, weights) = clustered.parts();
                add("clusters", Dtype::U16, &[clusters.len()], little(clusters));
                add("components", Dtype::U32, &[first.len()], little(first));
                add("weights", Dtype::I16, &[weights.len()], little(weights));
                components
            }
        };
        let (scales, offsets, owners, codes) = sparse.parts();
        add("scales", Dtype::F32, &[scales.len()], little(scales));
        add("offsets", Dtype::U32, &[offsets.len()], little(offsets));
        add("owners", Dtype::U16, &[owners.len()], little(owners));
        match codes {
            Codes::Rgb(codes) => add("codes", Dtype::U32, &[codes.len()], little(codes)),
            Codes::Scalar(codes) => add("codes", Dtype::U16, &[codes.len()], little(codes)),
        }
    }
    let head = Head::of(Kind::Transport);
    let terms = parts.iter().map(|part| part.maps.terms).collect();
    let record = serde_json::to_string(&Record { head, terms, made: record.clone() })
        .map_err(|e| library("transport record", &e))?;
    let views = tensors
        .iter()
        .map(|(name, kind, shape, bytes)| (name.as_str(), *kind, shape.clone(), &bytes[..]));
    serialize(views, record)
}

/// Returns transport.
///
/// # Errors
///
/// [`ContainerError`] for anything that is not whole and consistent.
pub fn read_relight(bytes: &[u8]) -> Result<RelightFile<'_>, ContainerError> {
    let record = read_record(bytes, Kind::Transport)?;
    let record: Record =
        serde_json::from_str(&record).map_err(|e| library("transport record", &e))?;
    let tensors = tensors_of(bytes)?;
    let parts = record.terms.iter().enumerate().map(|(index, terms)| {
        let array = |name: &str, kind: Dtype, rank: usize| {
            let name = name_of(index, name);
            let view = tensors.tensor(&name).map_err(|e| library("safetensors", &e))?;
            if view.dtype() == kind && view.shape().len() == rank {
                return Ok((view.shape().to_vec(), view.data()));
            }
            Err(ContainerError::Missing {
                what: format!("tensor {name} of {kind:?} with {rank} axes"),
                expected: format!("that instead of {:?} {:?}", view.dtype(), view.shape()),
            })
        };
        let triples = |name: &str| -> Result<Vec<DVec3>, ContainerError> {
            let (shape, data) = array(name, Dtype::F32, 2)?;
            if shape[1] != 3 {
                return Err(library("transport", &format!("{name} of {shape:?}")));
            }
            let values = f32_values(data);
            let triples = values.as_chunks::<3>().0.iter();
            Ok(triples.map(|v| DVec3::from(v.map(f64::from))).collect())
        };
        let map = |name: &str| -> Result<MapStack, ContainerError> {
            let (shape, data) = array(name, Dtype::F32, 3)?;
            if shape[0] != shape[1] {
                return Err(library("transport", &format!("{name} of {shape:?}")));
            }
            MapStack::new(shape[0], shape[2], f32_values(data)).map_err(|e| library("maps", &e))
        };
        let maps = BrdfMaps::new(map("light")?, map("view")?, *terms);
        let maps = maps.map_err(|e| library("maps", &e))?;
        let codes = match Coding::of(maps.light_channels()) {
            Coding::Rgb => Codes::Rgb(mapped(array("codes", Dtype::U32, 1)?.1)),
            Coding::Scalar => Codes::Scalar(mapped(array("codes", Dtype::U16, 1)?.1)),
        };
        let scales = mapped(array("scales", Dtype::F32, 1)?.1);
        let offsets = mapped(array("offsets", Dtype::U32, 1)?.1);
        let owners = mapped(array("owners", Dtype::U16, 1)?.1);
        let (shape, corners) = array("triangles", Dtype::U32, 2)?;
        if shape[1] != 3 {
            return Err(library("transport", &format!("triangles of {shape:?}")));
        }
        let corners: Cow<'_, [u32]> = mapped(corners);
        let surface = Surface {
            positions: triples("positions")?,
            normals: triples("normals")?,
            triangles: corners.as_chunks::<3>().0.to_vec(),
        };
        let refused = |e| library("transport", &e);
        let sparse = SparseTransport::new(scales, offsets, owners, codes).map_err(refused)?;
        let transport = match record.made.precompute.codec {
            Codec::Wavelet { .. } => Transport::Wavelets(sparse),
            Codec::Clusters { .. } => {
                let clusters = mapped(array("clusters", Dtype::U16, 1)?.1);
                let first = mapped(array("components", Dtype::U32, 1)?.1);
                let weights = mapped(array("weights", Dtype::I16, 1)?.1);
                let made = ClusteredTransport::new(sparse, *terms, clusters, first, weights);
                Transport::Clusters(made.map_err(refused)?)
            }
        };
        Part::with_transport(surface, maps, transport).map_err(refused)
    });
    Ok(RelightFile { parts: parts.collect::<Result<_, _>>()?, record: record.made })
}

fn name_of(part: usize, name: &str) -> String {
    format!("part{part}.{name}")
}

/// Values as little-endian bytes.
fn little<T: Pod + Little>(values: &[T]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(size_of_val(values));
    values.iter().for_each(|value| value.append(&mut bytes));
    bytes
}

/// Numbers that are stored.
trait Little: Sized {
    fn append(&self, bytes: &mut Vec<u8>);
    fn read(bytes: &[u8]) -> Self;
}

macro_rules! little {
    ($($number:ty),*) => {$(
        impl Little for $number {
            fn append(&self, bytes: &mut Vec<u8>) {
                bytes.extend(self.to_le_bytes());
            }

            fn read(bytes: &[u8]) -> Self {
                let mut own = [0; size_of::<Self>()];
                own.copy_from_slice(bytes);
                Self::from_le_bytes(own)
            }
        }
    )*};
}

little!(f32, u32, u16, i16);

/// An array where it lies, if it is aligned and this machine stores numbers as files do; else a copy.
fn mapped<T: Pod + Little>(bytes: &[u8]) -> Cow<'_, [T]> {
    match bytemuck::try_cast_slice(bytes) {
        Ok(values) if cfg!(target_endian = "little") => Cow::Borrowed(values),
        _ => bytes.chunks_exact(size_of::<T>()).map(T::read).collect(),
    }
}

/// Returns a piece of a precomputation with its number as bytes, for a [`ChunkLog`](brdf_files::ChunkLog).
pub fn write_piece(number: usize, chunk: &Chunk) -> Vec<u8> {
    let count = |count: usize| u32::try_from(count).unwrap_or(u32::MAX).to_le_bytes();
    let mut bytes = (number as u64).to_le_bytes().to_vec();
    bytes.extend(count(chunk.weights.len()));
    bytes.extend(little(&chunk.weights));
    for vector in &chunk.vectors {
        bytes.extend(count(vector.counts.len()));
        bytes.extend(count(vector.places.len()));
        bytes.extend(little(&vector.largest));
        bytes.extend(little(&vector.counts));
        bytes.extend(little(&vector.places));
        bytes.extend(little(&vector.codes));
    }
    bytes
}

/// Returns what [`write_piece`] wrote.
///
/// # Errors
///
/// [`ContainerError::Format`] for bytes that end too early.
pub fn read_piece(bytes: &[u8]) -> Result<(usize, Chunk), ContainerError> {
    let mut cursor = Cursor::new(bytes, 0);
    let number = usize::try_from(cursor.u64("number of the piece")?).unwrap_or(usize::MAX);
    let count = cursor.u32("number of weights")? as usize;
    let weights = read_all(cursor.take(2 * count, "weights")?);
    let mut chunk = Chunk { vectors: Vec::new(), weights };
    while cursor.offset() < bytes.len() {
        let (terms, entries) = (cursor.u32("terms")? as usize, cursor.u32("entries")? as usize);
        chunk.vectors.push(SparseVectors {
            largest: read_all(cursor.take(4 * terms, "largest values")?),
            counts: read_all(cursor.take(2 * terms, "counts")?),
            places: read_all(cursor.take(2 * entries, "places")?),
            codes: read_all(cursor.take(4 * entries, "codes")?),
        });
    }
    Ok((number, chunk))
}

fn read_all<T: Pod + Little>(bytes: &[u8]) -> Vec<T> {
    mapped(bytes).into_owned()
}
