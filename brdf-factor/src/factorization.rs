//! Fitting the textures of given coordinates to samples.

use brdf_model::{Dropped, SampleSet};
use brdf_param::{Bound, DiscRadii, polar_angle};
use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::{
    ChannelMap, Factor, FactorDescription, FactorError, FactorSpec, FactoredBrdf, LinearSystem,
    LogMap, Smoothing, Solver,
};

/// What a sample's squared log residual is multiplied by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Weight {
    /// 1: relative error counts.
    #[default]
    Log,
    /// f, the mean over channels.
    F,
    /// f²: close to the linear error.
    F2,
}

/// Which textures are solved for when a model has several terms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TermSolve {
    /// All of them together.
    #[default]
    All,
    /// The last n; earlier ones stay as the model with fewer terms left them. The thesis takes 2.
    Last(usize),
}

/// Options of a factorization.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FactorParams {
    /// Texels along each side of a texture, within [`crate::Grid::SIZES`].
    pub texture_size: usize,
    /// What image of the coordinates is fitted into the texture.
    pub bound: Bound,
    /// μ ≥ 0, see [`Smoothing`]. 1e-4 costs nothing measurable; 1e-3 costs 5–14 % of log error.
    pub smoothing: f64,
    /// Which logarithm is fitted.
    pub log_map: LogMap,
    /// How samples are weighted.
    pub weight: Weight,
    /// How several terms are solved for.
    pub terms: TermSolve,
    /// Grazing limit in radians, (0, π/2]: samples beyond it must not be handed in, and evaluation
    /// pulls directions back to it.
    pub theta_max: f64,
    /// How the system is solved; `None` lets [`Solver::for_unknowns`] choose.
    pub solver: Option<Solver>,
}

impl Default for FactorParams {
    fn default() -> Self {
        Self {
            texture_size: 32,
            bound: Bound::Disc,
            smoothing: 1e-4,
            log_map: LogMap::Offset,
            weight: Weight::Log,
            terms: TermSolve::All,
            theta_max: 80_f64.to_radians(),
            solver: None,
        }
    }
}

impl FactorParams {
    fn check(&self) -> Result<(), FactorError> {
        // Written so that NaN is refused.
        if !(self.smoothing >= 0.0 && self.smoothing.is_finite()) {
            return Err(FactorError::Option {
                option: "smoothing",
                value: self.smoothing,
                expected: "0 or more",
            });
        }
        if self.terms == TermSolve::Last(0) {
            return Err(FactorError::Option {
                option: "the number of terms solved together",
                value: 0.0,
                expected: "1 or more",
            });
        }
        Ok(())
    }
}

/// A fitted model and how it came about.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// The model.
    pub model: FactoredBrdf,
    /// Samples that were fitted.
    pub samples_used: usize,
    /// What was dropped: before the fit, and by the log map.
    pub dropped: Dropped,
    /// Samples with a negative channel, a colour outside the gamut, that was set to 0.
    pub clamped: usize,
    /// Texels solved for.
    pub unknowns: usize,
    /// Texels that no sample touches; smoothing alone holds them.
    pub smoothed_texels: usize,
    /// The solver that ran.
    pub solver: Solver,
    /// Its iterations, and whether it reached its tolerance.
    pub iterations: usize,
    /// Whether the solver reached its tolerance.
    pub converged: bool,
    /// What the solved factors give for every sample before texels are narrowed to f32, one array
    /// per channel; 0 for samples of weight 0. This is what solvers are compared by.
    pub predictions: Vec<Vec<f64>>,
}

/// Fits all factors together.
///
/// # Errors
///
/// [`FactorError::NoSamples`], [`FactorError::TextureSize`], [`FactorError::Option`],
/// [`FactorError::Factors`], [`FactorError::FreeTexel`], [`FactorError::Singular`].
pub fn factorize(
    samples: &SampleSet,
    specs: &[FactorSpec],
    params: &FactorParams,
) -> Result<Fit, FactorError> {
    let problem = Problem::new(samples, params)?;
    let factors = problem.empty_factors(specs)?;
    problem.solve(&[], factors)
}

/// Fits the model of the first factor, of the first two, and so on, as [`FactorParams::terms`]
/// says; entry k has k + 1 factors.
///
/// # Errors
///
/// As [`factorize`].
pub fn factorize_terms(
    samples: &SampleSet,
    specs: &[FactorSpec],
    params: &FactorParams,
) -> Result<Vec<Fit>, FactorError> {
    let problem = Problem::new(samples, params)?;
    let mut fits: Vec<Fit> = Vec::with_capacity(specs.len());
    for terms in 1..=specs.len() {
        let kept = match params.terms {
            TermSolve::All => 0,
            TermSolve::Last(n) => terms.saturating_sub(n),
        };
        let earlier = fits.last().map_or(&[][..], |fit| &fit.model.factors()[..kept]).to_vec();
        let factors = problem.empty_factors(&specs[kept..terms])?;
        fits.push(problem.solve(&earlier, factors)?);
    }
    Ok(fits)
}

/// Samples prepared for fitting.
struct Problem<'a> {
    params: &'a FactorParams,
    samples: SampleSet,
    maps: Vec<ChannelMap>,
    weights: Vec<f64>,
    theta_max: f64,
}

/// How far beyond the largest training radius a texture reaches, so that the outermost sample does
/// not stand on the very rim.
const RADIUS_MARGIN: f64 = 1.0001;

impl<'a> Problem<'a> {
    fn new(samples: &SampleSet, params: &'a FactorParams) -> Result<Self, FactorError> {
        params.check()?;
        let samples = match params.log_map {
            LogMap::Log => samples.positive(),
            LogMap::Offset | LogMap::Highlight => samples.clone(),
        };
        if samples.is_empty() {
            return Err(FactorError::NoSamples { dropped: samples.dropped().to_string() });
        }
        let maps = ChannelMap::for_samples(params.log_map, &samples);
        let weights = weights(&samples, params.weight);
        // The lowest direction is the one farthest from the normal.
        let lowest = |a: DVec3, b: DVec3| if b.z < a.z { b } else { a };
        let widest = polar_angle(
            samples.pairs().fold(DVec3::Z, |low, pair| lowest(low, lowest(pair.wi, pair.wo))),
        );
        // A single direction along the normal would leave no room at all.
        let theta_max = params.theta_max.min(widest).max(1e-3);
        Ok(Self { params, samples, maps, weights, theta_max })
    }

    /// Factors without texel values, scaled to the samples.
    fn empty_factors(&self, specs: &[FactorSpec]) -> Result<Vec<Factor>, FactorError> {
        let radii_of = |spec: &FactorSpec| {
            let mut largest = DiscRadii { first: 1e-6, second: 1e-6 };
            for coordinate in &spec.coordinates {
                largest = largest.max(coordinate.largest_radii(self.samples.pairs()));
            }
            DiscRadii {
                first: RADIUS_MARGIN * largest.first,
                second: RADIUS_MARGIN * largest.second,
            }
        };
        specs
            .iter()
            .map(|spec| {
                let (size, bound) = (self.params.texture_size, self.params.bound);
                let coordinates = &spec.coordinates;
                let description = FactorDescription::new(coordinates, size, bound, radii_of(spec))?;
                Factor::new(description, None)
            })
            .collect()
    }

    /// Solves for the texels of `factors` beside those of `earlier`, which stay.
    fn solve(&self, earlier: &[Factor], mut factors: Vec<Factor>) -> Result<Fit, FactorError> {
        let smoothing = Smoothing { mu: self.params.smoothing };
        let active: Vec<&Factor> = factors.iter().collect();
        let system = LinearSystem::new(&self.samples, &active, &self.weights, smoothing);
        let smoothed_texels = system.untouched_texels().len();
        if smoothing.mu <= 0.0 {
            refuse_free_texels(&system, &factors)?;
        }
        let fixed = (!earlier.is_empty())
            .then(|| FactoredBrdf::new(earlier.to_vec(), self.maps.clone(), self.theta_max))
            .transpose()?;
        let sides: Vec<Vec<f64>> = (0..self.maps.len())
            .map(|channel| system.right_hand_side(&self.targets(channel, fixed.as_ref())))
            .collect();
        let unknowns = system.unknowns();
        let solver = self.params.solver.unwrap_or_else(|| Solver::for_unknowns(unknowns));
        let solution = solver.solve(system.matrix(), &sides)?;

        let predictions = solution.values.iter().map(|x| system.predict(x)).collect();
        for (index, factor) in factors.iter_mut().enumerate() {
            let mut texels = vec![[0.0_f64; 4]; factor.grid().texels()];
            for (channel, values) in solution.values.iter().enumerate() {
                for (texel, value) in texels.iter_mut().zip(system.texels_of(index, values)) {
                    texel[channel] = value.unwrap_or(0.0);
                }
            }
            store(factor, &texels)?;
        }
        let mut all = earlier.to_vec();
        all.extend(factors);
        settle_constants(&mut all)?;
        Ok(Fit {
            model: FactoredBrdf::new(all, self.maps.clone(), self.theta_max)?,
            samples_used: self.samples.len(),
            dropped: self.samples.dropped(),
            clamped: self.samples.clamped(),
            unknowns,
            smoothed_texels,
            solver,
            iterations: solution.iterations,
            converged: solution.converged,
            predictions,
        })
    }

    /// Fitted values of a channel, less what the fixed factors already give.
    fn targets(&self, channel: usize, fixed: Option<&FactoredBrdf>) -> Vec<f64> {
        let map = &self.maps[channel];
        let values = &self.samples.values()[channel];
        self.samples
            .pairs()
            .zip(values)
            .map(|(pair, &f)| {
                map.forward(f) - fixed.map_or(0.0, |model| model.log_values(&pair)[channel])
            })
            .collect()
    }
}

/// One weight per sample, the same for all channels, so that one matrix serves them all.
fn weights(samples: &SampleSet, weight: Weight) -> Vec<f64> {
    #[expect(clippy::cast_precision_loss, reason = "one or three channels")]
    let channels = samples.values().len() as f64;
    let mean = |index: usize| samples.values().iter().map(|c| c[index]).sum::<f64>() / channels;
    let weights: Vec<f64> = (0..samples.len())
        .map(|index| match weight {
            Weight::Log => 1.0,
            Weight::F => mean(index),
            Weight::F2 => mean(index).powi(2),
        })
        .collect();
    // A material that is black everywhere has nothing to weight by.
    if weights.iter().any(|&w| w > 0.0) { weights } else { vec![1.0; samples.len()] }
}

fn refuse_free_texels(system: &LinearSystem, factors: &[Factor]) -> Result<(), FactorError> {
    let mut free = system.untouched_texels();
    let others = free.len().saturating_sub(1);
    match free.next() {
        None => Ok(()),
        Some((factor, texel)) => {
            let size = factors[factor].grid().size;
            Err(FactorError::FreeTexel { factor, u: texel % size, v: texel / size, others })
        }
    }
}

/// Narrows log texels to f32 and fills those outside the mask.
fn store(factor: &mut Factor, texels: &[[f64; 4]]) -> Result<(), FactorError> {
    #[expect(clippy::cast_possible_truncation, reason = "textures are stored as f32")]
    let mut narrow: Vec<[f32; 4]> = texels.iter().map(|texel| texel.map(|v| v as f32)).collect();
    factor.grid().fill_unmasked(&factor.mask(), &mut narrow);
    factor.set_texels(narrow)
}

/// Moves constants so that every factor but the first has zero mean log over its mask: what the
/// product leaves open is settled the same way every time.
fn settle_constants(factors: &mut [Factor]) -> Result<(), FactorError> {
    #[expect(clippy::cast_precision_loss, reason = "few coordinates, at most a million texels")]
    let real = |count: usize| count as f64;
    let mut moved = [0.0; 4];
    for index in (0..factors.len()).rev() {
        let factor = &mut factors[index];
        let uses = real(factor.coordinates().len());
        let mut texels: Vec<[f64; 4]> =
            factor.texels().iter().map(|texel| texel.map(f64::from)).collect();
        let shift: [f64; 4] = if index == 0 {
            moved.map(|total| total / uses)
        } else {
            let mask = factor.mask();
            let masked = real(mask.iter().filter(|m| **m).count().max(1));
            std::array::from_fn(|channel| {
                let inside = texels.iter().zip(&mask).filter(|(_, m)| **m);
                let mean = inside.map(|(texel, _)| texel[channel]).sum::<f64>() / masked;
                moved[channel] += uses * mean;
                -mean
            })
        };
        for texel in &mut texels {
            for (value, shift) in texel.iter_mut().zip(shift) {
                *value += shift;
            }
        }
        store(factor, &texels)?;
    }
    Ok(())
}
