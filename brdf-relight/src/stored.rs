//! Transport as it is stored, in either form.

use crate::clustered::ClusteredTransport;
use crate::coefficients::Coding;
use crate::light::LitCoefficients;
use crate::store::SparseTransport;

/// Precomputed transport as it is stored.
#[derive(Clone, Debug, PartialEq)]
pub enum Transport<'a> {
    /// Wavelet coefficients of each vertex for itself.
    Wavelets(SparseTransport<'a>),
    /// Components that clusters of vertices share, and each vertex's weights.
    Clusters(ClusteredTransport<'a>),
}

impl Transport<'_> {
    /// Returns how numbers are stored.
    pub fn coding(&self) -> Coding {
        self.sparse().coding()
    }

    /// Returns the number of vectors: vertices times terms.
    pub fn vectors(&self) -> usize {
        match self {
            Self::Wavelets(transport) => transport.vectors(),
            Self::Clusters(transport) => transport.vectors(),
        }
    }

    /// Returns the number of kept coefficients, of vertices or of components.
    pub fn entries(&self) -> usize {
        self.sparse().entries()
    }

    /// Returns the bytes that it takes as stored.
    pub fn bytes(&self) -> usize {
        match self {
            Self::Wavelets(transport) => transport.bytes(),
            Self::Clusters(transport) => transport.bytes(),
        }
    }

    /// Writes the products of all vectors with light into `out`, red, green and blue for each. `scratch` is memory
    /// that is used again.
    ///
    /// # Panics
    ///
    /// Unless `out` has room for each vector.
    pub fn relight(
        &self,
        light: &LitCoefficients,
        scratch: &mut Vec<[f32; 3]>,
        out: &mut [[f32; 3]],
    ) {
        match self {
            Self::Wavelets(transport) => transport.relight(light, out),
            Self::Clusters(transport) => transport.relight(light, scratch, out),
        }
    }

    fn sparse(&self) -> &SparseTransport<'_> {
        match self {
            Self::Wavelets(transport) => transport,
            Self::Clusters(transport) => transport.parts().0,
        }
    }
}
