//! Transport of some vertices as it is made, before it is stored.

/// Kept coefficients of one vertex, or of one component of a cluster, term after term.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SparseVectors {
    /// Largest magnitude of any channel, for each term.
    pub largest: Vec<f32>,
    /// Number of coefficients that each term keeps.
    pub counts: Vec<u16>,
    /// Places of the coefficients, ascending, term after term.
    pub places: Vec<u16>,
    /// Codes of the coefficients' values.
    pub codes: Vec<u32>,
}

/// The larger coefficients of one vertex, all terms together.
#[derive(Clone, Debug, Default)]
pub(crate) struct Entries {
    /// Coefficient times number of terms, and term; ascending.
    pub(crate) columns: Vec<u32>,
    /// `[column][channel]`, times the weight of the term.
    pub(crate) values: Vec<f32>,
}

/// The transport of one chunk of vertices, before it is assembled.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chunk {
    /// Vectors, one for each vertex of the chunk, or for each component of the cluster.
    pub vectors: Vec<SparseVectors>,
    /// `[vertex][component]`, 32767 for 1; none without clusters.
    pub weights: Vec<i16>,
}
