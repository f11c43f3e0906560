//! Pictures of BRDFs and of materials that vary over a texture: spheres, planes and cylinders under
//! a directional light or a lat-long environment, tone mapping that is stated, differences, and
//! captioned strips.
//!
//! ```
//! use brdf_model::Preset;
//! use brdf_render::{DirectionalLight, Light, SphereView, ToneMap, render_sphere};
//!
//! let paint = Preset::find("lafortune-blue-paint").expect("a preset").brdf();
//! let light = Light::Directional(DirectionalLight::default());
//! let film = render_sphere(&paint, &light, &SphereView { size: 32, ..SphereView::default() });
//! let picture = ToneMap::exposed_for(&film).apply(&film);
//! assert_eq!((picture.width(), picture.height()), (32, 32));
//! ```

mod built_in_light;
mod camera;
mod display;
mod film;
mod image_error;
mod light;
mod mesh;
mod mesh_view;
mod separable_view;
mod shape;
mod spatially_varying;
mod sphere;
mod strip;
mod texture_view;
mod textured;

pub use camera::Camera;
pub use display::{DisplayImage, ToneMap, encode_srgb};
pub use film::{Film, Pixel};
pub use image_error::{
    ImageErrors, PIXELS_PER_DEGREE, Planes, SsimWorkspace, delta_e_itp_map, flip_map, image_errors,
    psnr_db, ssim_map,
};
pub use light::{DirectionalLight, Environment, EnvironmentError, Light};
pub use mesh::{Mesh, MeshError, MeshHit, MeshNotes, Soup, SurfacePoint, UvSource};
pub use mesh_view::{MeshView, render_mesh};
pub use separable_view::{Side, term_view};
pub use shape::Shape;
pub use spatially_varying::{SpatiallyVarying, TexturePoint, Uniform};
pub use sphere::{SphereView, render_sphere};
pub use strip::{DIFFERENCE_GAIN, Panel, difference, strip};
pub use texture_view::{MASKED_OUT, texture_view};
pub use textured::{TexturedView, render_textured};
