//! Coordinates for pairs of directions, the arguments of a BRDF.
//!
//! A BRDF (bidirectional reflectance distribution function) takes a direction to the light, `wi`,
//! and a direction to the viewer, `wo`. This crate says where such a [`DirectionPair`] lies:
//!
//! - [`HemisphereMap`] maps one direction to a point of the plane and back.
//! - [`Parametrization`] maps a pair to four coordinates and back. Each of the six has a struct of
//!   its own with named fields: [`Standard`], [`HalfDifference`] (Rusinkiewicz), [`KautzMcCool`],
//!   [`Orthographic`], [`Hybrid`] and [`OnionSlice`].
//! - [`Projection`] maps the four coordinates of a [`Space`] linearly to two, so that a BRDF can
//!   be looked up in textures.
//!
//! # Conventions
//!
//! Directions are unit vectors that point away from the surface. They are given in a right-handed
//! local frame: x is the tangent, y the bitangent, z the normal. Angles are in radians. Polar angles
//! are measured from the normal, azimuths from the tangent towards the bitangent.
//!
//! # Example
//!
//! ```
//! use brdf_param::{DirectionPair, HalfDifference};
//!
//! let pair = DirectionPair::from_angles(0.5, 0.0, 0.5, std::f64::consts::PI);
//! let angles = HalfDifference::from_pair(&pair);
//! assert!(angles.theta_h < 1e-12, "a mirror configuration has its half vector at the normal");
//! assert!((angles.theta_d - 0.5).abs() < 1e-12);
//! ```

mod direction;
mod error;
mod frame;
mod half_difference;
mod hemisphere;
mod hemispheres;
mod hybrid;
mod kautz_mccool;
mod onion_slice;
mod orthographic;
mod parametrization;
mod polygon;
mod projection;
mod standard;

pub use direction::{DirectionPair, azimuth, polar_angle, spherical_direction, wrap_azimuth};
pub use error::ParamError;
pub use frame::Frame;
pub use half_difference::HalfDifference;
pub use hemisphere::HemisphereMap;
pub use hybrid::Hybrid;
pub use kautz_mccool::KautzMcCool;
pub use onion_slice::OnionSlice;
pub use orthographic::Orthographic;
pub use parametrization::{Coordinates, Parametrization};
pub use polygon::{contains_point, convex_hull};
pub use projection::{Bound, DiscRadii, ParabolicPair, Projection, ScaledProjection, Space};
pub use standard::Standard;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDocTests;
