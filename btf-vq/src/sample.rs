//! Importance sampling: light directions for a view, distributed as the luminance that is stored.
//!
//! Source: Havran, Filip and Myszkowski 2010, section 5.2. Between nodes of the view the pdf is
//! that of the interpolated texel: a node is drawn by its share, then α from the marginal of its slice
//! and β along it, both by inverting piecewise linear densities.

use std::f64::consts::PI;

use brdf_model::{DirectionSampler, LinearDistributions, linear_part, linear_segment, share_of};
use glam::{DVec2, DVec3};

use crate::decode::ABREAST;
use crate::{AngularGrid, Decoder, LpcaDecoder, Pair, ViewTaps};

/// A sampler of light directions for one texel and view, distributed as its luminance.
#[derive(Clone, Debug)]
pub struct LightSampler {
    grid: AngularGrid,
    /// Unit vector towards the view in the plane.
    azimuth: DVec2,
    /// Luminance between the view's nodes, `[alpha][beta]`, 0 and above.
    luminance: Vec<f32>,
    /// Integrals of each α node's slice over β.
    lines: LinearDistributions,
    /// Of these over α: one row.
    slice: LinearDistributions,
}

impl LightSampler {
    fn new(grid: AngularGrid, azimuth: DVec2, luminance: Vec<f32>) -> Self {
        let value = |alpha: usize, beta| luminance[alpha * grid.betas + beta];
        let lines = LinearDistributions::new(grid.betas, grid.alphas, value);
        let slice = LinearDistributions::new(grid.alphas, 1, |_, alpha| lines.total(alpha));
        Self { grid, azimuth, luminance, lines, slice }
    }

    /// Whether there is nothing to follow.
    fn is_dark(&self) -> bool {
        let total = self.slice.total(0);
        total.is_nan() || total <= 0.0
    }
}

impl DirectionSampler for LightSampler {
    /// Returns a unit direction to the light and its pdf per steradian, from two numbers in [0, 1);
    /// distributed by the cosine where the texel is black.
    fn sample(&self, [u1, u2]: [f64; 2]) -> (DVec3, f64) {
        if self.is_dark() {
            let radius = u1.sqrt();
            let (sin, cos) = (2.0 * PI * u2).sin_cos();
            let z = (1.0 - u1).max(0.0).sqrt();
            return (DVec3::new(radius * cos, radius * sin, z), z / PI);
        }
        let total = self.slice.total(0);
        let (alpha, left) = linear_segment(self.slice.row(0), share_of(u1, total));
        let lines = [alpha, alpha + 1];
        let across = linear_part(lines.map(|line| self.lines.total(line)), left);
        let weights = [1.0 - across, across];
        let (beta, left) = segment_between(lines.map(|line| self.lines.row(line)), weights, u2);
        let value = |beta| -> f32 {
            let values = lines.map(|line| self.luminance[line * self.grid.betas + beta]);
            weights[0] * values[0] + weights[1] * values[1]
        };
        let ends = [value(beta), value(beta + 1)];
        let along = linear_part(ends, left);
        let luminance = (1.0 - along) * ends[0] + along * ends[1];
        let wi = direction(&self.grid, [alpha, beta], [across, along], self.azimuth, u2);
        (wi, f64::from(luminance / total) / self.grid.cell_solid_angle())
    }

    /// Returns the pdf, per steradian, with which `sample` gives a unit direction of the
    /// upper hemisphere.
    fn pdf(&self, wi: DVec3) -> f64 {
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
        f64::from(sum / self.slice.total(0)) / self.grid.cell_solid_angle()
    }
}

/// As [`linear_segment`] in the sum of two weighted densities.
#[inline]
fn segment_between(below: [&[f32]; 2], weights: [f32; 2], u: f64) -> (usize, f32) {
    let last = below[0].len() - 1;
    let (first, second) = (&below[0][..=last], &below[1][..=last]);
    let sum = |at: usize| weights[0] * first[at] + weights[1] * second[at];
    let wanted = share_of(u, sum(last));
    let at = (1..last).map(|at| usize::from(sum(at) <= wanted)).sum();
    (at, wanted - sum(at))
}

/// The unit direction of a place in the grid: the nodes below and the parts beyond them. Digits of `u`
/// that the inversion does not use choose between two directions that share a place.
#[inline]
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "grids are small")]
fn direction(
    grid: &AngularGrid,
    [alpha, beta]: [usize; 2],
    [across, along]: [f32; 2],
    azimuth: DVec2,
    u: f64,
) -> DVec3 {
    let place = (alpha as f64 + f64::from(across), beta as f64 + f64::from(along));
    grid.directions(place.0, place.1, azimuth)[(u * 8192.0) as usize & 1]
}

impl Decoder<'_> {
    /// Returns a sampler of directions to lights for a texel of a level and a unit view direction.
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
    /// Returns a sampler of directions to lights for a texel of a level and a unit view direction.
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

/// A texel and a view for which one light direction is wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightQuery {
    /// The texel of the finest level, row-major.
    pub texel: usize,
    /// Unit view direction of the upper hemisphere.
    pub wo: DVec3,
    /// Two numbers in [0, 1) that decide the direction.
    pub u: [f64; 2],
}

/// A light direction that was drawn for a texel, and its density.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct SampledLight {
    /// Unit direction to the light.
    pub wi: DVec3,
    /// Density with which it was drawn, sr⁻¹.
    pub pdf: f64,
}

impl Decoder<'_> {
    /// Draws one light direction for each of many texels of the finest level, without tabulating their slices: for
    /// renderers that draw one light a texel. The distribution is that of [`Decoder::light_sampler`].
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
        let (mut places, mut totals) = ([([0; 2], [0.0; 2]); N], [0.0; N]);
        for q in 0..N {
            let (node, total, u1) = choose(&masses[q], queries[q].u[0]);
            places[q] = self.place_in_slice(nodes[q][node].0, u1, queries[q].u[1]);
            totals[q] = total;
        }
        let mut lights = [SampledLight::default(); N];
        for (q, light) in lights.iter_mut().enumerate() {
            let (LightQuery { texel, wo, u }, total) = (queries[q], totals[q]);
            let (nodes_below, parts) = places[q];
            *light = if total > 0.0 {
                let values = nodes[q]
                    .iter()
                    .map(|(p2, weight)| weight * self.slice_luminance(*p2, nodes_below, parts));
                let pdf = f64::from(values.sum::<f32>() / total) * self.cells_per_steradian;
                let wi = direction(self.grid(), nodes_below, parts, taps[q].1, u[1]);
                SampledLight { wi, pdf }
            } else {
                let (wi, pdf) = self.light_sampler(0, texel, wo).sample(u);
                SampledLight { wi, pdf }
            };
        }
        lights
    }

    /// Place in a row of P2 from two numbers in [0, 1): the node below and the part beyond it, along α
    /// and β.
    #[inline]
    fn place_in_slice(&self, p2: usize, u1: f64, u2: f64) -> ([usize; 2], [f32; 2]) {
        let wanted = share_of(u1, self.slice_mass(p2));
        let (alpha, left) = linear_segment(self.p2_below(p2), wanted);
        let lines = self.p1_rows(p2, alpha);
        let below = lines.map(|(p1, _)| self.p1_below(p1));
        let across = linear_part([0, 1].map(|i| lines[i].1 * below[i][below[i].len() - 1]), left);
        let weights = [(1.0 - across) * lines[0].1, across * lines[1].1];
        let (beta, left) = segment_between(below, weights, u2);
        let values = lines.map(|(p1, _)| self.p1_pair(p1, beta));
        let ends = [0, 1].map(|i| weights[0] * values[0][i] + weights[1] * values[1][i]);
        ([alpha, beta], [across, linear_part(ends, left)])
    }
}

/// One of a few, by their masses, their sum, and the number left for what follows.
#[inline]
fn choose(masses: &[f32; 4], u: f64) -> (usize, f32, f64) {
    let mut below = [0.0; 4];
    for at in 1..4 {
        below[at] = below[at - 1] + masses[at - 1];
    }
    let total = below[3] + masses[3];
    let wanted = share_of(u, total);
    let at = below[1..].iter().map(|sum| usize::from(*sum <= wanted)).sum::<usize>();
    (at, total, f64::from((wanted - below[at]) / masses[at]))
}
