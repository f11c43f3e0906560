//! The grid that texels are resampled to: light directions as onion slices turned with the view,
//! views by angles.
//!
//! Source: V. Havran, J. Filip and K. Myszkowski, "Bidirectional Texture Function Compression Based
//! on Multi-Level Vector Quantization", Computer Graphics Forum 29(1), 2010, section 4.1.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::VqError;

/// How a light direction becomes (α, sin β), relative to the azimuth of the view.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
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

/// Nodes of a resampled texel, `[phi_v][theta_v][alpha][beta]`.
///
/// α runs over its range in equal steps, sin β over [−1, 1] (so that dω = dα d(sin β)), θv over
/// [0, π/2] with both ends, φv over the circle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
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
    /// What α and β are.
    pub parametrization: LightParametrization,
}

impl Default for AngularGrid {
    /// The paper's 11 × 11 × 7 × 16.
    fn default() -> Self {
        let parametrization = LightParametrization::Corrected;
        Self { alphas: 11, betas: 11, thetas: 7, phis: 16, parametrization }
    }
}

/// Two neighbouring nodes and their weights, which sum to 1.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Pair {
    /// Indices.
    pub at: [usize; 2],
    /// Weights in [0, 1].
    pub weight: [f32; 2],
}

impl Pair {
    /// The nodes around a position on `count` nodes from 0 to `count` − 1, which it is clamped to.
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to the grid"
    )]
    fn around(position: f64, count: usize) -> Self {
        let clamped = position.clamp(0.0, (count - 1) as f64);
        let low = (clamped as usize).min(count.saturating_sub(2));
        let upper = (clamped - low as f64) as f32;
        Self { at: [low, (low + 1).min(count - 1)], weight: [1.0 - upper, upper] }
    }

    /// The same on a circle of `count` nodes.
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "reduced to the grid"
    )]
    fn around_circle(position: f64, count: usize) -> Self {
        let reduced = position.rem_euclid(count as f64);
        let low = (reduced as usize).min(count - 1);
        let upper = (reduced - low as f64) as f32;
        Self { at: [low, (low + 1) % count], weight: [1.0 - upper, upper] }
    }

    /// Both nodes with their weights.
    pub fn iter(&self) -> impl Iterator<Item = (usize, f32)> + use<> {
        let Self { at, weight } = *self;
        (0..2).map(move |i| (at[i], weight[i]))
    }
}

/// Where a view direction lies between nodes.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct ViewTaps {
    /// Along θv.
    pub theta: Pair,
    /// Along φv.
    pub phi: Pair,
}

/// Where a light direction lies between nodes.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct LightTaps {
    /// Along α.
    pub alpha: Pair,
    /// Along sin β.
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

    /// Nodes of the light hemisphere for one view.
    pub fn slice_len(&self) -> usize {
        self.alphas * self.betas
    }

    /// Views.
    pub fn view_count(&self) -> usize {
        self.thetas * self.phis
    }

    /// Nodes of a texel in one channel.
    pub fn node_count(&self) -> usize {
        self.view_count() * self.slice_len()
    }

    /// θv and φv of a view in radians; `view` counts `[phi][theta]`.
    #[expect(clippy::cast_precision_loss, reason = "grids are small")]
    pub fn view_angles(&self, view: usize) -> (f64, f64) {
        let (phi, theta) = (view / self.thetas, view % self.thetas);
        let theta = FRAC_PI_2 * theta as f64 / (self.thetas - 1) as f64;
        (theta, TAU * phi as f64 / self.phis as f64)
    }

    /// α, radians, and sin β of a node of the light hemisphere.
    #[expect(clippy::cast_precision_loss, reason = "grids are small")]
    fn light_coordinates(&self, alpha: usize, beta: usize) -> (f64, f64) {
        let (lowest, range) = self.alpha_range();
        let alpha = lowest + range * alpha as f64 / (self.alphas - 1) as f64;
        (alpha, -1.0 + 2.0 * beta as f64 / (self.betas - 1) as f64)
    }

    /// Lowest α and extent, radians.
    fn alpha_range(&self) -> (f64, f64) {
        match self.parametrization {
            LightParametrization::Corrected => (-FRAC_PI_2, PI),
            LightParametrization::Eq3 => (0.0, FRAC_PI_2),
        }
    }

    /// Solid angle, in sr, of the rectangle between neighbouring nodes of α and sin β.
    #[expect(clippy::cast_precision_loss, reason = "grids are small")]
    pub fn cell_solid_angle(&self) -> f64 {
        // Eq. 3 takes two directions for one.
        let sides = PI / self.alpha_range().1;
        sides * self.alpha_range().1 / (self.alphas - 1) as f64 * 2.0 / (self.betas - 1) as f64
    }

    /// The unit directions that a position between the nodes, counted in nodes along α and β, stands
    /// for, in the frame of a view of azimuth `phi_v`: one, or the two that Eq. 3 takes for one.
    pub fn directions(&self, alpha: f64, beta: f64, phi_v: f64) -> [DVec3; 2] {
        #[expect(clippy::cast_precision_loss, reason = "grids are small")]
        let (alpha, s) = {
            let (lowest, range) = self.alpha_range();
            let alpha = lowest + range * alpha / (self.alphas - 1) as f64;
            (alpha, -1.0 + 2.0 * beta / (self.betas - 1) as f64)
        };
        self.unit_directions(alpha, s, phi_v)
    }

    /// The directions of a node.
    pub fn node_directions(&self, alpha: usize, beta: usize, phi_v: f64) -> [DVec3; 2] {
        let (alpha, s) = self.light_coordinates(alpha, beta);
        self.unit_directions(alpha, s, phi_v)
    }

    fn unit_directions(&self, alpha: f64, sin_beta: f64, phi_v: f64) -> [DVec3; 2] {
        let cos_beta = (1.0 - sin_beta * sin_beta).max(0.0).sqrt();
        let (sin_phi, cos_phi) = phi_v.sin_cos();
        let world = |along: f64, across: f64| {
            let z = (alpha.cos() * cos_beta).max(0.0);
            DVec3::new(along * cos_phi - across * sin_phi, along * sin_phi + across * cos_phi, z)
        };
        let turned = alpha.sin() * cos_beta;
        match self.parametrization {
            LightParametrization::Corrected => [world(turned, sin_beta); 2],
            LightParametrization::Eq3 => [world(sin_beta, turned), world(sin_beta, -turned)],
        }
    }

    /// Where a unit view direction of the upper hemisphere lies, and its azimuth in radians.
    #[expect(clippy::cast_precision_loss, reason = "grids are small")]
    pub fn view_taps(&self, wo: DVec3) -> (ViewTaps, f64) {
        let theta = wo.z.clamp(-1.0, 1.0).acos();
        // At the normal the azimuth is any; 0 keeps it the same for all.
        let phi = if wo.x.hypot(wo.y) < 1e-12 { 0.0 } else { wo.y.atan2(wo.x) };
        let taps = ViewTaps {
            theta: Pair::around(theta / FRAC_PI_2 * (self.thetas - 1) as f64, self.thetas),
            phi: Pair::around_circle(phi / TAU * self.phis as f64, self.phis),
        };
        (taps, phi)
    }

    /// Where a unit light direction of the upper hemisphere lies for a view of azimuth `phi_v`.
    #[expect(clippy::cast_precision_loss, reason = "grids are small")]
    pub fn light_taps(&self, wi: DVec3, phi_v: f64) -> LightTaps {
        let (sin_phi, cos_phi) = phi_v.sin_cos();
        let (along, across) = (wi.x * cos_phi + wi.y * sin_phi, wi.y * cos_phi - wi.x * sin_phi);
        let (sin_beta, alpha) = match self.parametrization {
            LightParametrization::Corrected => (across, along.atan2(wi.z)),
            LightParametrization::Eq3 => (along, across.abs().atan2(wi.z)),
        };
        let (lowest, range) = self.alpha_range();
        LightTaps {
            alpha: Pair::around((alpha - lowest) / range * (self.alphas - 1) as f64, self.alphas),
            beta: Pair::around(0.5 * (sin_beta + 1.0) * (self.betas - 1) as f64, self.betas),
        }
    }

    /// The taps of a position between the light's nodes, counted in nodes along α and β.
    pub fn place_taps(&self, alpha: f64, beta: f64) -> LightTaps {
        LightTaps { alpha: Pair::around(alpha, self.alphas), beta: Pair::around(beta, self.betas) }
    }

    /// Weights of the trapezoidal rule along one side of the light grid.
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
                let (_, phi_v) = grid.view_angles(view);
                for (alpha, beta) in (0..11).flat_map(|a| (1..10).map(move |b| (a, b))) {
                    for wi in grid.node_directions(alpha, beta, phi_v) {
                        assert!((wi.length() - 1.0).abs() < 1e-12);
                        let taps = grid.light_taps(wi, phi_v);
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
        let taps = grid.light_taps(mirror, phi);
        let beta: f32 =
            taps.beta.iter().map(|(i, w)| w * f32::from(u8::try_from(i).unwrap())).sum();
        assert!((beta - 5.0).abs() < 1e-6, "{beta}");
    }

    #[test]
    fn weights_of_the_sixteen_nodes_sum_to_one() {
        let grid = AngularGrid::default();
        let taps = crate::Taps::new(&grid, DVec3::new(0.6, 0.0, 0.8), DVec3::new(0.0, -0.28, 0.96));
        assert!((taps.nodes(&grid).iter().map(|t| t.1).sum::<f32>() - 1.0).abs() < 1e-6);
    }
}
