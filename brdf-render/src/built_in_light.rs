//! Two environments that need no file, so that measures on pictures mean the same everywhere.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use brdf_param::spherical_direction;
use glam::DVec3;

use crate::light::{Environment, EnvironmentError};

const WIDTH: usize = 128;
const HEIGHT: usize = 64;

impl Environment {
    /// Returns a clear sky over brown ground. The horizon is brighter than the zenith, and a sun 6° across, 40°
    /// above the horizon to the left, gives about half of the light.
    ///
    /// # Errors
    ///
    /// None; the constructor checks its texels.
    pub fn sky() -> Result<Self, EnvironmentError> {
        let sun = spherical_direction(0.9, 2.5);
        from_function(|w| {
            if w.dot(sun) > 3_f64.to_radians().cos() {
                return [180.0, 165.0, 140.0];
            }
            let height = w.y;
            if height < 0.0 {
                return [0.16, 0.12, 0.08];
            }
            let haze = (1.0 - height).powi(3);
            [0.25 + 0.7 * haze, 0.45 + 0.6 * haze, 0.9 + 0.3 * haze]
        })
    }

    /// Returns a dark room with three soft boxes: a large one above, a tall one to the right, a small bright one in
    /// front to the left. Sharp edges against black show what a highlight's shape became.
    ///
    /// # Errors
    ///
    /// None; the constructor checks its texels.
    pub fn studio() -> Result<Self, EnvironmentError> {
        from_function(|w| {
            let (elevation, azimuth) = (w.y.clamp(-1.0, 1.0).asin(), w.x.atan2(w.z));
            let within = |centre: (f64, f64), half: (f64, f64)| {
                let turn = (azimuth - centre.0 + PI).rem_euclid(TAU) - PI;
                turn.abs() < half.0 && (elevation - centre.1).abs() < half.1
            };
            if elevation > 1.1 {
                [6.0, 6.0, 6.0]
            } else if within((FRAC_PI_2, 0.1), (0.25, 0.7)) {
                [10.0, 9.0, 8.0]
            } else if within((-0.8, 0.5), (0.18, 0.18)) {
                [30.0, 32.0, 36.0]
            } else {
                [0.03, 0.03, 0.035]
            }
        })
    }
}

/// An environment from radiance as a function of direction: y up, z towards the camera.
fn from_function(radiance: impl Fn(DVec3) -> [f64; 3]) -> Result<Environment, EnvironmentError> {
    let share = |index: usize, count: usize| (index as f64 + 0.5) / count as f64;
    let texels = (0..WIDTH * HEIGHT)
        .map(|index| {
            let (sin_theta, cos_theta) = (PI * share(index / WIDTH, HEIGHT)).sin_cos();
            let phi = TAU * (share(index % WIDTH, WIDTH) - 0.5);
            let w = DVec3::new(sin_theta * phi.sin(), cos_theta, -sin_theta * phi.cos());
            #[expect(clippy::cast_possible_truncation, reason = "environments are f32")]
            radiance(w).map(|v| v as f32)
        })
        .collect();
    Environment::new(WIDTH, HEIGHT, texels)
}
