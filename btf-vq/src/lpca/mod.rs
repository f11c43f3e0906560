//! Local principal components: clusters of texels, each an affine space of few dimensions, with bytes
//! for coefficients and bases. The rival of the codebooks, on the same grid and as randomly readable.
//!
//! Source: G. Müller, J. Meseth and R. Klein, "Compression and Real-Time Rendering of Measured BTFs
//! Using Local PCA", Vision, Modeling and Visualization 2003; bytes instead of floats are ours.

mod decode;
mod fit;
mod model;

pub use decode::LpcaDecoder;
pub use fit::{LocalPca, fit_lpca, lpca_bytes};
pub use model::{LpcaHeader, LpcaModel, Steps};
