//! A virtual gonioreflectometer: bidirectional texture functions (BTFs) made of height fields.
//!
//! A [`SurfaceMaps`] holds heights, albedo and roughness of a tile that repeats; heights can be had from a normal map with
//! [`heights_from_normals`]. A [`SurfaceScene`] computes shadows and bounces once, and [`SurfaceScene::synthesize_view`]
//! makes the images of one view under all lights. Views and lights are the 81 directions of the UBO2003 measurements
//! ([`ubo_directions`]), so that results can stand in for measured data.
//!
//! ```
//! use btf_synth::{LIGHT_COUNT, Map, Reflectance, SurfaceScene, SurfaceMaps, SynthOptions};
//!
//! let flat = Map::constant(8, 8, 0.0)?;
//! let white = Map::constant(8, 8, 1.0)?;
//! let maps = SurfaceMaps::from_maps(8, &flat, &[white.clone(), white.clone(), white.clone()], &white)?;
//! let scene = SurfaceScene::new(&maps, Reflectance::Lambertian, &SynthOptions::default())?;
//! let mut images = vec![0.0; LIGHT_COUNT * 8 * 8 * 3];
//! scene.synthesize_view(0, &mut images);
//! assert!((images[0] - 1.0).abs() < 1e-4); // a white diffuser under a light at the normal
//! # Ok::<(), btf_synth::SynthError>(())
//! ```

mod bounce;
mod directions;
mod error;
mod height_field;
mod horizon;
mod lights;
mod map;
mod normal_map;
mod points;
mod scene;
mod shading;
mod surface;

pub use directions::{LIGHT_COUNT, ubo_directions};
pub use error::SynthError;
pub use map::Map;
pub use normal_map::heights_from_normals;
pub use scene::{SurfaceScene, SynthOptions};
pub use shading::Reflectance;
pub use surface::SurfaceMaps;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDocTests;
