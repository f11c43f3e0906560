//! Fitting the textures of given coordinates to samples.

use std::sync::Arc;

use brdf_model::{Dropped, SampleSet};
use rayon::prelude::*;

use crate::{
    Columns, Factor, FactorError, FactorParams, FactorSpec, FactoredBrdf, LinearSystem, Problem,
    Solution, Solver, TermSolve, Zeros,
};

/// Times that censored zeros follow the prediction.
const CENSORED_ROUNDS: usize = 8;

/// A fitted model, with the counts and iterations of its fit.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// The fitted model.
    pub model: FactoredBrdf,
    /// Number of samples that were fitted.
    pub samples_used: usize,
    /// Numbers of samples that were left out, before the fit and by the log map.
    pub dropped: Dropped,
    /// Number of samples with a negative channel, a colour outside the gamut, that was set to 0.
    pub clamped: usize,
    /// Number of values, of all channels, that are 0.
    pub zeros: usize,
    /// Number of texels that were solved for.
    pub unknowns: usize,
    /// Number of texels that no sample touches; smoothing alone determines them.
    pub smoothed_texels: usize,
    /// The solver that ran.
    pub solver: Solver,
    /// Number of iterations of the solver; 0 for a direct one.
    pub iterations: usize,
    /// Whether the solver reached its tolerance; true for a direct one.
    pub converged: bool,
    /// Log values that the solved factors give for every sample, before texels are narrowed to f32, one
    /// array for each channel; 0 for samples of weight 0. Solvers are compared by them.
    pub predictions: Vec<Vec<f64>>,
}

/// Returns the product of textures that fits a set of samples best, all factors together.
///
/// ```
/// use brdf_factor::{FactorParams, FactorSpec, factorize};
/// use brdf_model::{Channels, PairSampling, Preset, SampleSet};
///
/// let plastic = Preset::find("plastic").expect("a preset").brdf();
/// let params = FactorParams { texture_size: 8, ..FactorParams::default() };
/// let sampling = PairSampling { count: 2_000, seed: 1, theta_max: params.theta_max };
/// let samples = SampleSet::draw(&plastic, &sampling, Channels::Luminance);
/// let fit = factorize(&samples, &FactorSpec::radial(true), &params)?;
/// assert_eq!(fit.model.factors().len(), 2);
/// assert!(fit.converged && fit.samples_used == 2_000);
/// # Ok::<(), brdf_factor::FactorError>(())
/// ```
///
/// # Errors
///
/// [`FactorError::NoSamples`], [`FactorError::TextureSize`], [`FactorError::Option`],
/// [`FactorError::Factors`], [`FactorError::FreeTexel`], [`FactorError::Singular`].
#[doc(alias = "homomorphic factorization")]
pub fn factorize(
    samples: &SampleSet,
    specs: &[FactorSpec],
    params: &FactorParams,
) -> Result<Fit, FactorError> {
    factorize_problem(&Problem::new(samples, params)?, specs)
}

/// Returns what [`factorize`] returns, of samples that were made ready before.
///
/// # Errors
///
/// As [`factorize`].
pub fn factorize_problem(problem: &Problem, specs: &[FactorSpec]) -> Result<Fit, FactorError> {
    solve(problem, &[], empty_factors(problem, specs)?)
}

/// Returns the fits of the first factor alone, of the first two factors, and so on; entry k has k + 1
/// factors.
///
/// [`FactorParams::terms`] says which factors are solved for again when one is added.
///
/// # Errors
///
/// As [`factorize`].
#[doc(alias = "homomorphic factorization")]
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
        let factors = empty_factors(&problem, &specs[kept..terms])?;
        fits.push(solve(&problem, &earlier, factors)?);
    }
    Ok(fits)
}

/// The factors of these coordinates, without texel values.
fn empty_factors(problem: &Problem, specs: &[FactorSpec]) -> Result<Vec<Factor>, FactorError> {
    let size = problem.params().texture_size;
    specs.iter().map(|spec| problem.empty_factor(spec, size)).collect()
}

/// Solves for the texels of `factors` beside those of `earlier`, which stay.
fn solve(
    problem: &Problem,
    earlier: &[Factor],
    mut factors: Vec<Factor>,
) -> Result<Fit, FactorError> {
    let params = problem.params();
    let columns: Vec<Arc<Columns>> =
        factors.par_iter().map(|factor| Arc::new(problem.columns(factor))).collect();
    let untouched: Vec<Vec<usize>> =
        columns.iter().map(|columns| columns.untouched_texels(problem.weights())).collect();
    if params.smoothing <= 0.0 {
        refuse_free_texels(&untouched, &factors)?;
    }
    let system = LinearSystem::new(columns, problem.weights());
    let rest = (!earlier.is_empty()).then(|| rest_of(problem, earlier));
    let targets = rest.as_ref().unwrap_or(problem).targets();
    let unknowns = system.unknowns();
    let solver = params.solver.unwrap_or_else(|| Solver::for_unknowns(unknowns));
    let prepared = solver.prepare(&system)?;
    let sides: Vec<Vec<f64>> = targets.iter().map(|y| system.right_hand_side(y)).collect();
    let mut solution = prepared.solve(&sides);
    if params.zeros == Zeros::Below && problem.zeros() > 0 {
        for _ in 0..CENSORED_ROUNDS {
            let lowered = targets.iter().zip(problem.values()).zip(&solution.values);
            let sides: Vec<Vec<f64>> = lowered
                .map(|((y, f), x)| system.right_hand_side(&below_zeros(y, f, &system.predict(x))))
                .collect();
            let next = prepared.solve(&sides);
            solution = Solution { iterations: solution.iterations + next.iterations, ..next };
        }
    }

    for (index, factor) in factors.iter_mut().enumerate() {
        let mut texels = vec![[0.0_f64; 4]; factor.grid().texels()];
        for (channel, x) in solution.values.iter().enumerate() {
            let own = system.columns()[index].texels(system.part(index, x));
            for (texel, value) in texels.iter_mut().zip(own) {
                texel[channel] = value.unwrap_or(0.0);
            }
        }
        store(factor, &texels)?;
    }
    let mut all = earlier.to_vec();
    all.extend(factors);
    settle_constants(&mut all, [0.0; 4])?;
    let model = FactoredBrdf::new(all, problem.maps().to_vec(), problem.theta_max())?;
    Ok(Fit {
        model: if params.clamp { model.with_ceilings(problem.largest_values())? } else { model },
        samples_used: problem.len(),
        dropped: problem.dropped(),
        clamped: problem.clamped(),
        zeros: problem.zeros(),
        unknowns,
        smoothed_texels: untouched.iter().map(Vec::len).sum(),
        solver,
        iterations: solution.iterations,
        converged: solution.converged,
        predictions: solution
            .values
            .iter()
            .map(|x| problem.in_given_order(&system.predict(x)))
            .collect(),
    })
}

/// What is to be fitted where zeros are censored: the prediction, if it is below what a zero is.
fn below_zeros(targets: &[f64], values: &[f64], predicted: &[f64]) -> Vec<f64> {
    let nodes = targets.iter().zip(values).zip(predicted);
    nodes.map(|((&y, &f), &found)| if f <= 0.0 { y.min(found) } else { y }).collect()
}

/// What is left to explain beside earlier factors.
fn rest_of(problem: &Problem, earlier: &[Factor]) -> Problem {
    let mut given = vec![vec![0.0; problem.len()]; problem.maps().len()];
    for factor in earlier {
        let columns = problem.columns(factor);
        for (channel, given) in given.iter_mut().enumerate() {
            columns.add_values(&columns.texels_of(factor, channel), given);
        }
    }
    problem.subtract(&given)
}

fn refuse_free_texels(untouched: &[Vec<usize>], factors: &[Factor]) -> Result<(), FactorError> {
    let count: usize = untouched.iter().map(Vec::len).sum();
    let first = untouched.iter().enumerate().find_map(|(f, free)| Some((f, *free.first()?)));
    match first {
        None => Ok(()),
        Some((factor, texel)) => {
            let columns = factors[factor].grid().columns;
            let others = count - 1;
            Err(FactorError::FreeTexel { factor, u: texel % columns, v: texel / columns, others })
        }
    }
}

/// Narrows log texels to f32, makes those equal that stand for one place, and fills those outside the mask.
pub(crate) fn store(factor: &mut Factor, texels: &[[f64; 4]]) -> Result<(), FactorError> {
    let mut texels = texels.to_vec();
    for group in factor.description().joined_texels() {
        let count = group.len() as f64;
        let mean = std::array::from_fn(|channel| {
            group.iter().map(|&texel| texels[texel][channel]).sum::<f64>() / count
        });
        group.iter().for_each(|&texel| texels[texel] = mean);
    }
    #[expect(clippy::cast_possible_truncation, reason = "textures are stored as f32")]
    let mut narrow: Vec<[f32; 4]> = texels.iter().map(|texel| texel.map(|v| v as f32)).collect();
    factor.grid().fill_unmasked(&factor.mask(), &mut narrow);
    factor.set_texels(narrow)
}

/// Moves constants so that every factor but the first has zero mean log over its mask: what the
/// product leaves open is settled the same way every time. The first also takes `moved`.
pub(crate) fn settle_constants(
    factors: &mut [Factor],
    mut moved: [f64; 4],
) -> Result<(), FactorError> {
    let real = |count: usize| count as f64;
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
