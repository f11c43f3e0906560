//! What each pixel of a view shows, exactly.

use brdf_mesh::Mesh;
use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::PaintView;

/// The surface in the middle of a pixel, with its light and its camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelSurface {
    /// Smooth unit normal, in axes of the mesh.
    pub normal: DVec3,
    /// Unit direction to the light in the surface's frame; below it on the dark side.
    pub wi: DVec3,
    /// Unit direction to the camera in the surface's frame; below it where the smooth normal turns away.
    pub wo: DVec3,
    /// Texture coordinates.
    pub uv: DVec2,
    /// Irradiance of what faces the light here, as a share of that at the centre of the mesh; 0 in shadow.
    pub irradiance: f64,
}

impl PixelSurface {
    /// Returns whether light and camera are above the surface and nothing stands before the light.
    pub fn is_seen_and_lit(&self) -> bool {
        self.wi.z > 0.0 && self.wo.z > 0.0 && self.irradiance > 0.0
    }
}

/// The surfaces that the pixels of a view show, row by row from the top left; `None` where a pixel shows nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct ViewBuffers {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Surfaces, `[row][column]`.
    pub pixels: Vec<Option<PixelSurface>>,
}

impl ViewBuffers {
    /// Returns what a view of a mesh shows in a picture of `width` × `height` pixels: a ray is cast through the
    /// middle of each pixel, and one to the light where the view has shadows.
    pub fn of(mesh: &Mesh, view: &PaintView, width: usize, height: usize) -> Self {
        let pixels = (0..height)
            .into_par_iter()
            .flat_map_iter(|row| {
                (0..width).map(move |column| {
                    let place = DVec2::new(column as f64 + 0.5, row as f64 + 0.5);
                    let direction = view.camera.ray(place, width, height);
                    let surface = mesh.surface(&mesh.hit(view.camera.eye, direction, 0.0)?);
                    let (to_light, distance, fall_off) =
                        view.light_at(surface.position, mesh.centre());
                    let is_shadowed = || {
                        let out = surface.facing(-direction).face_normal;
                        let origin = surface.position + mesh.shadow_offset() * out;
                        mesh.is_shadowed(origin, to_light, distance)
                    };
                    Some(PixelSurface {
                        normal: surface.normal,
                        wi: surface.to_local(to_light),
                        wo: surface.to_local(-direction),
                        uv: surface.uv,
                        irradiance: if view.has_shadows && is_shadowed() { 0.0 } else { fall_off },
                    })
                })
            })
            .collect();
        Self { width, height, pixels }
    }
}
