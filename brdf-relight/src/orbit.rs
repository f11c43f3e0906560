//! Cameras that stand around an object.

use brdf_mesh::{Camera, Mesh};
use glam::DVec3;

use crate::raster::RenderParams;

/// A camera on a circle about an object, and the size of the picture that it takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orbit {
    /// Azimuth of the camera from +z towards +x, radians.
    pub azimuth: f64,
    /// Elevation of the camera above the horizon, radians.
    pub elevation: f64,
    /// Distance from the object's centre in radii of the object, above 1.
    pub radii: f64,
    /// Pixels along each side.
    pub size: usize,
    /// Points along each side of a pixel.
    pub points: usize,
}

impl Orbit {
    /// Returns the options of a picture of a mesh, with the camera moved on by `turn` radians.
    pub fn render_params(&self, mesh: &Mesh, turn: f64) -> RenderParams {
        let (sin, cos) = (self.azimuth + turn).sin_cos();
        let up = self.elevation;
        let from = DVec3::new(up.cos() * sin, up.sin(), up.cos() * cos);
        let whole = Camera::around(mesh.centre(), mesh.radius(), from);
        let eye = mesh.centre() + self.radii * mesh.radius() * from;
        let camera =
            Camera::looking_at(eye, mesh.centre(), whole.up(), whole.fov()).unwrap_or(whole);
        RenderParams { camera, size: self.size, points: self.points }
    }
}
