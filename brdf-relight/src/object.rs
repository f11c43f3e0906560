//! The precomputation of a whole object, with the ground it stands on: what is done, what is left, and going on
//! with an interrupted run.

use brdf_job::Job;
use brdf_mesh::Mesh;
use brdf_model::Brdf;
use hmac_sha256::Hash;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::chunk::Chunk;
use crate::error::RelightError;
use crate::factor::{MapParams, factor_for_relighting};
use crate::maps::BrdfMaps;
use crate::precompute::{Codec, Precomputation, PrecomputeParams};
use crate::ray_packet::Occluder;
use crate::scene::Part;
use crate::stored::Transport;
use crate::surface::Surface;

/// What the ground reflects.
const GROUND_ALBEDO: f32 = 0.35;
/// Chunks that are made at a time, and kept if a run is interrupted.
const AT_A_TIME: usize = 8;

/// Options of the precomputation of an object.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ObjectParams {
    /// Options of the factorization of the BRDF.
    pub maps: MapParams,
    /// Options of the precomputation of transport.
    pub precompute: PrecomputeParams,
    /// Whether the object stands on diffuse ground that takes its shadow.
    pub has_ground: bool,
}

/// A record of how the transport of a file was made.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RelightRecord {
    /// The mesh, without its folder.
    pub mesh: String,
    /// The material, as it was given, without folders.
    pub brdf: String,
    /// Options of the factorization of the BRDF.
    pub maps: MapParams,
    /// Options of the precomputation of transport.
    pub precompute: PrecomputeParams,
}

/// What a precomputation came to.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PrecomputeReport {
    /// The file that was written.
    pub output: String,
    /// Vertices, those of the ground included.
    pub vertices: usize,
    /// Vertices of them that an interrupted run had made.
    pub resumed: usize,
    /// Terms of the object's BRDF.
    pub terms: usize,
    /// Wavelet coefficients that are stored.
    pub entries: usize,
    /// Components of clusters.
    pub components: usize,
    /// Bytes of transport.
    pub transport_bytes: usize,
    /// Bytes of the file.
    pub bytes: usize,
    /// Time it took.
    pub seconds: f64,
    /// How it was made.
    pub made: RelightRecord,
}

/// What is known of a run once its file is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrecomputeRun {
    /// Vertices that an interrupted run had made.
    pub resumed: usize,
    /// Bytes of the file.
    pub bytes: usize,
    /// Time it took, s.
    pub seconds: f64,
}

impl PrecomputeReport {
    /// Returns the report of parts that were written to a file.
    pub fn new(output: &str, parts: &[Part<'_>], made: RelightRecord, run: PrecomputeRun) -> Self {
        let PrecomputeRun { resumed, bytes, seconds } = run;
        let sum = |count: fn(&Part<'_>) -> usize| parts.iter().map(count).sum();
        Self {
            output: output.to_owned(),
            vertices: sum(|part| part.surface.positions.len()),
            resumed,
            terms: parts.first().map_or(0, |part| part.maps.terms),
            entries: sum(|part| part.transport.entries()),
            components: sum(|part| match &part.transport {
                Transport::Wavelets(_) => 0,
                Transport::Clusters(clustered) => clustered.components(),
            }),
            transport_bytes: sum(|part| part.transport.bytes()),
            bytes,
            seconds,
            made,
        }
    }
}

/// The precomputation of an object and its ground, in pieces that do not need each other: it can be interrupted and
/// resumed.
#[derive(Debug)]
pub struct ObjectPrecomputation {
    work: Vec<Precomputation>,
    occluder: Occluder,
    params: ObjectParams,
    /// Part and chunk of each piece of work.
    pieces: Vec<(usize, usize)>,
    made: Vec<Option<Chunk>>,
}

impl ObjectPrecomputation {
    /// Factors a BRDF and plans the transport of a mesh that has it everywhere.
    ///
    /// # Errors
    ///
    /// As [`factor_for_relighting`].
    pub fn new(
        mesh: &Mesh,
        brdf: &dyn Brdf,
        params: ObjectParams,
        job: &Job<'_>,
    ) -> Result<Self, RelightError> {
        let fit = factor_for_relighting(brdf, &params.maps, job)?;
        let maps = BrdfMaps::of(&fit.model)?;
        let mut work = vec![Precomputation::new(mesh, Surface::of(mesh), maps, params.precompute)];
        if params.has_ground {
            let (surface, maps) = (Surface::ground(mesh), BrdfMaps::diffuse(GROUND_ALBEDO));
            work.push(Precomputation::new(mesh, surface, maps, of_ground(params.precompute)));
        }
        let chunks = |(part, work): (usize, &Precomputation)| {
            (0..work.chunks().len()).map(move |chunk| (part, chunk)).collect::<Vec<_>>()
        };
        let pieces: Vec<(usize, usize)> = work.iter().enumerate().flat_map(chunks).collect();
        let made = vec![None; pieces.len()];
        Ok(Self { work, occluder: Occluder::of(mesh), params, pieces, made })
    }

    /// Returns the number of vertices, those of the ground included.
    pub fn vertices(&self) -> usize {
        self.work.iter().map(|part| part.surface().positions.len()).sum()
    }

    /// Returns a hash of all that pieces depend on, so that those of an earlier run can be told from those of
    /// another object.
    pub fn key(&self) -> [u8; 32] {
        let mut hash = Hash::new();
        for part in &self.work {
            let (surface, maps) = (part.surface(), part.maps());
            for vector in surface.positions.iter().chain(&surface.normals) {
                vector.to_array().iter().for_each(|v| hash.update(v.to_le_bytes()));
            }
            surface.triangles.as_flattened().iter().for_each(|at| hash.update(at.to_le_bytes()));
            for map in [&maps.light, &maps.view] {
                map.texels().iter().for_each(|v| hash.update(v.to_le_bytes()));
            }
            hash.update((maps.terms as u64).to_le_bytes());
        }
        hash.update(format!("{:?}", self.params.precompute));
        hash.finalize()
    }

    /// Takes a piece that an earlier run of the same [key](Self::key) made, and returns the number of its vertices.
    ///
    /// # Errors
    ///
    /// [`RelightError::Transport`] for a piece beyond the last.
    pub fn take(&mut self, piece: usize, chunk: Chunk) -> Result<usize, RelightError> {
        let count = self.pieces.len();
        let place = self.made.get_mut(piece).ok_or_else(|| RelightError::Transport {
            found: format!("piece {piece} of {count}"),
            expected: "pieces of the same work",
        })?;
        *place = Some(chunk);
        Ok(self.len_of(piece))
    }

    fn len_of(&self, piece: usize) -> usize {
        let (part, chunk) = self.pieces[piece];
        self.work[part].chunks()[chunk].len()
    }

    /// Pieces that are left, those of a kind far apart: what is done stands for what is left to do.
    fn open(&self) -> Vec<usize> {
        let mut open: Vec<usize> =
            (0..self.pieces.len()).filter(|at| self.made[*at].is_none()).collect();
        // Multiples of the golden section spread evenly.
        open.sort_by_key(|at| (*at as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15));
        open
    }

    /// Makes the pieces that are left, and calls `keep` with the number of each piece and the piece as soon as it is
    /// made. Work is counted in vertices.
    ///
    /// # Errors
    ///
    /// As [`Precomputation::make`]; [`RelightError::Stopped`], after what was made was kept; whatever `keep` says.
    pub fn run<E: From<RelightError>>(
        &mut self,
        job: &Job<'_>,
        keep: &mut dyn FnMut(usize, &Chunk) -> Result<(), E>,
    ) -> Result<(), E> {
        let open = self.open();
        job.begin("light at vertices", open.iter().map(|piece| self.len_of(*piece) as u64).sum());
        for some in open.chunks(AT_A_TIME) {
            job.check().map_err(RelightError::from)?;
            let made = some.par_iter().map(|at| {
                let (part, chunk) = self.pieces[*at];
                let made = self.work[part].make(&self.occluder, chunk);
                job.advance(self.len_of(*at) as u64);
                made
            });
            let made: Vec<Chunk> = made.collect::<Result<_, RelightError>>()?;
            for (at, chunk) in some.iter().zip(made) {
                keep(*at, &chunk)?;
                self.made[*at] = Some(chunk);
            }
        }
        Ok(())
    }

    /// Assembles the pieces and returns the object, then its ground if it has one.
    ///
    /// # Errors
    ///
    /// [`RelightError::Transport`] if a piece was not made.
    pub fn finish(self) -> Result<Vec<Part<'static>>, RelightError> {
        let mut made = self.made.into_iter();
        let parts = self.work.into_iter().map(|part| {
            let own: Option<Vec<Chunk>> = made.by_ref().take(part.chunks().len()).collect();
            let own = own.ok_or_else(|| RelightError::Transport {
                found: "a piece that was not made".to_owned(),
                expected: "all of them",
            })?;
            Ok(part.assemble(&own))
        });
        parts.collect()
    }
}

/// Ground is smooth, so that errors show there first, and small.
pub(crate) fn of_ground(params: PrecomputeParams) -> PrecomputeParams {
    let codec = match params.codec {
        Codec::Clusters { tolerance } => Codec::Clusters { tolerance: 0.2 * tolerance },
        wavelet @ Codec::Wavelet { .. } => wavelet,
    };
    PrecomputeParams { codec, ..params }
}
