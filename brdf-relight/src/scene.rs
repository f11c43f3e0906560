//! Objects with their transport, and what light makes of them.

use brdf_render::Mesh;
use glam::Vec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::RelightError;
use crate::bundle::Occluder;
use crate::coefficients::Coding;
use crate::light::LitCoefficients;
use crate::maps::BrdfMaps;
use crate::store::SparseTransport;
use crate::surface::{Surface, diagonal};
use crate::transport::{Sky, SparseVectors, Workspace};
use crate::visibility::Quality;

/// Options of a precomputation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PrecomputeParams {
    /// Most coefficients of each vector.
    pub coefficients: usize,
    /// How finely the sky is looked at.
    pub quality: Quality,
}

impl Default for PrecomputeParams {
    fn default() -> Self {
        Self { coefficients: 96, quality: Quality::Adaptive }
    }
}

/// Transport of a range of a surface's vertices, in order. `done` hears of each vertex.
pub fn precompute(
    mesh: &Mesh,
    occluder: &Occluder,
    surface: &Surface,
    vertices: std::ops::Range<usize>,
    maps: &BrdfMaps,
    params: &PrecomputeParams,
    done: &(dyn Fn() + Sync),
) -> Vec<SparseVectors> {
    let sky = Sky::default();
    let sites = surface.sites(diagonal(mesh.positions()));
    let chosen = sites[vertices].par_iter();
    chosen
        .map_init(
            || Workspace::new(maps.light.width()),
            |workspace, site| {
                workspace.transport(&sky, occluder, site, &maps.light, params.quality);
                workspace.transform();
                let kept = workspace.select(maps.terms, params.coefficients);
                done();
                kept
            },
        )
        .collect()
}

/// A surface with its transport.
#[derive(Clone, Debug)]
pub struct Part<'a> {
    /// What is shaded.
    pub surface: Surface,
    /// Light maps and view maps of its BRDF.
    pub maps: BrdfMaps,
    /// Vectors by coefficient, `[vertex][term]`.
    pub transport: SparseTransport<'a>,
    /// Normals as pictures need them.
    pub(crate) shading_normals: Vec<Vec3>,
}

impl<'a> Part<'a> {
    /// A surface with its transport, if they fit together.
    ///
    /// # Errors
    ///
    /// [`RelightError::Transport`] unless there is a vector for each vertex and term, all corners are vertices, and
    /// all numbers are finite.
    pub fn with_transport(
        surface: Surface,
        maps: BrdfMaps,
        transport: SparseTransport<'a>,
    ) -> Result<Self, RelightError> {
        let refuse = |found: String, expected| Err(RelightError::Transport { found, expected });
        let (vertices, vectors) = (surface.positions.len(), transport.vectors());
        if vertices != surface.normals.len() || vertices * maps.terms != vectors {
            let found = format!("{vectors} vectors of {} terms, {vertices} vertices", maps.terms);
            return refuse(found, "a normal and a vector of each term for each vertex");
        }
        if Coding::of(maps.light_channels()) != transport.coding() {
            return refuse(
                "codes of another kind".to_owned(),
                "as many channels as light maps have",
            );
        }
        let is_corner = |at: &u32| (*at as usize) < vertices;
        if !surface.triangles.as_flattened().iter().all(is_corner) {
            return refuse(
                "a triangle beyond the vertices".to_owned(),
                "corners that are vertices",
            );
        }
        let mut vectors = surface.positions.iter().chain(&surface.normals);
        if !vectors.all(|v| v.is_finite()) {
            return refuse(
                "a vertex that is not finite".to_owned(),
                "finite positions and normals",
            );
        }
        Ok(Self::assemble(surface, maps, transport))
    }
}

impl<'a> Part<'a> {
    fn assemble(surface: Surface, maps: BrdfMaps, transport: SparseTransport<'a>) -> Self {
        let shading_normals = surface.normals.iter().map(|n| n.as_vec3()).collect();
        Self { surface, maps, transport, shading_normals }
    }
}

impl Part<'static> {
    /// A surface with the transport of all its vertices.
    pub fn new(surface: Surface, maps: &BrdfMaps, vectors: &[SparseVectors]) -> Self {
        let coding = Coding::of(maps.light_channels());
        Self::assemble(surface, maps.clone(), SparseTransport::of(coding, vectors))
    }
}

/// What arrives at the vertices of some parts under one light.
#[derive(Clone, Debug, Default)]
pub struct RelitScene {
    /// For each part, `[vertex][term]` of red, green and blue.
    pub parts: Vec<Vec<[f32; 3]>>,
}

impl RelitScene {
    /// Multiplies light with the transport of all parts; memory is used again.
    pub fn relight(&mut self, parts: &[Part<'_>], light: &LitCoefficients) {
        self.parts.resize_with(parts.len(), Vec::new);
        for (part, values) in parts.iter().zip(&mut self.parts) {
            values.resize(part.transport.vectors(), [0.0; 3]);
            part.transport.relight(light, values);
        }
    }
}
