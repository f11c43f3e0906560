//! Pictures of materials on meshes.

use brdf_image::Film;
use brdf_mesh::{Camera, Mesh, SurfacePoint};
use brdf_model::Rgb;
use brdf_param::Frame;
use glam::{DVec2, DVec3};

use crate::light::Light;
use crate::spatially_varying::{SpatiallyVarying, TexturePoint};
use crate::stage::{Hit, Stage, render_stage, wrapped};

/// Options of a picture of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshView {
    /// Pixels along each side.
    pub size: usize,
    /// Samples of the environment per pixel, shared among the points within it.
    pub samples: u32,
    /// Repeats of the texture along u and v.
    pub tiles: f64,
    /// Whether the mesh stands on grey ground that takes its shadow.
    pub has_ground: bool,
}

impl Default for MeshView {
    fn default() -> Self {
        Self { size: 512, samples: 256, tiles: 1.0, has_ground: false }
    }
}

/// Radius of the ground in radii of the mesh.
const GROUND: f64 = 2.5;
/// What the ground reflects.
const GROUND_ALBEDO: f64 = 0.35;

/// Renders a mesh under a light. Lights stand in axes of the camera. The mesh casts shadows on itself, but no light
/// is reflected twice.
///
/// ```
/// use brdf_mesh::{Camera, Mesh, Soup};
/// use brdf_model::Preset;
/// use brdf_render::{DirectionalLight, Light, MeshView, Uniform, render_mesh};
/// use glam::DVec3;
///
/// let (torus, _) = Mesh::new(Soup::torus())?;
/// let camera = Camera::around(torus.centre(), torus.radius(), DVec3::Y);
/// let plastic = Preset::find("plastic").expect("a built-in material").brdf();
/// let light = Light::Directional(DirectionalLight::default());
/// let view = MeshView { size: 24, samples: 1, ..MeshView::default() };
/// let film = render_mesh(&torus, &Uniform(&plastic), &light, &camera, &view);
/// assert_eq!((film.width(), film.height()), (24, 24));
/// # Ok::<(), brdf_mesh::MeshError>(())
/// ```
pub fn render_mesh(
    mesh: &Mesh,
    material: &dyn SpatiallyVarying,
    light: &Light,
    camera: &Camera,
    view: &MeshView,
) -> Film {
    let ground = Matt(GROUND_ALBEDO);
    let stage = MeshStage { mesh, material, ground: &ground, camera, view };
    render_stage(&stage, light, view.samples)
}

struct MeshStage<'a> {
    mesh: &'a Mesh,
    material: &'a dyn SpatiallyVarying,
    ground: &'a Matt,
    camera: &'a Camera,
    view: &'a MeshView,
}

impl MeshStage<'_> {
    fn on_ground(&self, direction: DVec3) -> Option<(f64, DVec3)> {
        let height = self.mesh.lowest();
        let distance = (height - self.camera.eye.y) / direction.y;
        let position = self.camera.eye + distance * direction;
        let within = GROUND * self.mesh.radius();
        let from_centre =
            DVec2::new(position.x - self.mesh.centre().x, position.z - self.mesh.centre().z);
        (direction.y < 0.0 && distance > 0.0 && from_centre.length() < within)
            .then_some((distance, position))
    }

    /// How much of the texture a pixel covers, the longer way.
    fn footprint(&self, triangle: usize, distance: f64, surface: &SurfacePoint, cos: f64) -> f64 {
        let side = self.camera.pixel_side(self.view.size) * distance / cos.max(1e-3);
        let texel_density = self.mesh.texture_density(triangle, surface.position);
        side * texel_density * self.view.tiles
    }
}

impl Stage for MeshStage<'_> {
    fn size(&self) -> (usize, usize) {
        (self.view.size.max(1), self.view.size.max(1))
    }

    fn hit(&self, column: f64, row: f64, step: f64) -> Option<Hit<'_>> {
        let (columns, rows) = self.size();
        let direction = self.camera.ray(DVec2::new(column, row), columns, rows);
        let to_camera = self.camera.to_camera(-direction);
        let hit = self.mesh.hit(self.camera.eye, direction, 0.0);
        let ground = if self.view.has_ground { self.on_ground(direction) } else { None };
        match (hit, ground) {
            (Some(hit), ground) if ground.is_none_or(|(distance, _)| hit.distance < distance) => {
                let surface = self.mesh.surface(&hit).facing(-direction);
                let cos = surface.normal.dot(-direction);
                let [u, v] = (self.view.tiles * surface.uv).to_array().map(on_tile);
                let footprint = step * self.footprint(hit.triangle, hit.distance, &surface, cos);
                Some(Hit {
                    frame: in_camera(self.camera, &surface.frame()),
                    to_camera,
                    at: TexturePoint { u, v, footprint },
                    material: self.material,
                    position: surface.position + self.mesh.shadow_offset() * surface.face_normal,
                })
            }
            (_, Some((_, position))) => {
                let frame = Frame { tangent: DVec3::X, bitangent: DVec3::NEG_Z, normal: DVec3::Y };
                Some(Hit {
                    frame: in_camera(self.camera, &frame),
                    to_camera,
                    at: TexturePoint { u: 0.0, v: 0.0, footprint: 0.0 },
                    material: self.ground,
                    position: position + self.mesh.shadow_offset() * DVec3::Y,
                })
            }
            _ => None,
        }
    }

    fn is_lit(&self, hit: &Hit<'_>, direction: DVec3) -> bool {
        let direction = self.camera.to_scene(direction);
        !self.mesh.is_shadowed(hit.position, direction, f64::INFINITY)
    }
}

/// A place on a tile; its far rim is its own, not the near one.
fn on_tile(tiles: f64) -> f64 {
    if (0.0..=1.0).contains(&tiles) { tiles } else { wrapped(tiles) }
}

fn in_camera(camera: &Camera, frame: &Frame) -> Frame {
    let [tangent, bitangent, normal] =
        [frame.tangent, frame.bitangent, frame.normal].map(|axis| camera.to_camera(axis));
    Frame { tangent, bitangent, normal }
}

/// A white that is not quite.
#[derive(Debug)]
struct Matt(f64);

impl SpatiallyVarying for Matt {
    fn reflect(&self, _at: &TexturePoint, _wo: DVec3, lights: &[DVec3], out: &mut [Rgb]) {
        for (value, wi) in out.iter_mut().zip(lights) {
            *value = Rgb::splat(self.0 * wi.z.max(0.0) / std::f64::consts::PI);
        }
    }
}
