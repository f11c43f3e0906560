//! Triangle meshes to show materials on: what a file gives, repaired and counted; rays; texture coordinates; and
//! the camera that looks at them.
//!
//! ```
//! use brdf_mesh::{Camera, Mesh, Soup};
//! use glam::{DVec2, DVec3};
//!
//! let (torus, notes) = Mesh::new(Soup::torus())?;
//! assert_eq!(notes.open_edges, 0);
//! let camera = Camera::around(torus.centre(), torus.radius(), DVec3::Y);
//! let hole = torus.hit(camera.eye, DVec3::NEG_Y, 0.0);
//! assert!(hole.is_none(), "seen from above there is a hole in the middle");
//! # Ok::<(), brdf_mesh::MeshError>(())
//! ```

mod bvh;
mod camera;
mod error;
mod mesh;
#[cfg(feature = "obj")]
mod obj;
#[cfg(feature = "ply")]
mod ply;
mod read;
mod soup;
mod texture_coordinates;

pub use bvh::MeshHit;
pub use camera::Camera;
pub use error::MeshError;
pub use mesh::{Mesh, SurfacePoint, UvSource};
pub use read::parse_mesh;
pub use soup::{MeshNotes, Soup};
