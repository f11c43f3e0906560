//! A virtual gonioreflectometer: bidirectional texture functions of height fields with albedo and
//! roughness, in the 81 × 81 directions of the UBO2003 measurements.
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
