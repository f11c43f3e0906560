//! Reproducible random planes and rotations.

use std::f64::consts::TAU;

use brdf_param::Projection;
use glam::DQuat;
use rand_core::{Rng as _, SeedableRng as _};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::Rotation4;

/// A generator that belongs to one start of one stage, so that starts may run in any order.
#[derive(Clone, Debug)]
pub(crate) struct StartRng(Xoshiro256PlusPlus);

impl StartRng {
    /// The generator of a start.
    pub(crate) fn new(seed: u64, stage: u64, start: u64) -> Self {
        let mixed = seed
            .wrapping_mul(0x9e37_79b9_7f4a_7c15)
            .wrapping_add(stage.wrapping_mul(0xbf58_476d_1ce4_e5b9))
            .wrapping_add(start.wrapping_mul(0x94d0_49bb_1331_11eb));
        Self(Xoshiro256PlusPlus::seed_from_u64(mixed))
    }

    /// Four independent normal numbers: a uniformly distributed direction in four dimensions.
    pub(crate) fn normal4(&mut self) -> [f64; 4] {
        let [a, b] = self.normal_pair();
        let [c, d] = self.normal_pair();
        [a, b, c, d]
    }

    /// A uniformly distributed plane, in a uniformly distributed frame.
    pub(crate) fn projection(&mut self) -> Projection {
        loop {
            // Dependent rows have probability 0.
            if let Ok(projection) = Projection::from_rows(self.normal4(), self.normal4()) {
                return projection;
            }
        }
    }

    /// A plane u + iv = cos θ z₁ + sin θ e^{iφ} z₂ of the complex coordinates z₁ = x + iy and z₂ = z + iw, or
    /// of z₁ and the conjugate of z₂, θ and φ uniform.
    ///
    /// Such planes turn with both directions, or against one; the minima found for isotropic
    /// materials are mostly close to one of them.
    pub(crate) fn turning_projection(&mut self) -> Projection {
        let (b, a) = (TAU * self.uniform()).sin_cos();
        let (sin, cos) = (TAU * self.uniform()).sin_cos();
        let mirror = if self.uniform() < 0.5 { -1.0 } else { 1.0 };
        let rows = [[a, 0.0, b * cos, -mirror * b * sin], [0.0, a, b * sin, mirror * b * cos]];
        Projection::from_rows(rows[0], rows[1]).unwrap_or(Projection::FIRST)
    }

    /// The plane of one component of each direction, along random axes.
    pub(crate) fn component_projection(&mut self) -> Projection {
        let (sin_a, cos_a) = (TAU * self.uniform()).sin_cos();
        let (sin_b, cos_b) = (TAU * self.uniform()).sin_cos();
        let rows = [[cos_a, sin_a, 0.0, 0.0], [0.0, 0.0, cos_b, sin_b]];
        Projection::from_rows(rows[0], rows[1]).unwrap_or(Projection::FIRST)
    }

    /// A plane of one kind or another, mostly of one component of each direction: minima in
    /// half/difference space, where d is measured from a frame that does not turn with h, have many of
    /// those.
    pub(crate) fn mixed_projection(&mut self) -> Projection {
        match self.uniform() {
            x if x < 0.2 => self.turning_projection(),
            x if x < 0.8 => self.component_projection(),
            _ => self.projection(),
        }
    }

    /// A uniformly distributed rotation.
    pub(crate) fn rotation(&mut self) -> Rotation4 {
        loop {
            let [left, right] = [self.normal4(), self.normal4()].map(DQuat::from_array);
            // Zero has probability 0.
            if let Some(rotation) = Rotation4::new(left, right) {
                return rotation;
            }
        }
    }

    /// Two independent normal numbers (Box and Muller 1958).
    fn normal_pair(&mut self) -> [f64; 2] {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        let (sin, cos) = (TAU * self.uniform()).sin_cos();
        [radius * cos, radius * sin]
    }

    fn uniform(&mut self) -> f64 {
        let bits = (self.0.next_u64() >> 11) as f64;
        bits / 9_007_199_254_740_992.0
    }
}
