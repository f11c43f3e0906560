//! What is shaded: vertices with normals.

use brdf_mesh::Mesh;
use glam::DVec3;

/// The point from which a vertex looks at the sky, and its normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadingPoint {
    /// The point, a little above the surface.
    pub position: DVec3,
    /// Unit normal.
    pub normal: DVec3,
}

/// Triangles with a unit normal at each corner.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    /// Position of each vertex.
    pub positions: Vec<DVec3>,
    /// Unit, of each vertex.
    pub normals: Vec<DVec3>,
    /// Corners, counter-clockwise from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// Vertices along a side of the ground, and its width in diagonals of the object's bounding box.
const GROUND_VERTICES: u32 = 148;
const GROUND_WIDTH: f64 = 4.0;
/// How far above the surface the sky is looked at, in diagonals.
const LIFT: f64 = 1e-4;

impl Surface {
    /// Returns the vertices and triangles of a mesh.
    pub fn of(mesh: &Mesh) -> Self {
        Self {
            positions: mesh.positions().to_vec(),
            normals: mesh.normals().to_vec(),
            triangles: mesh.triangles().to_vec(),
        }
    }

    /// Returns a square of ground beneath a mesh.
    pub fn ground(mesh: &Mesh) -> Self {
        let half = 0.5 * GROUND_WIDTH * diagonal(mesh.positions());
        let (centre, height) = (mesh.centre(), mesh.lowest());
        let last = GROUND_VERTICES - 1;
        let place = |at: u32| half * (2.0 * f64::from(at) / f64::from(last) - 1.0);
        let vertices = (0..GROUND_VERTICES).flat_map(|row| {
            (0..GROUND_VERTICES).map(move |column| {
                DVec3::new(centre.x + place(column), height, centre.z + place(row))
            })
        });
        let cells = (0..last).flat_map(|row| (0..last).map(move |column| (row, column)));
        let triangles = cells.flat_map(|(row, column)| {
            let at = row * GROUND_VERTICES + column;
            let below = at + GROUND_VERTICES;
            [[at, below, at + 1], [at + 1, below, below + 1]]
        });
        let positions: Vec<DVec3> = vertices.collect();
        Self { normals: vec![DVec3::Y; positions.len()], positions, triangles: triangles.collect() }
    }

    /// Returns the place of each vertex from which the sky is looked at, above the surface by a share of `diagonal`,
    /// with its normal.
    pub fn shading_points(&self, diagonal: f64) -> Vec<ShadingPoint> {
        let pairs = self.positions.iter().zip(&self.normals);
        pairs
            .map(|(position, normal)| ShadingPoint {
                position: *position + LIFT * diagonal * *normal,
                normal: *normal,
            })
            .collect()
    }
}

/// Of the bounding box.
pub(crate) fn diagonal(positions: &[DVec3]) -> f64 {
    let low = positions.iter().copied().reduce(DVec3::min).unwrap_or_default();
    let high = positions.iter().copied().reduce(DVec3::max).unwrap_or_default();
    high.distance(low)
}
