//! Environments as wavelet coefficients.

use brdf_render::Environment;
use glam::DVec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::cube::{FACE_TEXELS, FACES, SIDE, TEXELS, middle};
use crate::haar;

/// The rule by which wavelet coefficients of a light are used.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum LightRule {
    /// The largest coefficients, until what is left of the energy beyond the brightest hundredth is .5 %; from 200 to 1,000.
    #[default]
    Energy,
    /// Coefficients of at least 1/32 of the largest (the paper's 1024 of 32767).
    Paper,
    /// All coefficients.
    All,
}

/// Bounds of [`LightRule::Energy`].
const LEAST: usize = 200;
const MOST: usize = 1000;
/// Share of the energy that it holds.
const HELD: f64 = 0.995;

/// Light from everywhere: the sky's radiance over the texels of the cube.
#[derive(Clone, Debug, PartialEq)]
pub struct CubeLight {
    /// Mean linear RGB of each texel.
    pub radiance: Vec<[f32; 3]>,
}

/// Wavelet coefficients of a light, in ascending order of their places.
///
/// ```
/// use brdf_relight::{CubeLight, LightRule};
///
/// let lit = CubeLight::uniform([1.0, 0.5, 0.25]).coefficients(LightRule::All);
/// assert_eq!(lit.places().len(), 6, "one for each face");
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct LitCoefficients {
    places: Vec<u16>,
    values: Vec<[f32; 3]>,
}

/// A sampler of lat-long environment maps over the texels of the cube, for light that changes often: it keeps where
/// the rays of each texel lie, and their shares of the texel's solid angle.
#[derive(Clone, Debug)]
pub struct CubeLightSampler {
    rays: Vec<[LightRay; RAYS]>,
}

#[derive(Clone, Copy, Debug)]
struct LightRay {
    across: f32,
    down: f32,
    share: f32,
}

/// Rays along a side of a texel, and in all of it.
const FINE: usize = 4;
const RAYS: usize = FINE * FINE;

impl Default for CubeLightSampler {
    #[expect(clippy::cast_possible_truncation, reason = "light is f32")]
    fn default() -> Self {
        let rays = (0..TEXELS).into_par_iter().map(|texel| {
            let (face, row, column) = crate::cube::place(texel);
            let rays: [(DVec3, f64); RAYS] = std::array::from_fn(|fine| {
                let across = middle(FINE * column + fine % FINE, FINE * SIDE);
                let along = middle(FINE * row + fine / FINE, FINE * SIDE);
                let direction = FACES[face].through(across, along);
                (direction.normalize(), direction.length_squared().powf(-1.5))
            });
            let total: f64 = rays.iter().map(|(_, weight)| weight).sum();
            rays.map(|(direction, weight)| {
                let [across, down] = Environment::place(direction).map(|v| v as f32);
                LightRay { across, down, share: (weight / total) as f32 }
            })
        });
        Self { rays: rays.collect() }
    }
}

impl CubeLightSampler {
    /// Returns the light of an environment map, as means over each texel, turned about the vertical by `rotation`
    /// radians, counter-clockwise seen from above.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "places are brought into the map"
    )]
    pub fn light(&self, environment: &Environment, rotation: f64) -> CubeLight {
        let ([width, height], texels) = (environment.size(), environment.texels());
        // A turn about the vertical moves a map sideways.
        let turn = (rotation / std::f64::consts::TAU).rem_euclid(1.0) as f32;
        let at = |position: f32, count: usize| ((position * count as f32) as usize).min(count - 1);
        let radiance = self.rays.par_iter().map(|rays| {
            let mut sum = [0.0_f32; 3];
            for ray in rays {
                let column = at((ray.across + turn).fract(), width);
                let texel = texels[at(ray.down, height) * width + column];
                sum.iter_mut().zip(texel).for_each(|(sum, v)| *sum += ray.share * v);
            }
            sum
        });
        CubeLight { radiance: radiance.collect() }
    }
}

impl CubeLight {
    /// Returns light of the same radiance from everywhere.
    pub fn uniform(radiance: [f32; 3]) -> Self {
        Self { radiance: vec![radiance; TEXELS] }
    }

    /// Returns the wavelet coefficients that `rule` chooses.
    pub fn coefficients(&self, rule: LightRule) -> LitCoefficients {
        let mut values: Vec<f32> = self.radiance.as_flattened().to_vec();
        let mut scratch = vec![0.0; 3 * FACE_TEXELS];
        for face in values.chunks_exact_mut(3 * FACE_TEXELS) {
            haar::transform(face, 3, &mut scratch);
        }
        let values = values.as_chunks::<3>().0;
        let places: Vec<usize> = match rule {
            LightRule::All => {
                (0..TEXELS).filter(|at| values[*at].iter().any(|v| v.abs() > 0.0)).collect()
            }
            LightRule::Paper => {
                let size = |value: &[f32; 3]| value.iter().fold(0.0_f32, |m, v| m.max(v.abs()));
                let largest = values.iter().map(size).fold(0.0, f32::max);
                let is_kept = |at: &usize| {
                    let code = (size(&values[*at]) / largest * 32767.0).round();
                    largest > 0.0 && code >= 1024.0
                };
                (0..TEXELS).filter(is_kept).collect()
            }
            LightRule::Energy => by_energy(values),
        };
        LitCoefficients {
            values: places.iter().map(|at| values[*at]).collect(),
            places: places.iter().map(|at| u16::try_from(*at).unwrap_or(u16::MAX)).collect(),
        }
    }
}

fn by_energy(values: &[[f32; 3]]) -> Vec<usize> {
    let energies: Vec<f64> =
        values.iter().map(|v| v.iter().map(|v| f64::from(*v).powi(2)).sum()).collect();
    let mut order: Vec<usize> = (0..values.len()).filter(|at| energies[*at] > 0.0).collect();
    let by_size = |a: &usize, b: &usize| energies[*b].total_cmp(&energies[*a]).then(a.cmp(b));
    if order.len() > MOST {
        order.select_nth_unstable_by(MOST, by_size);
        order.truncate(MOST);
    }
    order.sort_unstable_by(by_size);
    // The brightest would hold all of it alone where a lamp is in the sky.
    let brightest = (TEXELS / 100).min(order.len());
    let total: f64 = energies.iter().sum();
    let rest = total - order[..brightest].iter().map(|at| energies[*at]).sum::<f64>();
    let mut held = 0.0;
    let more = order[brightest..].iter().take_while(|at| {
        let is_missing = held < HELD * rest;
        held += energies[**at];
        is_missing
    });
    let count = (brightest + more.count()).max(LEAST).min(order.len());
    order.truncate(count);
    order.sort_unstable();
    order
}

impl LitCoefficients {
    /// Returns the places of the coefficients, ascending.
    pub fn places(&self) -> &[u16] {
        &self.places
    }

    /// Returns red, green and blue of each coefficient.
    pub fn values(&self) -> &[[f32; 3]] {
        &self.values
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lamp(column: usize) -> Environment {
        let mut texels = vec![[0.01; 3]; 64 * 32];
        for row in 14..18 {
            texels[row * 64 + column] = [20.0, 10.0, 5.0];
        }
        Environment::new(64, 32, texels).unwrap()
    }

    #[test]
    fn energy_is_that_of_the_radiance() {
        let light = CubeLightSampler::default().light(&lamp(40), 0.0);
        let all = light.coefficients(LightRule::All);
        let energy = |values: &[[f32; 3]]| -> f64 {
            values.as_flattened().iter().map(|v| f64::from(*v).powi(2)).sum()
        };
        assert!((energy(all.values()) / energy(&light.radiance) - 1.0).abs() < 1e-5, "Parseval");
        for (rule, least, most) in [(LightRule::Paper, 1, 600), (LightRule::Energy, 50, 1000)] {
            let some = light.coefficients(rule);
            assert!(
                (least..=most).contains(&some.places().len()),
                "{rule:?}: {}",
                some.places().len()
            );
            assert!(energy(some.values()) > 0.95 * energy(all.values()), "{rule:?}");
            assert!(some.places().is_sorted());
        }
    }

    #[test]
    fn a_lamp_stands_where_the_environment_has_it_and_turns() {
        let brightest = |light: &CubeLight| {
            let mean = (0..TEXELS).map(|texel| {
                f64::from(light.radiance[texel][0]).powi(2) * crate::cube::direction(texel)
            });
            mean.sum::<DVec3>().normalize()
        };
        // Columns grow from +z over −x, −z (the middle) and +x.
        let right = brightest(&CubeLightSampler::default().light(&lamp(48), 0.0));
        assert!(right.x > 0.98, "{right}");
        let turned =
            brightest(&CubeLightSampler::default().light(&lamp(48), std::f64::consts::FRAC_PI_2));
        assert!(turned.z < -0.98, "a quarter to the left: {turned}");
    }
}
