//! The 81 lights as arrays, padded to whole vectors.

use crate::directions::{LIGHT_COUNT, ubo_directions};
use crate::height_field::Place;

/// Lights with padding: a multiple of 8 values, the longest vectors of f32 that pay off here.
pub(crate) const LANES: usize = 88;

/// One value for each light.
pub(crate) type Lanes = [f32; LANES];

/// The slope of a light at the normal, which nothing shadows.
const UPRIGHT: f32 = 1e30;

/// Directions of the table in the frame of the height field: x to the right, y along the rows.
#[derive(Debug)]
pub(crate) struct Lights {
    /// Components of the unit directions; the padding points along the normal.
    pub(crate) wi: [Lanes; 3],
    /// Height over horizontal distance along the direction.
    pub(crate) slope: Lanes,
    /// Distinct azimuths as unit vectors.
    pub(crate) azimuths: Vec<[f32; 2]>,
    /// Which azimuth each light has.
    pub(crate) azimuth_of: [usize; LANES],
}

impl Lights {
    pub(crate) fn new() -> Self {
        let table = ubo_directions();
        let mut lights = Self {
            wi: [[0.0; LANES], [0.0; LANES], [1.0; LANES]],
            slope: [UPRIGHT; LANES],
            azimuths: Vec::new(),
            azimuth_of: [0; LANES],
        };
        let mut known: Vec<u32> = Vec::new();
        for (light, &(theta, phi)) in table.iter().enumerate() {
            let wi = direction(theta, phi);
            for (axis, component) in wi.into_iter().enumerate() {
                lights.wi[axis][light] = component;
            }
            if theta > 0 {
                lights.slope[light] = wi[2] / wi[0].hypot(wi[1]);
            }
            lights.azimuth_of[light] = known.iter().position(|&p| p == phi).unwrap_or_else(|| {
                known.push(phi);
                let flat = direction(90, phi);
                lights.azimuths.push([flat[0], flat[1]]);
                known.len() - 1
            });
        }
        lights
    }

    /// The flattest light's slope.
    pub(crate) fn flattest(&self) -> f32 {
        self.slope.iter().copied().fold(UPRIGHT, f32::min)
    }
}

/// A direction of the table (degrees) as a unit vector, y along the rows: azimuths run
/// counterclockwise in the image, so that 90° is up.
#[expect(clippy::cast_possible_truncation, reason = "the height field works in f32")]
pub(crate) fn direction(theta_deg: u32, phi_deg: u32) -> Place {
    let (sin_theta, cos_theta) = f64::from(theta_deg).to_radians().sin_cos();
    let (sin_phi, cos_phi) = f64::from(phi_deg).to_radians().sin_cos();
    [sin_theta * cos_phi, -sin_theta * sin_phi, cos_theta].map(|component| component as f32)
}

/// Directions of the table by index, as [`direction`] gives them.
pub(crate) fn table_direction(index: usize) -> Place {
    let (theta, phi) = ubo_directions()[index];
    direction(theta, phi)
}

const _: () = assert!(LANES >= LIGHT_COUNT && LANES.is_multiple_of(8), "whole vectors");
