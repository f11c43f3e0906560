//! Importance sampling: light directions for a view, distributed as the luminance that is stored.
//!
//! Source: Havran, Filip and Myszkowski 2010, section 5.2. Between nodes of the view the density is
//! that of the interpolated texel: a node is drawn by its share, then α from the marginal of its slice
//! and β along it, both by inverting piecewise linear densities.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};

use crate::decode::ABREAST;
use crate::{AngularGrid, Decoder, LpcaDecoder, Pair, ViewTaps};

/// Directions to lights for one texel and view.
#[derive(Clone, Debug)]
pub struct LightSampler {
    grid: AngularGrid,
    /// Unit vector towards the view in the plane.
    azimuth: DVec2,
    /// Luminance between the view's nodes, `[alpha][beta]`, 0 and above.
    luminance: Vec<f32>,
    /// Integral of each α node's slice over β, in nodes.
    slices: Vec<f32>,
    /// Integral over all nodes.
    total: f32,
}

impl LightSampler {
    fn new(grid: AngularGrid, azimuth: DVec2, luminance: Vec<f32>) -> Self {
        let integral = |slice: &[f32]| -> f32 {
            slice.iter().zip(AngularGrid::trapezoid(grid.betas)).map(|(v, w)| v * w).sum()
        };
        let slices: Vec<f32> = luminance.chunks_exact(grid.betas).map(integral).collect();
        let total =
            slices.iter().zip(AngularGrid::trapezoid(grid.alphas)).map(|(s, w)| s * w).sum();
        Self { grid, azimuth, luminance, slices, total }
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
        let sides = self.grid.directions(place.0, place.1, self.azimuth);
        (sides[side(u2)], f64::from(luminance / self.total) / self.grid.cell_solid_angle())
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
        let light = self.grid.light_taps(wi, self.azimuth);
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
#[inline]
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
        let (view, azimuth) = self.grid().view_taps(wo);
        let mut luminance = vec![0.0; self.grid().slice_len()];
        for (node, weight) in view_nodes(&view, self.grid()) {
            self.add_view_luminance(level, texel, node, weight, &mut luminance);
        }
        LightSampler::new(*self.grid(), azimuth, luminance)
    }
}

impl LpcaDecoder<'_> {
    /// Directions to lights for a texel of a level and a unit view direction.
    ///
    /// # Panics
    ///
    /// If there is no such level or texel.
    pub fn light_sampler(&self, level: usize, texel: usize, wo: DVec3) -> LightSampler {
        let (view, azimuth) = self.grid().view_taps(wo);
        let mut luminance = vec![0.0; self.grid().slice_len()];
        let mut one = luminance.clone();
        for (node, weight) in view_nodes(&view, self.grid()) {
            self.view_luminance(level, texel, node, &mut one);
            luminance.iter_mut().zip(&one).for_each(|(sum, v)| *sum += weight * v);
        }
        LightSampler::new(*self.grid(), azimuth, luminance)
    }
}

/// Nodes `[phi][theta]` around a view and their weights, without those of none.
fn view_nodes(view: &ViewTaps, grid: &AngularGrid) -> impl Iterator<Item = (usize, f32)> {
    let (theta, phi, thetas): (Pair, Pair, usize) = (view.theta, view.phi, grid.thetas);
    phi.iter()
        .flat_map(move |(p, wp)| theta.iter().map(move |(t, wt)| (p * thetas + t, wp * wt)))
        .filter(|(_, weight)| *weight > 0.0)
}

/// A texel that wants a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightQuery {
    /// Row-major, of the finest level.
    pub texel: usize,
    /// Unit view direction of the upper hemisphere.
    pub wo: DVec3,
    /// Two numbers in [0, 1).
    pub u: [f64; 2],
}

/// A light sampled for a texel.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct SampledLight {
    /// Unit direction.
    pub wi: DVec3,
    /// Per steradian.
    pub density: f64,
}

impl Decoder<'_> {
    /// One direction for each of many texels of the finest level, without tabulating their slices: for
    /// renderers that draw one light a texel. The same distribution as [`Decoder::light_sampler`].
    ///
    /// # Panics
    ///
    /// If there are no levels, or unless `out` is as long as `queries`.
    pub fn sample_lights(&self, queries: &[LightQuery], out: &mut [SampledLight]) {
        assert_eq!(queries.len(), out.len(), "a light for each query");
        let (groups, rest) = queries.as_chunks::<ABREAST>();
        let (out_groups, out_rest) = out.as_chunks_mut::<ABREAST>();
        for (group, lights) in groups.iter().zip(out_groups) {
            *lights = self.sample_abreast(group);
        }
        for (query, light) in rest.iter().zip(out_rest) {
            [*light] = self.sample_abreast(&[*query]);
        }
    }

    #[inline]
    fn sample_abreast<const N: usize>(&self, queries: &[LightQuery; N]) -> [SampledLight; N] {
        // Loops instead of maps of arrays, whose closures stay calls.
        let mut taps = [(ViewTaps::default(), DVec2::X); N];
        let mut texels = [0; N];
        for ((query, taps), texel) in queries.iter().zip(&mut taps).zip(&mut texels) {
            *taps = self.grid().view_taps(query.wo);
            *texel = query.texel;
        }
        let nodes = self.view_slices(texels, taps.each_ref().map(|t| &t.0));
        let mut masses = [[0.0; 4]; N];
        for (nodes, masses) in nodes.iter().zip(&mut masses) {
            for ((p2, weight), mass) in nodes.iter().zip(masses) {
                *mass = weight * self.slice_mass(*p2);
            }
        }
        let mut lights = [SampledLight::default(); N];
        for (q, light) in lights.iter_mut().enumerate() {
            *light = self.sample_view(&queries[q], taps[q].1, &nodes[q], &masses[q]);
        }
        lights
    }

    /// One direction from rows of P2 around the view, what each counts, and their integrals.
    fn sample_view(
        &self,
        query: &LightQuery,
        azimuth: DVec2,
        nodes: &[(usize, f32); 4],
        masses: &[f32; 4],
    ) -> SampledLight {
        let [u1, u2] = query.u;
        let total: f32 = masses.iter().sum();
        if total.is_nan() || total <= 0.0 {
            let (wi, density) = self.light_sampler(0, query.texel, query.wo).sample(u1, u2);
            return SampledLight { wi, density };
        }
        let (node, u1) = choose(masses, total, u1);
        let ([alpha, beta], [across, along]) = self.place_in_slice(nodes[node].0, u1, u2);
        let luminance: f32 = nodes
            .iter()
            .map(|(p2, weight)| weight * self.slice_luminance(*p2, [alpha, beta], [across, along]))
            .sum();
        #[expect(clippy::cast_precision_loss, reason = "grids are small")]
        let place = (alpha as f64 + f64::from(across), beta as f64 + f64::from(along));
        let sides = self.grid().directions(place.0, place.1, azimuth);
        let wi = sides[side(u2)];
        SampledLight { wi, density: f64::from(luminance / total) * self.cells_per_steradian }
    }

    /// Place in a row of P2 from two numbers in [0, 1): the node below and the part beyond it, along α
    /// and β.
    #[inline]
    fn place_in_slice(&self, p2: usize, u1: f64, u2: f64) -> ([usize; 2], [f32; 2]) {
        let grid = self.grid();
        let (alpha, across) =
            invert(|at| self.row_mass(p2, at), grid.alphas, self.slice_mass(p2), u1);
        let [low, high] = self.p1_rows(p2, alpha);
        let scales = [(1.0 - across) * low.1, across * high.1];
        let mass = scales[0] * self.p1_mass(low.0) + scales[1] * self.p1_mass(high.0);
        let value =
            |at| scales[0] * self.p1_value(low.0, at) + scales[1] * self.p1_value(high.0, at);
        let (beta, along) = invert(value, grid.betas, mass, u2);
        ([alpha, beta], [across, along])
    }
}

/// One of a few, by their masses, and the number left for what follows.
#[inline]
#[expect(clippy::cast_possible_truncation, reason = "masses are f32")]
fn choose(masses: &[f32; 4], total: f32, u: f64) -> (usize, f64) {
    let mut wanted = u as f32 * total;
    let mut chosen = masses.iter().rposition(|mass| *mass > 0.0).unwrap_or(0);
    for (at, mass) in masses.iter().enumerate() {
        if wanted < *mass {
            chosen = at;
            break;
        }
        wanted -= mass;
    }
    (chosen, f64::from((wanted / masses[chosen]).clamp(0.0, 1.0 - f32::EPSILON)))
}

/// Which of two directions that share a place: digits that the inversion does not use choose.
#[inline]
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below 8192")]
fn side(u: f64) -> usize {
    (u * 8192.0) as usize & 1
}
