//! Pictures of BRDFs and of materials that vary over a texture.
//!
//! - [`render_sphere`] shows one BRDF on a sphere.
//! - [`render_textured`] shows a [`SpatiallyVarying`] material on a [`Shape`]: a plane, a sphere or a cylinder.
//! - [`render_mesh`] shows it on a mesh, with the shadows that the mesh casts.
//!
//! The [`Light`] is a [`DirectionalLight`] or an [`Environment`], a lat-long map of radiance; [`Environment::sky`] and
//! [`Environment::studio`] need no file. Results are films of linear radiance, see [`brdf_image::Film`].
//!
//! ```
//! use brdf_image::ToneMap;
//! use brdf_model::Preset;
//! use brdf_render::{DirectionalLight, Light, SphereView, render_sphere};
//!
//! let paint = Preset::find("lafortune-blue-paint").expect("a preset").brdf();
//! let light = Light::Directional(DirectionalLight::default());
//! let film = render_sphere(&paint, &light, &SphereView { size: 32, ..SphereView::default() });
//! let picture = ToneMap::exposed_for(&film).apply(&film);
//! assert_eq!((picture.width(), picture.height()), (32, 32));
//! ```

mod built_in_light;
mod half_lobe;
mod light;
mod mesh_view;
mod shape;
mod spatially_varying;
mod sphere;
mod stage;
mod textured;

pub use light::{DirectionalLight, Environment, EnvironmentError, Light};
pub use mesh_view::{MeshView, render_mesh};
pub use shape::Shape;
pub use spatially_varying::{SpatiallyVarying, TexturePoint, Uniform};
pub use sphere::{SphereView, render_sphere};
pub use textured::{TexturedView, render_textured};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDocTests;
