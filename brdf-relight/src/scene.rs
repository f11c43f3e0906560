//! Objects with their transport, and what light makes of them.

use brdf_mesh::{Mesh, MeshError, Soup};
use glam::Vec3;

use crate::coefficients::Coding;
use crate::error::RelightError;
use crate::light::LitCoefficients;
use crate::maps::BrdfMaps;
use crate::stored::Transport;
use crate::surface::Surface;

/// A surface with its precomputed transport.
#[doc(alias = "PRT")]
#[doc(alias = "precomputed radiance transfer")]
#[derive(Clone, Debug)]
pub struct Part<'a> {
    /// Vertices, normals and triangles that are shaded.
    pub surface: Surface,
    /// Light maps and view maps of its BRDF.
    pub maps: BrdfMaps,
    /// Vectors of transport, `[vertex][term]`.
    pub transport: Transport<'a>,
    /// Normals as pictures need them.
    pub(crate) shading_normals: Vec<Vec3>,
}

impl<'a> Part<'a> {
    /// Returns a surface with its transport, if they fit together.
    ///
    /// # Errors
    ///
    /// [`RelightError::Transport`] unless there is a vector for each vertex and term, all corners are vertices, and
    /// all numbers are finite.
    pub fn with_transport(
        surface: Surface,
        maps: BrdfMaps,
        transport: Transport<'a>,
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

    /// Returns the surface as a mesh, for rays.
    ///
    /// # Errors
    ///
    /// [`MeshError`] for a surface without area.
    pub fn mesh(&self) -> Result<Mesh, MeshError> {
        let soup = Soup {
            positions: self.surface.positions.clone(),
            normals: Some(self.surface.normals.clone()),
            triangles: self.surface.triangles.clone(),
            ..Soup::default()
        };
        Ok(Mesh::new(soup)?.0)
    }

    /// The same of parts that are known to fit.
    pub(crate) fn assemble(surface: Surface, maps: BrdfMaps, transport: Transport<'a>) -> Self {
        let shading_normals = surface.normals.iter().map(|n| n.as_vec3()).collect();
        Self { surface, maps, transport, shading_normals }
    }
}

/// The light that arrives at the vertices of some parts from one environment.
#[derive(Clone, Debug, Default)]
pub struct RelitScene {
    /// Light that each vertex receives for each term: for each part, `[vertex][term]` of red, green and blue.
    pub parts: Vec<Vec<[f32; 3]>>,
    scratch: Vec<[f32; 3]>,
}

impl RelitScene {
    /// Multiplies light with the transport of all parts, and keeps what arrives at each vertex and term. Memory is
    /// used again.
    pub fn relight(&mut self, parts: &[Part<'_>], light: &LitCoefficients) {
        self.parts.resize_with(parts.len(), Vec::new);
        for (part, values) in parts.iter().zip(&mut self.parts) {
            values.resize(part.transport.vectors(), [0.0; 3]);
            part.transport.relight(light, &mut self.scratch, values);
        }
    }
}
