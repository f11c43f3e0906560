//! What can be wrong with a mesh.

/// A mesh that cannot be read or used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// Nothing to show.
    #[error("no triangle has an area: {degenerate} of {triangles} are degenerate")]
    Empty {
        /// Triangles given.
        triangles: usize,
        /// Number of triangles without area.
        degenerate: usize,
    },
    /// A corner that does not exist.
    #[error("triangle {triangle} names vertex {vertex}; the mesh has {vertices}, counted from 0")]
    Index {
        /// Index of the triangle, counted from 0.
        triangle: usize,
        /// Vertex that it names.
        vertex: u32,
        /// Number found.
        vertices: usize,
    },
    /// A number that is none.
    #[error("the {what} of vertex {vertex} is not finite")]
    NotFinite {
        /// Position, normal or texture coordinate.
        what: &'static str,
        /// Counted from 0.
        vertex: usize,
    },
    /// Attributes of other vertices.
    #[error("{found} {what}s for {expected} vertices")]
    Count {
        /// Normal or texture coordinate.
        what: &'static str,
        /// Number found.
        found: usize,
        /// Number expected.
        expected: usize,
    },
    /// No texture coordinates where the file's are asked for.
    #[error("the mesh has no texture coordinates of its own; make them (sphere, atlas)")]
    NoTextureCoordinates,
    /// Unwrapping failed.
    #[error("unwrapping: {problem}")]
    Unwrap {
        /// Message of the unwrapper.
        problem: String,
    },
    /// The parser of a format refused.
    #[error("{format}: {problem}")]
    Parse {
        /// PLY or OBJ.
        format: &'static str,
        /// Description of the problem.
        problem: String,
    },
    /// Something that the file lacks.
    #[error("no {what}; expected {expected}")]
    Missing {
        /// Name of the missing part.
        what: String,
        /// Expected content.
        expected: &'static str,
    },
    /// More elements than the file has bytes.
    #[error("found {found} bytes; expected {expected} or more for the elements its header claims")]
    Claim {
        /// Bytes that are there.
        found: usize,
        /// Bytes that there should be at least.
        expected: usize,
    },
}
