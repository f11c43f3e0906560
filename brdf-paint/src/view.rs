//! Where cameras and lights stand.

use brdf_mesh::{Camera, Mesh};
use glam::{DMat3, DVec3};

use crate::PaintError;

/// A camera, its light, and what its picture shows of the light.
#[derive(Clone, Debug, PartialEq)]
pub struct PaintView {
    /// Name of the view, and of its files.
    pub name: String,
    /// Camera that it is seen from.
    pub camera: Camera,
    /// Light that it is lit by.
    pub light: LightSource,
    /// Linear RGB of a white diffuser at the centre of the mesh that faces the light: 1 of a painting,
    /// strength and colour of the light and exposure of a photograph.
    pub white: [f64; 3],
    /// Whether the object's shadow on itself is in the picture; what lies in it does not count.
    pub has_shadows: bool,
}

/// A light without size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightSource {
    /// A light infinitely far away, in a unit direction.
    Direction(DVec3),
    /// A light at a place; it falls off with the square of the distance.
    Position(DVec3),
}

/// How far lights are turned from their cameras about the vertical, degrees.
const LIGHT_TURN: f64 = 30.0;

impl PaintView {
    /// Returns a view of all of a mesh from a unit direction, lit without shadows from there, but turned about the
    /// vertical by `turn_deg` degrees.
    pub fn of(mesh: &Mesh, name: String, from: DVec3, turn_deg: f64) -> Self {
        let light = DMat3::from_rotation_y(turn_deg.to_radians()) * from;
        let camera = Camera::around(mesh.centre(), mesh.radius(), from);
        let light = LightSource::Direction(light);
        Self { name, camera, light, white: [1.0; 3], has_shadows: false }
    }

    /// Checks that the view's light stands outside the mesh and can light it.
    ///
    /// # Errors
    ///
    /// [`PaintError::LightInside`].
    pub fn check(&self, mesh: &Mesh) -> Result<(), PaintError> {
        match self.light {
            LightSource::Position(place) if place.distance(mesh.centre()) <= mesh.radius() => {
                Err(PaintError::LightInside { view: self.name.clone() })
            }
            _ => Ok(()),
        }
    }

    /// The unit direction from a place to the light, its distance, and how brightly it lights what faces it there,
    /// where it would be 1 at `centre`.
    pub(crate) fn light_at(&self, place: DVec3, centre: DVec3) -> (DVec3, f64, f64) {
        match self.light {
            LightSource::Direction(direction) => (direction, f64::INFINITY, 1.0),
            LightSource::Position(light) => {
                let to_light = light - place;
                let distance = to_light.length();
                let fall_off = (light.distance(centre) / distance).powi(2);
                (to_light / distance, distance, fall_off)
            }
        }
    }
}

/// Corners of an icosahedron on the unit sphere.
fn icosahedron() -> [DVec3; 12] {
    let golden = f64::midpoint(1.0, 5.0_f64.sqrt());
    let mut corners = [DVec3::ZERO; 12];
    for (index, corner) in corners.iter_mut().enumerate() {
        let sign = |bit: usize| if index & bit == 0 { 1.0 } else { -1.0 };
        let (a, b) = (sign(1), sign(2) * golden);
        *corner = match index / 4 {
            0 => DVec3::new(0.0, a, b),
            1 => DVec3::new(a, b, 0.0),
            _ => DVec3::new(b, 0.0, a),
        }
        .normalize();
    }
    corners
}

/// Returns the twelve views of a mesh from the corners of an icosahedron, each lit by a light 30° about the vertical
/// from its camera.
///
/// ```
/// use brdf_mesh::{Mesh, Soup};
/// use brdf_paint::{ViewBuffers, vertex_views};
///
/// let (torus, _) = Mesh::new(Soup::torus())?;
/// let views = vertex_views(&torus);
/// let buffers = ViewBuffers::of(&torus, &views[0], 16, 16);
/// assert!(views.len() == 12 && buffers.pixels.iter().flatten().count() > 50);
/// # Ok::<(), brdf_mesh::MeshError>(())
/// ```
pub fn vertex_views(mesh: &Mesh) -> Vec<PaintView> {
    named(mesh, icosahedron())
}

/// Returns `count` views of a mesh from directions that lie evenly on a spiral, lit as [`vertex_views`] are.
pub fn spiral_views(mesh: &Mesh, count: usize) -> Vec<PaintView> {
    // Each step turns by the golden angle and goes down by the same height.
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let direction = |at: usize| {
        let height = 1.0 - (2 * at + 1) as f64 / count as f64;
        let (sin, cos) = (golden * at as f64).sin_cos();
        let radius = (1.0 - height * height).sqrt();
        DVec3::new(radius * sin, height, radius * cos)
    };
    named(mesh, (0..count).map(direction))
}

fn named(mesh: &Mesh, from: impl IntoIterator<Item = DVec3>) -> Vec<PaintView> {
    let numbered = from.into_iter().enumerate();
    numbered
        .map(|(at, from)| PaintView::of(mesh, format!("view{at:02}"), from, LIGHT_TURN))
        .collect()
}

/// Returns twelve views from the centres of the icosahedron's faces, under three lights each: they judge a material
/// that was made from the other views.
pub fn face_views(mesh: &Mesh) -> Vec<PaintView> {
    let corners = icosahedron();
    let nearest = corners[0].distance(corners[1]).min(corners[0].distance(corners[8])) * 1.01;
    let mut centres = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                let [a, b, c] = [a, b, c].map(|at: usize| corners[at]);
                let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
                if longest < nearest {
                    centres.push((a + b + c).normalize());
                }
            }
        }
    }
    let lights = [-40.0, 15.0, 60.0];
    let chosen = centres.iter().enumerate().filter(|(at, _)| at % 5 < 3).map(|(_, c)| *c);
    chosen
        .enumerate()
        .flat_map(|(at, from)| {
            lights.map(|turn| PaintView::of(mesh, format!("held{at:02}{turn:+}"), from, turn))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use brdf_mesh::Soup;

    use super::*;

    fn triangle() -> Mesh {
        let soup = Soup {
            positions: vec![DVec3::X, DVec3::Y, DVec3::Z],
            triangles: vec![[0, 1, 2]],
            ..Soup::default()
        };
        Mesh::new(soup).unwrap().0
    }

    #[test]
    fn twelve_views_lie_evenly_and_twelve_more_between() {
        let corners = icosahedron();
        for (at, corner) in corners.iter().enumerate() {
            assert!((corner.length() - 1.0).abs() < 1e-12);
            let others = corners.iter().enumerate().filter(|(other, _)| *other != at);
            let near = others.filter(|(_, c)| c.distance(*corner) < 1.06).count();
            assert_eq!(near, 5, "corner {at} has five neighbours");
        }
        assert_eq!(face_views(&triangle()).len(), 36);
        assert_eq!(vertex_views(&triangle()).len(), 12);
    }

    #[test]
    fn views_on_a_spiral_keep_apart() {
        let (mesh, count) = (triangle(), 30);
        let views = spiral_views(&mesh, count);
        let forward: Vec<DVec3> = views.iter().map(|view| view.camera.forward()).collect();
        assert_eq!(forward.len(), count);
        let mean = forward.iter().sum::<DVec3>() / count as f64;
        assert!(mean.length() < 0.05, "from all sides: {mean}");
        for (at, a) in forward.iter().enumerate() {
            assert!(forward[..at].iter().all(|b| a.angle_between(*b) > 0.35), "view {at}");
        }
    }

    #[test]
    fn a_light_at_a_place_falls_off() {
        let mut view = vertex_views(&triangle()).remove(0);
        view.light = LightSource::Position(4.0 * DVec3::Z);
        let (to_light, distance, fall_off) = view.light_at(2.0 * DVec3::Z, DVec3::ZERO);
        assert_eq!((to_light, distance, fall_off), (DVec3::Z, 2.0, 4.0));
    }

    #[test]
    fn a_light_inside_is_refused() {
        let mesh = triangle();
        let mut view = vertex_views(&mesh).remove(0);
        assert!(view.check(&mesh).is_ok());
        view.light = LightSource::Position(mesh.centre() + 0.1 * DVec3::X);
        assert!(matches!(view.check(&mesh), Err(PaintError::LightInside { .. })));
    }
}
