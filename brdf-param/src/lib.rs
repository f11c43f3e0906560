//! Where a pair of directions lies: maps of the hemisphere to the plane, changes of variables of
//! the BRDF domain, and linear projections from four dimensions to two.
//!
//! Frame: right-handed, x = tangent, y = bitangent, z = normal. `wi` points to the light, `wo` to
//! the viewer, both away from the surface and of unit length. Angles are radians.
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
