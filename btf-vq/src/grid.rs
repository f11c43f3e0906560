//! The grid that texels are resampled to: light directions as onion slices turned with the view,
//! views by angles.
//!
//! Source: V. Havran, J. Filip and K. Myszkowski, "Bidirectional Texture Function Compression Based
//! on Multi-Level Vector Quantization", Computer Graphics Forum 29(1), 2010, section 4.1.

use std::f32::consts::{FRAC_PI_2 as FRAC_PI_2_F32, PI as PI_F32, TAU as TAU_F32};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

use crate::VqError;

/// The map from a light direction to (α, sin β), relative to the azimuth of the view.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum LightParametrization {
    /// sin β = sin θi sin(φi − φv), α = atan2(sin θi cos(φi − φv), cos θi): the mirror direction lies
    /// in the middle of every slice, as the paper's text and figures say.
    #[default]
    Corrected,
    /// Eq. 3 as printed: sin β = sin θi cos(φi − φv), α = arccos(cos θi / cos β) ≥ 0, which takes the
    /// two sides of the plane of incidence for one; a node holds their mean.
    Eq3,
}

/// The grid of directions of a resampled texel, with nodes `[phi_v][theta_v][alpha][beta]`.
///
/// α runs over its range in equal steps, sin β over [−1, 1] (so that dω = dα d(sin β)), θv over
/// [0, π/2] with both ends, φv over the circle.
///
/// ```
/// let grid = btf_vq::AngularGrid::default();
/// assert_eq!(grid.node_count(), 11 * 11 * 7 * 16);
/// assert!(grid.check().is_ok());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct AngularGrid {
    /// Slices of the light hemisphere, at least 2.
    pub alphas: usize,
    /// Nodes along a slice, at least 2.
    pub betas: usize,
    /// Polar angles of the view, at least 2.
    pub thetas: usize,
    /// Azimuths of the view; 1 for isotropic materials.
    pub phis: usize,
    /// Map from light directions to α and sin β.
    pub parametrization: LightParametrization,
}

impl Default for AngularGrid {
    /// The paper's 11 × 11 × 7 × 16.
    fn default() -> Self {
        let parametrization = LightParametrization::Corrected;
        Self { alphas: 11, betas: 11, thetas: 7, phis: 16, parametrization }
    }
}

/// Two neighbouring nodes and their weights, which sum to 1. The second follows the first, except where a circle
/// closes.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Pair {
    /// Indices.
    pub at: [usize; 2],
    /// Weights in [0, 1].
    pub weight: [f32; 2],
}

impl Pair {
    /// The nodes around a position on `count` nodes from 0 to `count` − 1, which it is clamped to.
    #[inline]
    fn around(position: f32, count: usize) -> Self {
        let clamped = position.clamp(0.0, (count - 1) as f32);
        let (low, upper) = parts(clamped, count - 2);
        Self { at: [low, low + 1], weight: [1.0 - upper, upper] }
    }

    /// The same on a circle of `count` nodes, of a position less than a turn from 0.
    #[inline]
    fn around_circle(position: f32, count: usize) -> Self {
        let turned = if position < 0.0 { position + count as f32 } else { position };
        let (low, upper) = parts(turned, count - 1);
        let high = if low + 1 < count { low + 1 } else { 0 };
        Self { at: [low, high], weight: [1.0 - upper, upper] }
    }

    /// Returns both nodes with their weights.
    pub fn iter(&self) -> impl Iterator<Item = (usize, f32)> + use<> {
        let Self { at, weight } = *self;
        (0..2).map(move |i| (at[i], weight[i]))
    }
}

/// The node below a position, 0 and above, that is at most `last`, and how far beyond it lies.
#[inline]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a position between nodes"
)]
fn parts(position: f32, last: usize) -> (usize, f32) {
    let low = (position as usize).min(last);
    (low, position - low as f32)
}

/// Angle of (x, y) in radians to within 3e-7, without branches: a tap takes three, and those of the
/// standard library took a third of the time of decoding a texel.
///
/// Source: M. Abramowitz and I. Stegun, Handbook of Mathematical Functions, 4.4.49.
#[inline]
fn fast_atan2(y: f32, x: f32) -> f32 {
    const COEFFICIENTS: [f32; 8] = [
        0.002_866_225_7,
        -0.016_165_737,
        0.042_909_614,
        -0.075_289_64,
        0.106_562_64,
        -0.142_089,
        0.199_935_51,
        -0.333_331_45,
    ];
    let (low, high) = (x.abs().min(y.abs()), x.abs().max(y.abs()));
    let ratio = if high > 0.0 { low / high } else { 0.0 };
    let square = ratio * ratio;
    let series = COEFFICIENTS.iter().fold(0.0, |sum, c| sum * square + c);
    let octant = ratio + ratio * square * series;
    let quadrant = if y.abs() > x.abs() { FRAC_PI_2_F32 - octant } else { octant };
    let half = if x < 0.0 { PI_F32 - quadrant } else { quadrant };
    half.copysign(y)
}

/// The nodes around a view direction and their weights.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct ViewTaps {
    /// Nodes along θv.
    pub theta: Pair,
    /// Nodes along φv.
    pub phi: Pair,
}

/// The nodes around a light direction and their weights.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct LightTaps {
    /// Nodes along α.
    pub alpha: Pair,
    /// Nodes along sin β.
    pub beta: Pair,
}

impl AngularGrid {
    /// Checks the numbers of nodes.
    ///
    /// # Errors
    ///
    /// [`VqError::Grid`] where they leave nothing to interpolate or more than 2²⁴ nodes.
    pub fn check(&self) -> Result<(), VqError> {
        let Self { alphas, betas, thetas, phis, .. } = *self;
        let nodes = [alphas, betas, thetas, phis]
            .iter()
            .try_fold(1_usize, |product, count| product.checked_mul(*count));
        let is_fine = alphas >= 2 && betas >= 2 && thetas >= 2 && phis >= 1;
        if !is_fine || nodes.is_none_or(|n| n > 1 << 24) {
            return Err(VqError::Grid { alphas, betas, thetas, phis });
        }
        Ok(())
    }

    /// Returns the number of nodes of the light hemisphere for one view.
    pub fn slice_len(&self) -> usize {
        self.alphas * self.betas
    }

    /// Returns the number of views.
    pub fn view_count(&self) -> usize {
        self.thetas * self.phis
    }

    /// Returns the number of nodes of a texel in one channel.
    pub fn node_count(&self) -> usize {
        self.view_count() * self.slice_len()
    }

    /// Returns θv and φv of a view, in radians; `view` counts `[phi][theta]`.
    pub fn view_angles(&self, view: usize) -> (f64, f64) {
        let (phi, theta) = (view / self.thetas, view % self.thetas);
        let theta = FRAC_PI_2 * theta as f64 / (self.thetas - 1) as f64;
        (theta, TAU * phi as f64 / self.phis as f64)
    }

    /// Lowest α and extent, radians.
    fn alpha_range(&self) -> (f64, f64) {
        match self.parametrization {
            LightParametrization::Corrected => (-FRAC_PI_2, PI),
            LightParametrization::Eq3 => (0.0, FRAC_PI_2),
        }
    }

    /// Returns the solid angle, in sr, of the rectangle between neighbouring nodes of α and sin β.
    pub fn cell_solid_angle(&self) -> f64 {
        // Eq. 3 takes two directions for one.
        let sides = PI / self.alpha_range().1;
        sides * self.alpha_range().1 / (self.alphas - 1) as f64 * 2.0 / (self.betas - 1) as f64
    }

    /// Returns the unit directions of a position between the nodes, counted in nodes along α and β: one direction
    /// twice, or the two that Eq. 3 takes for one. `azimuth` is the unit vector towards the view in the plane.
    #[inline]
    pub fn directions(&self, alpha: f64, beta: f64, azimuth: DVec2) -> [DVec3; 2] {
        let (lowest, range) = self.alpha_range();
        let steps = ((self.alphas - 1) as f64, (self.betas - 1) as f64);
        // α never leaves the half circle on which its cosine is positive.
        let sin_alpha = (lowest + range * alpha / steps.0).sin();
        let cos_alpha = (1.0 - sin_alpha * sin_alpha).max(0.0).sqrt();
        let sin_beta = -1.0 + 2.0 * beta / steps.1;
        let cos_beta = (1.0 - sin_beta * sin_beta).max(0.0).sqrt();
        let z = (cos_alpha * cos_beta).max(0.0);
        let world = |along: f64, across: f64| (azimuth * along + azimuth.perp() * across).extend(z);
        let turned = sin_alpha * cos_beta;
        match self.parametrization {
            LightParametrization::Corrected => [world(turned, sin_beta); 2],
            LightParametrization::Eq3 => [world(sin_beta, turned), world(sin_beta, -turned)],
        }
    }

    /// Returns the unit directions of a node, as [`AngularGrid::directions`] does.
    pub fn node_directions(&self, alpha: usize, beta: usize, azimuth: DVec2) -> [DVec3; 2] {
        self.directions(alpha as f64, beta as f64, azimuth)
    }

    /// Returns the taps of a unit view direction of the upper hemisphere, and the unit vector towards it in the
    /// plane.
    #[inline]
    #[expect(clippy::cast_possible_truncation, reason = "weights")]
    pub fn view_taps(&self, wo: DVec3) -> (ViewTaps, DVec2) {
        let planar = wo.truncate();
        let radius = planar.length();
        // At the normal the azimuth is any; 0 keeps it the same for all.
        let azimuth = if radius < 1e-12 { DVec2::X } else { planar * radius.recip() };
        let theta = fast_atan2(radius as f32, wo.z.max(0.0) as f32);
        let phi = fast_atan2(azimuth.y as f32, azimuth.x as f32);
        let taps = ViewTaps {
            theta: Pair::around(theta / FRAC_PI_2_F32 * (self.thetas - 1) as f32, self.thetas),
            phi: Pair::around_circle(phi / TAU_F32 * self.phis as f32, self.phis),
        };
        (taps, azimuth)
    }

    /// Returns the taps of a unit light direction of the upper hemisphere for a view towards `azimuth`.
    #[inline]
    #[expect(clippy::cast_possible_truncation, reason = "weights")]
    pub fn light_taps(&self, wi: DVec3, azimuth: DVec2) -> LightTaps {
        let planar = wi.truncate();
        let (along, across) = (azimuth.dot(planar), azimuth.perp_dot(planar));
        let (sin_beta, turned) = match self.parametrization {
            LightParametrization::Corrected => (across, along),
            LightParametrization::Eq3 => (along, across.abs()),
        };
        let alpha = fast_atan2(turned as f32, wi.z as f32);
        let (lowest, range) = self.alpha_range();
        let alpha = (alpha - lowest as f32) * ((self.alphas - 1) as f32 / range as f32);
        let beta = 0.5 * (sin_beta as f32 + 1.0) * (self.betas - 1) as f32;
        LightTaps { alpha: Pair::around(alpha, self.alphas), beta: Pair::around(beta, self.betas) }
    }

    /// Returns the taps of a position between the light's nodes, counted in nodes along α and β.
    pub fn place_taps(&self, alpha: f32, beta: f32) -> LightTaps {
        LightTaps { alpha: Pair::around(alpha, self.alphas), beta: Pair::around(beta, self.betas) }
    }

    /// Returns the weights of the trapezoidal rule along one side of `count` nodes of the light grid.
    pub fn trapezoid(count: usize) -> impl Iterator<Item = f32> + Clone {
        (0..count).map(move |i| if i == 0 || i + 1 == count { 0.5 } else { 1.0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_come_back_to_themselves() {
        for parametrization in [LightParametrization::Corrected, LightParametrization::Eq3] {
            let grid = AngularGrid { parametrization, ..AngularGrid::default() };
            for view in 0..grid.view_count() {
                let azimuth = DVec2::from_angle(grid.view_angles(view).1);
                for (alpha, beta) in (0..11).flat_map(|a| (1..10).map(move |b| (a, b))) {
                    for wi in grid.node_directions(alpha, beta, azimuth) {
                        assert!((wi.length() - 1.0).abs() < 1e-12);
                        let taps = grid.light_taps(wi, azimuth);
                        let share = |pair: Pair, at| -> f32 {
                            pair.iter().filter(|(i, _)| *i == at).map(|(_, w)| w).sum()
                        };
                        assert!(share(taps.alpha, alpha) > 1.0 - 1e-5, "{alpha} {beta} {taps:?}");
                        assert!(share(taps.beta, beta) > 1.0 - 1e-5, "{alpha} {beta} {taps:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_mirror_direction_lies_in_the_middle_of_a_slice() {
        let grid = AngularGrid::default();
        let (theta, phi) = (0.7_f64, 1.1_f64);
        let planar = -theta.sin();
        let mirror = DVec3::new(planar * phi.cos(), planar * phi.sin(), theta.cos());
        let taps = grid.light_taps(mirror, DVec2::from_angle(phi));
        let beta: f32 =
            taps.beta.iter().map(|(i, w)| w * f32::from(u8::try_from(i).unwrap())).sum();
        assert!((beta - 5.0).abs() < 1e-6, "{beta}");
    }

    #[test]
    fn fast_angles_are_those_of_the_standard_library() {
        for i in 0..10_000 {
            let (y, x) = (f64::from(i) * 1e-3 - 5.0).sin_cos();
            #[expect(clippy::cast_possible_truncation, reason = "that is what is tested")]
            let (y, x) = (y as f32, x as f32);
            let wanted = f64::from(y).atan2(f64::from(x));
            assert!((f64::from(fast_atan2(y, x)) - wanted).abs() < 4e-7, "{y} {x}");
        }
        assert!(fast_atan2(0.0, 0.0).abs() < 1e-12);
    }

    #[test]
    fn weights_of_the_sixteen_nodes_sum_to_one() {
        let grid = AngularGrid::default();
        let taps = crate::Taps::new(&grid, DVec3::new(0.6, 0.0, 0.8), DVec3::new(0.0, -0.28, 0.96));
        assert!((taps.nodes(&grid).iter().map(|t| t.1).sum::<f32>() - 1.0).abs() < 1e-6);
    }
}
