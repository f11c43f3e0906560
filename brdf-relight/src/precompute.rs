//! How transport is made.

use brdf_mesh::Mesh;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::chunk::Chunk;
use crate::clustered::ClusteredTransport;
use crate::coefficients::Coding;
use crate::components::components;
use crate::error::RelightError;
use crate::grouping::clusters;
use crate::maps::{BrdfMaps, Terms};
use crate::ray_packet::Occluder;
use crate::scene::Part;
use crate::store::SparseTransport;
use crate::stored::Transport;
use crate::surface::{ShadingPoint, Surface, diagonal};
use crate::transport::{CubeDirections, TransportWorkspace, open_energy};
use crate::visibility::Quality;

/// The form in which transport is stored.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Codec {
    /// The largest wavelet coefficients of each vector (the paper's).
    Wavelet {
        /// Most coefficients of a vector.
        coefficients: usize,
    },
    /// Wavelet coefficients of principal components that clusters of vertices share (Sloan et al. 2003).
    Clusters {
        /// A number of a component is dropped if it holds less than this share of the energy of a vertex that sees
        /// the whole sky, and a component if it holds less than its numbers and weights cost at that price.
        tolerance: f64,
    },
}

/// Options of a precomputation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PrecomputeParams {
    /// Form in which transport is stored.
    pub codec: Codec,
    /// Number of rays with which visibility is found.
    pub quality: Quality,
}

impl Default for PrecomputeParams {
    fn default() -> Self {
        Self { codec: Codec::Clusters { tolerance: 1e-5 }, quality: Quality::Adaptive }
    }
}

/// The precomputation of radiance transfer for one surface, in chunks that do not need each other.
///
/// ```
/// use brdf_mesh::{Mesh, Soup};
/// use brdf_relight::{
///     BrdfMaps, Codec, Occluder, Precomputation, PrecomputeParams, Quality, Surface,
/// };
///
/// let (torus, _) = Mesh::new(Soup::torus())?;
/// let params =
///     PrecomputeParams { codec: Codec::Wavelet { coefficients: 16 }, quality: Quality::One };
/// let work = Precomputation::new(&torus, Surface::of(&torus), BrdfMaps::diffuse(0.5), params);
/// let chunk = work.make(&Occluder::of(&torus), 0)?;
/// assert_eq!(chunk.vectors.len(), work.chunks()[0].len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias = "PRT")]
#[doc(alias = "precomputed radiance transfer")]
#[derive(Debug)]
pub struct Precomputation {
    surface: Surface,
    maps: BrdfMaps,
    params: PrecomputeParams,
    chunks: Vec<Vec<u32>>,
    shading_points: Vec<ShadingPoint>,
    sky: CubeDirections,
    terms: Terms,
}

/// Vertices of a chunk without clusters.
const CHUNK: usize = 256;
/// Coefficients of vertices that hold less than this share of what a component's have to are not looked at.
const GATHERED: f64 = 1.0 / 16.0;

impl Precomputation {
    /// Returns a plan for the transport of a surface's vertices, on or beneath a mesh.
    pub fn new(mesh: &Mesh, surface: Surface, maps: BrdfMaps, params: PrecomputeParams) -> Self {
        let chunks = match params.codec {
            Codec::Wavelet { .. } => {
                let all: Vec<u32> = (0_u32..).take(surface.positions.len()).collect();
                all.chunks(CHUNK).map(<[u32]>::to_vec).collect()
            }
            Codec::Clusters { .. } => clusters(&surface),
        };
        let shading_points = surface.shading_points(diagonal(mesh.positions()));
        let terms = maps.weighted_terms();
        Self {
            surface,
            maps,
            params,
            chunks,
            shading_points,
            sky: CubeDirections::default(),
            terms,
        }
    }

    /// Returns the surface whose vertices are shaded.
    pub fn surface(&self) -> &Surface {
        &self.surface
    }

    /// Returns its light maps and view maps.
    pub fn maps(&self) -> &BrdfMaps {
        &self.maps
    }

    /// Returns the numbers of vertices, chunk by chunk.
    pub fn chunks(&self) -> &[Vec<u32>] {
        &self.chunks
    }

    /// Makes the transport of a chunk.
    ///
    /// # Errors
    ///
    /// [`RelightError::Components`] if a cluster has none.
    ///
    /// # Panics
    ///
    /// If there is no such chunk.
    pub fn make(&self, occluder: &Occluder, chunk: usize) -> Result<Chunk, RelightError> {
        let terms = &self.terms;
        match self.params.codec {
            Codec::Wavelet { coefficients } => {
                let select = |workspace: &mut TransportWorkspace| {
                    workspace.select(terms.weights.len(), coefficients)
                };
                Ok(Chunk { vectors: self.each(occluder, chunk, select), weights: Vec::new() })
            }
            Codec::Clusters { tolerance } => {
                let least = tolerance * open_energy(&self.sky, &self.maps, terms);
                #[expect(clippy::cast_possible_truncation, reason = "transport is f32")]
                let gathered = (GATHERED * least) as f32;
                let members =
                    self.each(occluder, chunk, |workspace| workspace.gather(terms, gathered));
                components(&members, terms, least)
            }
        }
    }

    /// Something of the transport of each vertex of a chunk.
    fn each<T: Send>(
        &self,
        occluder: &Occluder,
        chunk: usize,
        take: impl Fn(&mut TransportWorkspace) -> T + Sync,
    ) -> Vec<T> {
        let light = &self.maps.light;
        let vertices = self.chunks[chunk].par_iter();
        let taken = vertices.map_init(
            || TransportWorkspace::new(light.width()),
            |workspace, vertex| {
                let site = &self.shading_points[*vertex as usize];
                workspace.transport(&self.sky, occluder, site, light, self.params.quality);
                workspace.transform();
                take(workspace)
            },
        );
        taken.collect()
    }

    /// Assembles the chunks, all of them and in order, to a part that can be relit.
    pub fn assemble(self, made: &[Chunk]) -> Part<'static> {
        let coding = Coding::of(self.terms.channels);
        let transport = match self.params.codec {
            Codec::Wavelet { .. } => {
                let vectors: Vec<_> = made.iter().flat_map(|chunk| &chunk.vectors).collect();
                Transport::Wavelets(SparseTransport::of(coding, &vectors))
            }
            Codec::Clusters { .. } => {
                let terms = self.terms.weights.len();
                Transport::Clusters(ClusteredTransport::of(coding, terms, &self.chunks, made))
            }
        };
        Part::assemble(self.surface, self.maps, transport)
    }

    /// Makes all chunks and assembles them to a part that can be relit.
    ///
    /// # Errors
    ///
    /// As for [`Precomputation::make`].
    pub fn run(self, occluder: &Occluder) -> Result<Part<'static>, RelightError> {
        let chunks = (0..self.chunks.len()).into_par_iter();
        let made: Vec<Chunk> =
            chunks.map(|chunk| self.make(occluder, chunk)).collect::<Result<_, _>>()?;
        Ok(self.assemble(&made))
    }
}
