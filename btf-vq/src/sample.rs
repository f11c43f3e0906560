//! Importance sampling: light directions for a view, distributed as the luminance that is stored.
//!
//! Source: Havran, Filip and Myszkowski 2010, section 5.2. Between nodes of the view the density is
//! that of the interpolated texel: a node is drawn by its share, then α from the marginal of its slice
//! and β along it, both by inverting piecewise linear densities.

use std::f64::consts::PI;

use glam::DVec3;

use crate::{AngularGrid, Decoder, LpcaDecoder, Pair, Taps, ViewTaps};

/// Directions to lights for one texel and view.
#[derive(Clone, Debug)]
pub struct LightSampler {
    grid: AngularGrid,
    phi_v: f64,
    /// Luminance between the view's nodes, `[alpha][beta]`, 0 and above.
    luminance: Vec<f32>,
    /// Integral of each α node's slice over β, in nodes.
    slices: Vec<f32>,
    /// Integral over all nodes.
    total: f32,
}

impl LightSampler {
    fn new(grid: AngularGrid, phi_v: f64, luminance: Vec<f32>) -> Self {
        let integral = |slice: &[f32]| -> f32 {
            slice.iter().zip(AngularGrid::trapezoid(grid.betas)).map(|(v, w)| v * w).sum()
        };
        let slices: Vec<f32> = luminance.chunks_exact(grid.betas).map(integral).collect();
        let total =
            slices.iter().zip(AngularGrid::trapezoid(grid.alphas)).map(|(s, w)| s * w).sum();
        Self { grid, phi_v, luminance, slices, total }
    }

    /// Whether there is nothing to follow.
    fn is_dark(&self) -> bool {
        self.total.is_nan() || self.total <= 0.0
    }

    /// A unit direction to the light and its density per steradian, from two numbers in [0, 1);
    /// distributed by the cosine where the texel is black.
    pub fn sample(&self, u1: f64, u2: f64) -> (DVec3, f64) {
        if self.is_dark() {
            let radius = u1.sqrt();
            let (sin, cos) = (2.0 * PI * u2).sin_cos();
            let z = (1.0 - u1).max(0.0).sqrt();
            return (DVec3::new(radius * cos, radius * sin, z), z / PI);
        }
        let (alpha, across) = invert(|at| self.slices[at], self.grid.alphas, self.total, u1);
        let (low, high) = (alpha, (alpha + 1).min(self.grid.alphas - 1));
        let value = |at: usize| {
            let of = |alpha: usize| self.luminance[alpha * self.grid.betas + at];
            (1.0 - across) * of(low) + across * of(high)
        };
        let mass = (1.0 - across) * self.slices[low] + across * self.slices[high];
        let (beta, along) = invert(value, self.grid.betas, mass, u2);
        let next = (beta + 1).min(self.grid.betas - 1);
        let luminance = (1.0 - along) * value(beta) + along * value(next);
        #[expect(clippy::cast_precision_loss, reason = "grids are small")]
        let place = (alpha as f64 + f64::from(across), beta as f64 + f64::from(along));
        let sides = self.grid.directions(place.0, place.1, self.phi_v);
        // Where two directions share a place, digits that the inversion does not use choose.
        let wi = sides[usize::from((u2 * 4096.0).fract() >= 0.5)];
        (wi, f64::from(luminance / self.total) / self.grid.cell_solid_angle())
    }

    /// The density, per steradian, with which [`LightSampler::sample`] gives a unit direction of the
    /// upper hemisphere.
    pub fn density(&self, wi: DVec3) -> f64 {
        if wi.z < 0.0 {
            return 0.0;
        }
        if self.is_dark() {
            return wi.z / PI;
        }
        let light = self.grid.light_taps(wi, self.phi_v);
        let mut sum = 0.0;
        for (alpha, w_alpha) in light.alpha.iter() {
            for (beta, w_beta) in light.beta.iter() {
                sum += w_alpha * w_beta * self.luminance[alpha * self.grid.betas + beta];
            }
        }
        f64::from(sum / self.total) / self.grid.cell_solid_angle()
    }
}

/// Place in a piecewise linear density with values at `count` nodes and integral `total`, counted in
/// nodes, as the node below and the part beyond it.
#[expect(clippy::cast_possible_truncation, reason = "weights are f32")]
fn invert(value: impl Fn(usize) -> f32, count: usize, total: f32, u: f64) -> (usize, f32) {
    let mut wanted = u as f32 * total;
    let (mut at, mut low) = (0, value(0));
    loop {
        let high = value(at + 1);
        let mass = 0.5 * (low + high);
        if wanted < mass || at + 2 >= count {
            // ½ (high − low) t² + low t = wanted, in a form that loses no digits.
            let root = (low * low + 2.0 * (high - low) * wanted).max(0.0).sqrt();
            let t = if low + root > 0.0 { 2.0 * wanted / (low + root) } else { 0.5 };
            return (at, t.clamp(0.0, 1.0));
        }
        wanted -= mass;
        (at, low) = (at + 1, high);
    }
}

impl Decoder<'_> {
    /// Directions to lights for a texel of a level and a unit view direction.
    ///
    /// # Panics
    ///
    /// If there is no such level.
    pub fn light_sampler(&self, level: usize, texel: usize, wo: DVec3) -> LightSampler {
        let (view, phi_v) = self.grid().view_taps(wo);
        let mut luminance = vec![0.0; self.grid().slice_len()];
        for (node, weight) in view_nodes(&view, self.grid()) {
            self.add_view_luminance(level, texel, node, weight, &mut luminance);
        }
        LightSampler::new(*self.grid(), phi_v, luminance)
    }
}

impl LpcaDecoder<'_> {
    /// Directions to lights for a texel of a level and a unit view direction.
    ///
    /// # Panics
    ///
    /// If there is no such level or texel.
    pub fn light_sampler(&self, level: usize, texel: usize, wo: DVec3) -> LightSampler {
        let (view, phi_v) = self.grid().view_taps(wo);
        let mut luminance = vec![0.0; self.grid().slice_len()];
        let mut one = luminance.clone();
        for (node, weight) in view_nodes(&view, self.grid()) {
            self.view_luminance(level, texel, node, &mut one);
            luminance.iter_mut().zip(&one).for_each(|(sum, v)| *sum += weight * v);
        }
        LightSampler::new(*self.grid(), phi_v, luminance)
    }
}

/// Nodes `[phi][theta]` around a view and their weights, without those of none.
fn view_nodes(view: &ViewTaps, grid: &AngularGrid) -> impl Iterator<Item = (usize, f32)> {
    let (theta, phi, thetas): (Pair, Pair, usize) = (view.theta, view.phi, grid.thetas);
    phi.iter()
        .flat_map(move |(p, wp)| theta.iter().map(move |(t, wt)| (p * thetas + t, wp * wt)))
        .filter(|(_, weight)| *weight > 0.0)
}

/// A light sampled for a texel at once: the direction, its density, and how the taps lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampledLight {
    /// Unit direction.
    pub wi: DVec3,
    /// Per steradian.
    pub density: f64,
}

impl Decoder<'_> {
    /// One direction for a texel of the finest level, without tabulating its slice: for renderers that
    /// draw one light a texel. The same distribution as [`Decoder::light_sampler`].
    ///
    /// # Panics
    ///
    /// If there are no levels.
    pub fn sample_light(&self, texel: usize, wo: DVec3, u1: f64, u2: f64) -> SampledLight {
        let (view, phi_v) = self.grid().view_taps(wo);
        let Some((place, total)) = self.draw(texel, &view, u1, u2) else {
            let (wi, density) = self.light_sampler(0, texel, wo).sample(u1, u2);
            return SampledLight { wi, density };
        };
        let sides = self.grid().directions(place[0], place[1], phi_v);
        let wi = sides[usize::from((u2 * 4096.0).fract() >= 0.5)];
        let taps = Taps { view, light: self.grid().place_taps(place[0], place[1]) };
        let luminance = self.luminance(texel, &taps);
        SampledLight { wi, density: f64::from(luminance / total) / self.grid().cell_solid_angle() }
    }

    /// Place between the light's nodes and the integral of the texel's luminance over them.
    #[expect(clippy::cast_precision_loss, reason = "grids are small")]
    fn draw(&self, texel: usize, view: &ViewTaps, u1: f64, u2: f64) -> Option<([f64; 2], f32)> {
        let mut nodes = [(0, 0.0_f32); 4];
        let mut total = 0.0;
        let found = view_nodes(view, self.grid()).zip(&mut nodes);
        for ((node, weight), slot) in found {
            let (p2, scale) = self.view_slice(texel, node);
            *slot = (p2, weight * scale * self.slice_mass(p2));
            total += slot.1;
        }
        if total.is_nan() || total <= 0.0 {
            return None;
        }
        #[expect(clippy::cast_possible_truncation, reason = "masses are f32")]
        let mut wanted = u1 as f32 * total;
        let mut chosen = nodes.iter().rposition(|n| n.1 > 0.0)?;
        for (at, (_, mass)) in nodes.iter().enumerate() {
            if wanted < *mass {
                chosen = at;
                break;
            }
            wanted -= mass;
        }
        let (p2, mass) = nodes[chosen];
        let u1 = f64::from((wanted / mass).clamp(0.0, 1.0 - f32::EPSILON));
        let betas = self.grid().betas;
        let (alpha, across) =
            invert(|at| self.row_mass(p2, at), self.grid().alphas, self.slice_mass(p2), u1);
        let rows = [self.p1_row(p2, alpha), self.p1_row(p2, alpha + 1)];
        let value = |at: usize| {
            let of = |row: (usize, f32)| row.1 * self.p1_value(row.0, at);
            (1.0 - across) * of(rows[0]) + across * of(rows[1])
        };
        let row_mass =
            (1.0 - across) * self.row_mass(p2, alpha) + across * self.row_mass(p2, alpha + 1);
        let (beta, along) = invert(value, betas, row_mass, u2);
        let place = [alpha as f64 + f64::from(across), beta as f64 + f64::from(along)];
        Some((place, total))
    }
}
