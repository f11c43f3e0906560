//! Where cameras and lights stand.

use brdf_render::{Camera, Mesh};
use glam::{DMat3, DVec3};

use crate::PaintError;

/// A camera and its light.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Names its files.
    pub name: String,
    /// Where it is seen from.
    pub camera: Camera,
    /// What lights it.
    pub light: LightSource,
}

/// A light without size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightSource {
    /// Infinitely far, in a unit direction.
    Direction(DVec3),
    /// At a place, equally bright everywhere.
    Position(DVec3),
}

/// How far lights are turned from their cameras about the vertical, degrees.
const LIGHT_TURN: f64 = 30.0;

impl View {
    /// A view of all of a mesh from a unit direction, lit from there but turned about the vertical.
    pub fn of(mesh: &Mesh, name: String, from: DVec3, turn_deg: f64) -> Self {
        let light = DMat3::from_rotation_y(turn_deg.to_radians()) * from;
        let camera = Camera::around(mesh.centre(), mesh.radius(), from);
        Self { name, camera, light: LightSource::Direction(light) }
    }

    /// Whether the view's light can light a mesh.
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

    /// The unit direction from a place to the light.
    pub fn to_light(&self, place: DVec3) -> DVec3 {
        match self.light {
            LightSource::Direction(direction) => direction,
            LightSource::Position(light) => (light - place).normalize_or(DVec3::Y),
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

/// The twelve views of a mesh from the corners of an icosahedron, each lit by a light 30° about the
/// vertical from its camera.
pub fn vertex_views(mesh: &Mesh) -> Vec<View> {
    let named = icosahedron().into_iter().enumerate();
    named.map(|(at, from)| View::of(mesh, format!("view{at:02}"), from, LIGHT_TURN)).collect()
}

/// Twelve of the views from the centres of the icosahedron's faces, under three lights each: what a
/// material is judged by that was made from the other views.
pub fn face_views(mesh: &Mesh) -> Vec<View> {
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
            lights.map(|turn| View::of(mesh, format!("held{at:02}{turn:+}"), from, turn))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use brdf_render::Soup;

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
    fn a_light_inside_is_refused() {
        let mesh = triangle();
        let mut view = vertex_views(&mesh).remove(0);
        assert!(view.check(&mesh).is_ok());
        view.light = LightSource::Position(mesh.centre() + 0.1 * DVec3::X);
        assert!(matches!(view.check(&mesh), Err(PaintError::LightInside { .. })));
    }
}
