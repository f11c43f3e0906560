//! Lights: one direction, or a lat-long environment with importance sampling.

use std::f64::consts::{PI, TAU};

use brdf_image::{ImageError, decode_hdr};
use brdf_model::{DirectionSampler, Distribution1D, Rgb};
use brdf_param::spherical_direction;
use glam::DVec3;

/// The light of a picture.
#[derive(Clone, Debug, PartialEq)]
pub enum Light {
    /// A distant point.
    Directional(DirectionalLight),
    /// A whole sphere of radiance.
    Environment(Environment),
}

/// A distant light of irradiance π on a surface that faces it, so that a white diffuser shows as 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionalLight {
    /// Angle between the light and the direction to the camera, radians.
    pub theta: f64,
    /// Azimuth of the light around the camera, radians: 0 to the right, π/2 above.
    pub phi: f64,
}

impl Default for DirectionalLight {
    /// 30° from the camera, above and to the left.
    fn default() -> Self {
        Self { theta: 30_f64.to_radians(), phi: 135_f64.to_radians() }
    }
}

impl DirectionalLight {
    /// Returns the unit direction to the light in camera axes: x right, y up, z towards the camera.
    pub fn direction(&self) -> DVec3 {
        spherical_direction(self.theta, self.phi)
    }
}

/// A lat-long environment that cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EnvironmentError {
    /// The texels make none.
    #[error("{width} × {height} environment: {problem}")]
    Texels {
        /// Texels in a row.
        width: usize,
        /// Rows.
        height: usize,
        /// Description of the problem.
        problem: &'static str,
    },
    /// The file is no picture.
    #[error(transparent)]
    Image(#[from] ImageError),
}

/// A lat-long map of radiance from all directions. The top row is up (+y), the centre is −z, and light from the
/// right (+x) stands in the right half (Debevec's high-resolution convention).
///
/// ```
/// use brdf_render::Environment;
/// use glam::DVec3;
///
/// let mut texels = vec![[0.0; 3]; 8 * 4];
/// texels[..8].fill([2.0; 3]);
/// let zenith = Environment::new(8, 4, texels)?;
/// assert_eq!(zenith.radiance(DVec3::Y).g, 2.0);
/// assert_eq!(zenith.radiance(DVec3::X).g, 0.0);
/// # Ok::<(), brdf_render::EnvironmentError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    width: usize,
    height: usize,
    texels: Vec<[f32; 3]>,
    /// Over all texels, by luminance times solid angle.
    distribution: Distribution1D,
}

impl Environment {
    /// Returns an environment made of its texels, row by row from the top.
    ///
    /// # Errors
    ///
    /// [`EnvironmentError`] unless all texels are there, finite and not negative, and one is lit.
    pub fn new(
        width: usize,
        height: usize,
        texels: Vec<[f32; 3]>,
    ) -> Result<Self, EnvironmentError> {
        let refuse = |problem| EnvironmentError::Texels { width, height, problem };
        if width == 0 || texels.len() != width * height {
            return Err(refuse("texels are missing"));
        }
        if !texels.iter().flatten().all(|v| v.is_finite() && *v >= 0.0) {
            return Err(refuse("a texel is negative or not finite"));
        }
        let weights = texels.iter().enumerate().map(|(index, texel)| {
            let luminance = Rgb::from(texel.map(f64::from)).luminance();
            luminance * solid_angle(index / width, width, height)
        });
        let distribution = Distribution1D::new(weights).ok_or_else(|| refuse("no texel is lit"))?;
        Ok(Self { width, height, texels, distribution })
    }

    /// Returns the environment of a Radiance HDR file in lat-long layout.
    ///
    /// # Errors
    ///
    /// [`EnvironmentError`] for content that is no usable picture.
    pub fn from_hdr(bytes: &[u8]) -> Result<Self, EnvironmentError> {
        let image = decode_hdr(bytes)?;
        Self::new(image.width, image.height, image.pixels)
    }

    /// Returns the radiance from a unit direction.
    pub fn radiance(&self, direction: DVec3) -> Rgb {
        Rgb::from(self.texels[self.texel(direction)].map(f64::from))
    }

    /// Returns the pdf, sr⁻¹, with which [`Environment::draw`] draws a direction of this radiance.
    pub fn pdf_of(&self, radiance: Rgb) -> f64 {
        radiance.luminance() / self.distribution.total()
    }

    /// Returns a unit direction drawn with pdf proportional to luminance, from two numbers in [0, 1).
    pub fn draw(&self, u: f64, v: f64) -> DVec3 {
        let (index, across) = self.distribution.sample(u);
        let (row, column) = (index / self.width, index % self.width);
        let rows = self.height as f64;
        let (top, bottom) = ((PI * row as f64 / rows).cos(), (PI * (row + 1) as f64 / rows).cos());
        let y = top + v * (bottom - top);
        let phi = TAU * ((column as f64 + across) / self.width as f64 - 0.5);
        let planar = (1.0 - y * y).max(0.0).sqrt();
        DVec3::new(planar * phi.sin(), y, -planar * phi.cos())
    }

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "positions are clamped to the image"
    )]
    fn texel(&self, direction: DVec3) -> usize {
        let [u, v] = Self::place(direction);
        let side =
            |position: f64, count: usize| ((position * count as f64) as usize).min(count - 1);
        side(v, self.height) * self.width + side(u, self.width)
    }

    /// Returns where a unit direction lies in any lat-long map, both from 0 to 1: across, and down.
    pub fn place(direction: DVec3) -> [f64; 2] {
        let u = direction.x.atan2(-direction.z) / TAU + 0.5;
        [u, direction.y.clamp(-1.0, 1.0).acos() / PI]
    }

    /// Returns the number of columns and of rows.
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// Returns the radiance of all texels, row by row from the top.
    pub fn texels(&self) -> &[[f32; 3]] {
        &self.texels
    }
}

impl DirectionSampler for Environment {
    fn sample(&self, [u, v]: [f64; 2]) -> (DVec3, f64) {
        let direction = self.draw(u, v);
        (direction, self.pdf(direction))
    }

    fn pdf(&self, direction: DVec3) -> f64 {
        self.pdf_of(self.radiance(direction))
    }
}

/// Steradians of a texel in a row.
fn solid_angle(row: usize, width: usize, height: usize) -> f64 {
    let edge = |row: usize| (PI * row as f64 / height as f64).cos();
    TAU / width as f64 * (edge(row) - edge(row + 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn uneven() -> Environment {
        let texels = (0..32_u8).map(|i| [f32::from(i % 5), 1.0, f32::from(i % 3)]).collect();
        Environment::new(8, 4, texels).unwrap()
    }

    #[test]
    fn the_density_integrates_to_one() {
        let environment = uneven();
        let total: f64 = (0..32)
            .map(|index| {
                let luminance = Rgb::from(environment.texels[index].map(f64::from)).luminance();
                luminance / environment.distribution.total() * solid_angle(index / 8, 8, 4)
            })
            .sum();
        assert!((total - 1.0).abs() < 1e-12, "{total}");
    }

    #[test]
    fn samples_fall_into_texels_by_their_share() {
        let environment = uneven();
        let mut hits = [0_u32; 32];
        for i in 0..4096 {
            let direction = environment.draw((f64::from(i) + 0.5) / 4096.0, 0.37);
            hits[environment.texel(direction)] += 1;
        }
        for (index, hit) in hits.iter().enumerate() {
            let share = environment.distribution.share(index);
            assert!((f64::from(*hit) / 4096.0 - share).abs() < 1e-3, "texel {index}");
        }
    }

    #[test]
    fn the_centre_of_the_image_is_behind_the_object() {
        let mut texels = vec![[0.0; 3]; 64];
        texels[4 * 8 + 4] = [1.0; 3];
        let environment = Environment::new(8, 8, texels).unwrap();
        let direction = environment.draw(0.5, 0.5);
        assert!(direction.z < -0.9, "{direction}");
    }
}
