//! Checks of physical plausibility: reciprocity, energy, and how much of the domain has data.

use std::f64::consts::PI;

use brdf_param::{DirectionPair, polar_angle, spherical_direction};
use serde::Serialize;

use crate::sampling::cosine_hemisphere;
use crate::{Brdf, DirectionBatch, PairSampling, Rgb, RgbBatch, SampleSet, ScrambledSobol};

/// The results of [`check`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PhysicalChecks {
    /// Mean of |f(a, b) − f(b, a)| divided by the mean of f, over all channels.
    pub reciprocity_error: f64,
    /// Largest directional albedo of any channel; above 1, more light leaves than arrives.
    pub largest_albedo: f64,
    /// Angle of incidence at which the largest albedo occurs, degrees.
    pub largest_albedo_theta_deg: f64,
    /// Share of pairs within the grazing limit that have data.
    pub coverage: Coverage,
}

/// The share of the domain that has data.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Coverage {
    /// Share of pairs with data, [0, 1].
    pub share: f64,
    /// Largest angle to the normal of the pairs that were drawn, degrees.
    pub max_theta_deg: f64,
}

/// Returns the reciprocity error, the largest albedo and the coverage of a model.
///
/// Reciprocity and coverage are taken over 20,000 pairs within `theta_max` radians of the normal, the
/// albedo over sixteen angles of incidence up to `theta_max`.
///
/// ```
/// use brdf_model::{Preset, check};
///
/// let lambert = Preset::find("lambert").expect("a preset of this crate").brdf();
/// let checks = check(&lambert, 1.4);
/// assert!(checks.reciprocity_error < 1e-12);
/// assert!((checks.largest_albedo - 0.5).abs() < 1e-2);
/// assert_eq!(checks.coverage.share, 1.0);
/// ```
pub fn check(brdf: &dyn Brdf, theta_max: f64) -> PhysicalChecks {
    let sampling = PairSampling { count: 20_000, seed: 1, theta_max };
    let (mut difference, mut sum, mut covered) = (0.0, 0.0, 0_u32);
    for pair in sampling.pairs() {
        let swapped = pair.swapped();
        if !brdf.has_data(&pair) || !brdf.has_data(&swapped) {
            continue;
        }
        covered += 1;
        let (forward, backward) = (brdf.eval(&pair), brdf.eval(&swapped));
        let total = |value: Rgb| value.channels().iter().sum::<f64>();
        difference += total((forward - backward).map(f64::abs));
        sum += total((forward + backward) * 0.5);
    }
    let (largest_albedo, theta) = largest_albedo(brdf, theta_max);
    PhysicalChecks {
        reciprocity_error: if sum > 0.0 { difference / sum } else { 0.0 },
        largest_albedo,
        largest_albedo_theta_deg: theta.to_degrees(),
        coverage: Coverage {
            share: f64::from(covered) / f64::from(sampling.count),
            max_theta_deg: theta_max.to_degrees(),
        },
    }
}

/// Returns the largest directional albedo of any channel over sixteen angles of incidence up to `theta_max`
/// radians, and the angle at which it occurs.
pub fn largest_albedo(brdf: &dyn Brdf, theta_max: f64) -> (f64, f64) {
    (0..16)
        .map(|step| theta_max * f64::from(step) / 15.0)
        .map(|theta| (directional_albedo(brdf, theta).max_channel(), theta))
        .fold((0.0, 0.0), |best, next| if next.0 > best.0 { next } else { best })
}

/// Returns the directional albedo ∫ f cosθo dωo for light that arrives at `theta` radians and azimuth 0.
///
/// Pairs without data count as black. The integral is a mean over 8192 points of a scrambled sequence,
/// half of them about the mirror direction.
pub fn directional_albedo(brdf: &dyn Brdf, theta: f64) -> Rgb {
    const POINTS: u32 = 4096;
    let wi = spherical_direction(theta, 0.0);
    let mirror = spherical_direction(theta, PI);
    let sobol = ScrambledSobol::new(1);
    let mut pairs = Vec::with_capacity(2 * POINTS as usize);
    for index in 0..POINTS {
        let [a, b, c, d] = sobol.point(index);
        let drawn = [cosine_hemisphere(a, b).0, lobe_direction(mirror, c, d)];
        pairs.extend(drawn.map(|wo| DirectionPair::new(wi, wo)));
    }
    pairs.retain(|pair| pair.wo.z > 0.0 && brdf.has_data(pair));
    let (batch, mut values) = (pairs.iter().collect::<DirectionBatch>(), RgbBatch::default());
    brdf.eval_batch(batch.as_slices(), &mut values);
    let mut sum = Rgb::BLACK;
    for (index, pair) in pairs.iter().enumerate() {
        let pdf = 0.5 * pair.wo.z / PI + 0.5 * lobe_pdf(mirror, pair.wo);
        sum = sum + values.get(index) * (pair.wo.z / pdf);
    }
    sum / f64::from(2 * POINTS)
}

/// Exponent of the lobe that looks for highlights: half of it lies within 17° of its axis.
const LOBE_EXPONENT: f64 = 15.0;

fn lobe_pdf(axis: glam::DVec3, direction: glam::DVec3) -> f64 {
    (LOBE_EXPONENT + 1.0) / (2.0 * PI) * axis.dot(direction).max(0.0).powf(LOBE_EXPONENT)
}

fn lobe_direction(axis: glam::DVec3, u: f64, v: f64) -> glam::DVec3 {
    let cosine = u.powf(1.0 / (LOBE_EXPONENT + 1.0));
    let local = spherical_direction(cosine.acos(), 2.0 * PI * v);
    let (x, y) = axis.any_orthonormal_pair();
    local.x * x + local.y * y + local.z * axis
}

/// A summary of a set of samples: how many there are, and the angles and values that they span.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SampleSummary {
    /// Number of samples.
    pub count: usize,
    /// Number of distinct directions to the light, to 1e-4 in each component.
    pub incidences: usize,
    /// Largest angle of a direction to the light from the normal, degrees.
    pub max_theta_i_deg: f64,
    /// Largest angle of a direction to the viewer from the normal, degrees.
    pub max_theta_o_deg: f64,
    /// Smallest value of any channel, sr⁻¹.
    pub min_value: f64,
    /// Largest value of any channel, sr⁻¹.
    pub max_value: f64,
    /// Share of samples that are exactly 0 in some channel, [0, 1].
    pub zero_share: f64,
}

/// Returns a summary of a set of samples.
pub fn summarize(samples: &SampleSet) -> SampleSummary {
    #[expect(clippy::cast_possible_truncation, reason = "components times ten thousand")]
    let rounded = |v: f64| (v * 1e4).round() as i64;
    let mut incidences: Vec<[i64; 3]> =
        samples.pairs().map(|pair| pair.wi.to_array().map(rounded)).collect();
    incidences.sort_unstable();
    incidences.dedup();
    let values = || samples.values().iter().flatten().copied();
    let largest = |pick: fn(&DirectionPair) -> glam::DVec3| {
        samples.pairs().map(|pair| polar_angle(pick(&pair)).to_degrees()).fold(0.0, f64::max)
    };
    let zeros = (0..samples.len())
        .filter(|&i| samples.values().iter().any(|channel| channel[i] == 0.0))
        .count();
    let zero_share = zeros as f64 / samples.len().max(1) as f64;
    SampleSummary {
        count: samples.len(),
        incidences: incidences.len(),
        max_theta_i_deg: largest(|pair| pair.wi),
        max_theta_o_deg: largest(|pair| pair.wo),
        min_value: values().fold(f64::INFINITY, f64::min),
        max_value: values().fold(0.0, f64::max),
        zero_share,
    }
}

/// Pairs on which [`anisotropy`] is measured.
const TURNED_PAIRS: u32 = 1_000;

/// The [`anisotropy`] from which a material is called anisotropic: interpolation in tables explains less.
pub const ANISOTROPIC: f64 = 0.01;

/// Returns a measure of anisotropy, 0 for isotropic materials.
///
/// It is the mean of |f − f′| divided by the mean of f, in luminance, where f′ is the value at the pair
/// turned about the normal by a quarter turn. The pairs lie within 70° of the normal.
pub fn anisotropy(brdf: &dyn Brdf) -> f64 {
    let sampling = PairSampling { count: TURNED_PAIRS, seed: 1, theta_max: 70_f64.to_radians() };
    let (mut off, mut all) = (0.0, 0.0);
    for pair in sampling.pairs() {
        let turned = pair.rotated_about_normal(std::f64::consts::FRAC_PI_2);
        if brdf.has_data(&pair) && brdf.has_data(&turned) {
            let value = brdf.eval(&pair).luminance();
            off += (value - brdf.eval(&turned).luminance()).abs();
            all += value;
        }
    }
    if all > 0.0 { off / all } else { 0.0 }
}
