//! Rays against triangles.
//!
//! Boxes are those of a library in f32; triangles are met in f64, since buffers are read as exact.

use std::time::Duration;

use glam::{DVec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::ray::{Ray, RayHit};

/// The place where a ray meets a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshHit {
    /// Distance along the ray.
    pub distance: f64,
    /// Index of the triangle.
    pub triangle: usize,
    /// Shares of the second and third corner.
    pub barycentric: [f64; 2],
}

impl MeshHit {
    /// Returns the shares of the three corners, which sum to 1.
    pub fn weights(&self) -> [f64; 3] {
        let [b, c] = self.barycentric;
        [1.0 - b - c, b, c]
    }
}

/// Boxes around triangles, in axes in which the mesh fills the unit sphere, where f32 is fine enough.
#[derive(Clone)]
pub(crate) struct Bvh {
    boxes: Bvh2,
    centre: DVec3,
    radius: f64,
}

impl std::fmt::Debug for Bvh {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Bvh").finish_non_exhaustive()
    }
}

/// What boxes reach beyond their triangles, and rays beyond their hits: more than f32 rounds away.
const MARGIN: f32 = 1e-6;

impl Bvh {
    pub(crate) fn new(
        positions: &[DVec3],
        triangles: &[[u32; 3]],
        centre: DVec3,
        radius: f64,
    ) -> Self {
        let place = |at: u32| ((positions[at as usize] - centre) / radius).as_vec3a();
        let boxes: Vec<Aabb> = triangles
            .iter()
            .map(|corners| {
                let [a, b, c] = corners.map(place);
                let margin = Vec3A::splat(MARGIN);
                Aabb::new(a.min(b).min(c) - margin, a.max(b).max(c) + margin)
            })
            .collect();
        let params = BvhBuildParams::medium_build();
        let boxes = build_bvh2(&boxes, params, &mut Duration::default());
        Self { boxes, centre, radius }
    }

    pub(crate) fn nearest(
        &self,
        positions: &[DVec3],
        triangles: &[[u32; 3]],
        origin: DVec3,
        direction: DVec3,
        least: f64,
    ) -> Option<MeshHit> {
        let mut nearest: Option<MeshHit> = None;
        let ray = self.ray(origin, direction, f32::INFINITY);
        self.boxes.ray_traverse(ray, &mut RayHit::none(), |_, at| {
            let triangle = self.boxes.primitive_indices[at] as usize;
            let corners = triangles[triangle].map(|at| positions[at as usize]);
            let met = meet(corners, origin, direction).filter(|(distance, _)| *distance >= least);
            let Some((distance, barycentric)) = met else { return f32::INFINITY };
            // Of two at the same distance the first in the file, whatever the order of boxes.
            let is_nearer =
                nearest.is_none_or(|old| (distance, triangle) < (old.distance, old.triangle));
            if is_nearer {
                nearest = Some(MeshHit { distance, triangle, barycentric });
            }
            self.beyond(distance)
        });
        nearest
    }

    pub(crate) fn any(
        &self,
        positions: &[DVec3],
        triangles: &[[u32; 3]],
        origin: DVec3,
        direction: DVec3,
        limit: f64,
    ) -> bool {
        let ray = self.ray(origin, direction, self.beyond(limit));
        !self.boxes.ray_traverse_miss(ray, |_, at| {
            let triangle = self.boxes.primitive_indices[at] as usize;
            let corners = triangles[triangle].map(|at| positions[at as usize]);
            match meet(corners, origin, direction) {
                Some((distance, _)) if distance >= 0.0 && distance < limit => 0.0,
                _ => f32::INFINITY,
            }
        })
    }

    /// A ray in the axes of the boxes.
    fn ray(&self, origin: DVec3, direction: DVec3, limit: f32) -> Ray {
        let offset = (origin - self.centre) / self.radius;
        Ray::new(offset.as_vec3a(), direction.as_vec3a(), 0.0, limit)
    }

    /// A little more than a distance, so that what rounding puts behind it is still looked at.
    #[expect(clippy::cast_possible_truncation, reason = "rounded up")]
    fn beyond(&self, distance: f64) -> f32 {
        (distance / self.radius * (1.0 + 1e-5)) as f32 + MARGIN
    }
}

/// Distance along a ray to a triangle, from either side, and the shares of its second and third
/// corner (Möller and Trumbore 1997).
fn meet([a, b, c]: [DVec3; 3], origin: DVec3, direction: DVec3) -> Option<(f64, [f64; 2])> {
    let (ab, ac) = (b - a, c - a);
    let across = direction.cross(ac);
    let determinant = ab.dot(across);
    if determinant == 0.0 {
        return None;
    }
    let inverse = determinant.recip();
    let from = origin - a;
    let u = from.dot(across) * inverse;
    let around = from.cross(ab);
    let v = direction.dot(around) * inverse;
    // A hair beyond the edges, so that no ray slips between neighbours.
    let slack = 1e-12;
    (u >= -slack && v >= -slack && u + v <= 1.0 + slack).then(|| (ac.dot(around) * inverse, [u, v]))
}
