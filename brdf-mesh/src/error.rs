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
        /// Those without area.
        degenerate: usize,
    },
    /// A corner that does not exist.
    #[error("triangle {triangle} names vertex {vertex}; the mesh has {vertices}, counted from 0")]
    Index {
        /// Of the triangles, counted from 0.
        triangle: usize,
        /// What it names.
        vertex: u32,
        /// How many there are.
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
        /// How many there are.
        found: usize,
        /// How many there should be.
        expected: usize,
    },
    /// No texture coordinates where the file's are asked for.
    #[error("the mesh has no texture coordinates of its own; make them (sphere, atlas)")]
    NoTextureCoordinates,
    /// Unwrapping failed.
    #[error("unwrapping: {problem}")]
    Unwrap {
        /// What the unwrapper says.
        problem: String,
    },
    /// The parser of a format refused.
    #[error("{format}: {problem}")]
    Parse {
        /// PLY or OBJ.
        format: &'static str,
        /// What is wrong.
        problem: String,
    },
    /// Something that the file lacks.
    #[error("no {what}; expected {expected}")]
    Missing {
        /// What is missing.
        what: String,
        /// What would do.
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
