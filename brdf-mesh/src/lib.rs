//! Triangle meshes to show materials on, with rays, texture coordinates and a camera.
//!
//! A [`Soup`] is what a file gives. [`Mesh::new`] repairs it and counts in [`MeshNotes`] what it did; [`parse_mesh`] reads PLY
//! and OBJ. [`Mesh::hit`] and [`Mesh::surface`] answer rays, and a [`Camera`] makes them. Meshes without texture coordinates
//! get those of a sphere, or are unwrapped by [`Mesh::with_atlas`].
//!
//! Coordinates are right-handed with y up, in any unit of length.
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

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDocTests;
