//! Meshes, ready for rays.

use brdf_param::Frame;
use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

use crate::bvh::{Bvh, MeshHit};
use crate::error::MeshError;
use crate::soup::{MeshNotes, Soup};
use crate::texture_coordinates::TextureCoordinates;

/// The origin of a mesh's texture coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum UvSource {
    /// Longitude and latitude about the centre, which every mesh has.
    Sphere,
    /// Unwrapped into charts that do not overlap.
    Atlas,
    /// Texture coordinates of the file.
    File,
}

/// A mesh of triangles with smooth normals, ready for rays.
///
/// Any unit of length; y is up where it matters (tangents, [`Mesh::with_sphere_coordinates`]).
/// Triangles are wound counter-clockwise seen from outside; both sides are hit.
///
/// ```
/// use brdf_mesh::{Mesh, Soup};
/// use glam::DVec3;
///
/// let (torus, _) = Mesh::new(Soup::torus())?;
/// let hit = torus.hit(DVec3::new(1.0, 9.0, 0.0), DVec3::NEG_Y, 0.0).expect("the top of the tube");
/// assert!((hit.distance - 8.5).abs() < 1e-2);
/// assert!(torus.surface(&hit).normal.y > 0.99);
/// # Ok::<(), brdf_mesh::MeshError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Mesh {
    positions: Vec<DVec3>,
    /// Unit, one for each position.
    normals: Vec<DVec3>,
    coordinates: TextureCoordinates,
    triangles: Vec<[u32; 3]>,
    bvh: Bvh,
    centre: DVec3,
    radius: f64,
    lowest: f64,
}

/// A place on a mesh with its normals, tangent and texture coordinates, in the mesh's axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Position of the point.
    pub position: DVec3,
    /// Unit normal of the triangle, to the side that its corners' normals are on.
    pub face_normal: DVec3,
    /// Smooth unit normal.
    pub normal: DVec3,
    /// Unit tangent at a right angle to the smooth normal: along u where the file has texture coordinates, elsewhere
    /// to the east, around the vertical axis.
    pub tangent: DVec3,
    /// Texture coordinates; [0, 1]² unless the file's repeat a tile.
    pub uv: DVec2,
}

impl SurfacePoint {
    /// Returns the frame with x along the tangent and z along the smooth normal.
    pub fn frame(&self) -> Frame {
        Frame {
            tangent: self.tangent,
            bitangent: self.normal.cross(self.tangent),
            normal: self.normal,
        }
    }

    /// Returns the point seen from the other side, if that is where `direction` points; else the point itself.
    #[must_use]
    pub fn facing(self, direction: DVec3) -> Self {
        if self.face_normal.dot(direction) >= 0.0 {
            return self;
        }
        Self { face_normal: -self.face_normal, normal: -self.normal, ..self }
    }

    /// Returns a direction of the mesh's axes in those of the surface: tangent, bitangent, normal.
    pub fn to_local(&self, direction: DVec3) -> DVec3 {
        self.frame().to_local(direction)
    }
}

impl Mesh {
    /// Builds a mesh from what a file gives, repaired, and returns it with notes on what was done.
    ///
    /// Triangles without area and vertices that no triangle names are dropped. Normals that are missing become the
    /// angle-weighted means of the faces.
    ///
    /// # Errors
    ///
    /// [`MeshError`], but for unwrapping.
    pub fn new(soup: Soup) -> Result<(Self, MeshNotes), MeshError> {
        let (soup, normals, notes) = soup.repaired()?;
        let Soup { positions, uv, triangles, .. } = soup;
        let (low, high) =
            positions.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| {
                (low.min(*p), high.max(*p))
            });
        let centre = 0.5 * (low + high);
        let farthest = positions.iter().map(|p| p.distance_squared(centre)).fold(0.0, f64::max);
        let radius = farthest.sqrt();
        let bvh = Bvh::new(&positions, &triangles, centre, radius);
        let coordinates = match uv {
            Some(uv) => TextureCoordinates::OfFile(uv),
            None => TextureCoordinates::Sphere { centre },
        };
        let lowest = low.y;
        let mesh = Self { positions, normals, coordinates, triangles, bvh, centre, radius, lowest };
        Ok((mesh, notes))
    }

    /// Returns the vertices.
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    /// Returns the smooth unit normals of the vertices.
    pub fn normals(&self) -> &[DVec3] {
        &self.normals
    }

    /// Returns the triangles, as three vertices each.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Returns the centre of the box around all vertices.
    pub fn centre(&self) -> DVec3 {
        self.centre
    }

    /// Returns the radius of the sphere about the centre that holds all vertices.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Returns the height (y) of the lowest vertex.
    pub fn lowest(&self) -> f64 {
        self.lowest
    }

    /// Returns where the texture coordinates are from.
    pub fn uv_source(&self) -> UvSource {
        match self.coordinates {
            TextureCoordinates::Sphere { .. } => UvSource::Sphere,
            TextureCoordinates::Atlas(_) => UvSource::Atlas,
            TextureCoordinates::OfFile(_) => UvSource::File,
        }
    }

    /// Returns whether u goes around, so that 0 and 1 are the same place.
    pub fn wraps_around(&self) -> bool {
        self.uv_source() == UvSource::Sphere
    }

    /// Returns whether all texture coordinates lie in [0, 1]²; those of a file may repeat a tile.
    pub fn lies_on_one_tile(&self) -> bool {
        self.coordinates.lie_on_one_tile()
    }

    /// Returns the mesh with longitude and latitude about its centre as texture coordinates.
    ///
    /// u counts from the back (−z) over the left (−x), v from the bottom. Meshes whose files have no texture
    /// coordinates have these.
    #[must_use]
    pub fn with_sphere_coordinates(self) -> Self {
        Self { coordinates: TextureCoordinates::Sphere { centre: self.centre }, ..self }
    }

    /// Returns the mesh unwrapped into charts that do not overlap, on a page of `size` texels a side with a few
    /// empty ones between.
    ///
    /// # Errors
    ///
    /// [`MeshError::Unwrap`].
    #[cfg(feature = "atlas")]
    pub fn with_atlas(self, size: usize) -> Result<Self, MeshError> {
        let (source, uv, triangles) =
            crate::texture_coordinates::unwrap(&self.positions, &self.triangles, size)?;
        let pick = |values: &[DVec3]| source.iter().map(|at| values[*at]).collect();
        Ok(Self {
            positions: pick(&self.positions),
            normals: pick(&self.normals),
            coordinates: TextureCoordinates::Atlas(uv),
            triangles,
            ..self
        })
    }

    /// Returns the nearest place that a ray from `origin` along a unit direction meets, at least `least` away, or
    /// `None`.
    pub fn hit(&self, origin: DVec3, direction: DVec3, least: f64) -> Option<MeshHit> {
        self.bvh.nearest(&self.positions, &self.triangles, origin, direction, least)
    }

    /// Returns whether anything stands between `origin` and a distance along a unit direction.
    pub fn is_shadowed(&self, origin: DVec3, direction: DVec3, distance: f64) -> bool {
        self.bvh.any(&self.positions, &self.triangles, origin, direction, distance)
    }

    /// Returns how far from the surface a shadow ray should start, so that rounding does not shade it.
    pub fn shadow_offset(&self) -> f64 {
        1e-5 * self.radius
    }

    /// Returns the point of the surface where a ray met it.
    ///
    /// # Panics
    ///
    /// If the hit is of a larger mesh.
    pub fn surface(&self, hit: &MeshHit) -> SurfacePoint {
        let corners = self.triangles[hit.triangle].map(|at| at as usize);
        let weights = hit.weights();
        let mean = |values: &[DVec3]| -> DVec3 {
            corners.iter().zip(weights).map(|(at, w)| w * values[*at]).sum()
        };
        let [a, b, c] = corners.map(|at| self.positions[at]);
        let position = mean(&self.positions);
        let smooth = mean(&self.normals);
        let face = (b - a).cross(c - a).normalize();
        let face_normal = if face.dot(smooth) < 0.0 { -face } else { face };
        let normal = smooth.try_normalize().unwrap_or(face_normal);
        let uv = self.coordinates.at(position, corners, weights);
        let tangent = self.tangent(corners, normal);
        SurfacePoint { position, face_normal, normal, tangent, uv }
    }

    fn tangent(&self, corners: [usize; 3], normal: DVec3) -> DVec3 {
        let along = self.coordinates.along_u(corners.map(|at| self.positions[at]), corners);
        let upright = |w: DVec3| (w - w.dot(normal) * normal).try_normalize();
        along
            .and_then(upright)
            .or_else(|| upright(DVec3::Y.cross(normal)))
            .unwrap_or_else(|| normal.any_orthonormal_vector())
    }

    /// Returns the units of texture coordinates along a unit of length, at a place of a triangle: a mean over both
    /// ways.
    ///
    /// # Panics
    ///
    /// If there is no such triangle.
    pub fn texture_density(&self, triangle: usize, position: DVec3) -> f64 {
        let corners = self.triangles[triangle].map(|at| at as usize);
        let [a, b, c] = corners.map(|at| self.positions[at]);
        let area = (b - a).cross(c - a).length();
        self.coordinates.density(corners, area, position)
    }
}
