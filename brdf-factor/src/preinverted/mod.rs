//! Factorization with the matrix inverted beforehand, for samples at fixed places whose values change.
//!
//! The constraint matrix depends on the places and coordinates of the samples alone. Once it is inverted,
//! each new set of values costs a product with its transpose and two triangular solves, or a product with
//! a basis.
//!
//! Source: Jaroszkiewicz and McCool 2003, section 3.2.

mod basis;
mod key;

use std::fmt;
use std::sync::Arc;

use faer::MatMut;
use faer::dyn_stack::MemBuffer;
use glam::DVec2;
use serde::{Deserialize, Serialize};

pub use basis::{Damping, SpectralBasis};

use crate::factorization::{settle_constants, store};
use crate::{
    ChannelTransform, CholeskyFactor, Columns, Factor, FactorError, FactorSpec, FactoredBrdf, Fit,
    LinearSystem, LogTransform, NormalEquations, Problem, Solver, SurfaceProduct, SurfaceTexture,
    Weight,
};

/// The factors that a [`Preinverted`] solves for, and the sizes of their textures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Plan {
    /// Factors over directions and the number of texels along a side of each.
    pub factors: Vec<(FactorSpec, usize)>,
    /// A factor over the surface: the number of texels along a side, and whether u wraps around.
    pub surface: Option<(usize, bool)>,
}

impl Plan {
    /// Returns the plan of these factors, all of one texture size, with none over the surface.
    pub fn of(specs: &[FactorSpec], size: usize) -> Self {
        Self { factors: specs.iter().map(|spec| (spec.clone(), size)).collect(), surface: None }
    }

    /// Returns the plan with a factor over the surface added.
    #[must_use]
    pub fn with_surface(self, size: usize, wraps: bool) -> Self {
        Self { surface: Some((size, wraps)), ..self }
    }
}

/// A way to invert the matrix.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Inversion {
    /// By a Cholesky factor of the normal equations, which gives the least-squares solution.
    Cholesky,
    /// By the leading singular vectors of the constraint matrix, which gives regularized solutions, and
    /// coefficients that describe a material.
    Svd {
        /// Largest number of vectors; those below 1e-7 of the largest singular value are left out.
        components: usize,
        /// The damping of small singular values.
        damping: Damping,
    },
}

/// An inverted matrix.
#[derive(Clone, Debug)]
pub enum Inverse {
    /// That of [`Inversion::Cholesky`].
    Cholesky(CholeskyFactor),
    /// That of [`Inversion::Svd`].
    Svd(SpectralBasis),
}

impl Inverse {
    fn unknowns(&self) -> usize {
        match self {
            Self::Cholesky(factor) => factor.values().len().isqrt(),
            Self::Svd(basis) => basis.unknowns(),
        }
    }
}

/// A solver for the factors of samples at fixed places, with its matrix inverted beforehand.
///
/// ```
/// use brdf_factor::{FactorParams, FactorSpec, Inversion, Plan, Preinverted, Problem};
/// use brdf_model::{Channels, PairSampling, Preset, SampleSet};
///
/// let params = FactorParams { texture_size: 6, ..FactorParams::default() };
/// let sampling = PairSampling { count: 1_000, seed: 1, theta_max: params.theta_max };
/// let samples_of = |name| {
///     let material = Preset::find(name).expect("a preset").brdf();
///     SampleSet::draw(&material, &sampling, Channels::Luminance)
/// };
/// let first = Problem::new(&samples_of("plastic"), &params)?;
/// let plan = Plan::of(&FactorSpec::mccool(true), params.texture_size);
/// let solver = Preinverted::new(&first, &[], plan, Inversion::Cholesky)?;
/// // Another material at the same directions needs no new matrix.
/// let second = Problem::new(&samples_of("cook-torrance"), &params)?;
/// assert_eq!(solver.fit(&second)?.samples_used, 1_000);
/// # Ok::<(), brdf_factor::FactorError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Preinverted {
    plan: Plan,
    key: String,
    factors: Vec<Factor>,
    columns: Vec<Arc<Columns>>,
    /// For each sample, as columns count them, its place among those given.
    order: Vec<usize>,
    ones: Vec<f64>,
    theta_max: f64,
    inverse: Inverse,
}

/// The memory of one solution, which can be used again for the next.
pub struct PreinvertedWorkspace {
    channels: usize,
    /// `[sample][channel]`.
    targets: Vec<f64>,
    /// Aᵀ of the targets, `[unknown][channel]`.
    products: Vec<f64>,
    /// `[channel][unknown]`.
    solution: Vec<f64>,
    /// `[channel][component]`.
    coefficients: Vec<f64>,
    scratch: MemBuffer,
}

impl Preinverted {
    /// Returns the solver for a problem's samples; the values of the samples do not matter.
    ///
    /// `places` are the texture coordinates of the samples, in the order in which they were given. They
    /// are needed where the plan has a factor over the surface.
    ///
    /// # Errors
    ///
    /// [`FactorError::Option`] where weights or the log map depend on values;
    /// [`FactorError::TextureSize`] and [`FactorError::Factors`] for a plan that makes no model;
    /// [`FactorError::Singular`] where the matrix cannot be inverted; [`FactorError::TooManyUnknowns`].
    pub fn new(
        problem: &Problem,
        places: &[DVec2],
        plan: Plan,
        inversion: Inversion,
    ) -> Result<Self, FactorError> {
        let (factors, columns) = layout(problem, places, &plan)?;
        let unknowns: usize = columns.iter().map(|columns| columns.unknowns()).sum();
        if unknowns > Solver::MAX_DENSE {
            return Err(FactorError::TooManyUnknowns { unknowns, max: Solver::MAX_DENSE });
        }
        let ones = vec![1.0; problem.len()];
        let equations = NormalEquations::new(columns.clone(), &ones);
        let inverse = match inversion {
            Inversion::Cholesky => Inverse::Cholesky(equations.factorize(Vec::new())?),
            Inversion::Svd { components, damping } => {
                Inverse::Svd(SpectralBasis::new(&equations, components, damping)?)
            }
        };
        let key = key::of(problem, places, &plan);
        Ok(Self::assemble(problem, plan, key, factors, columns, inverse))
    }

    /// Returns the solver of an inverse that was made before, for samples at the same places.
    ///
    /// `key` is the [`Preinverted::key`] of that time; it must be that of this problem.
    ///
    /// # Errors
    ///
    /// [`FactorError::OtherSampling`] unless positions, plan, bound, grazing limit and smoothing are the same;
    /// otherwise as [`Preinverted::new`].
    pub fn restore(
        problem: &Problem,
        places: &[DVec2],
        plan: Plan,
        inverse: Inverse,
        key: &str,
    ) -> Result<Self, FactorError> {
        let (factors, columns) = layout(problem, places, &plan)?;
        let own = key::of(problem, places, &plan);
        let unknowns: usize = columns.iter().map(|columns| columns.unknowns()).sum();
        if own != key || inverse.unknowns() != unknowns {
            return Err(FactorError::OtherSampling { samples: problem.len() });
        }
        Ok(Self::assemble(problem, plan, own, factors, columns, inverse))
    }

    fn assemble(
        problem: &Problem,
        plan: Plan,
        key: String,
        factors: Vec<Factor>,
        columns: Vec<Arc<Columns>>,
        inverse: Inverse,
    ) -> Self {
        Self {
            plan,
            key,
            factors,
            columns,
            order: problem.origin().to_vec(),
            ones: vec![1.0; problem.len()],
            theta_max: problem.theta_max(),
            inverse,
        }
    }

    /// Returns the factors that are solved for.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Returns a hash of all that the inverse depends on: positions in their order, texture coordinates, factors
    /// and their sizes, bound, grazing limit and smoothing.
    pub fn key(&self) -> &str {
        &self.key
    }

    /// Returns the inverse, to be stored for [`Preinverted::restore`].
    pub fn inverse(&self) -> &Inverse {
        &self.inverse
    }

    /// Returns the columns of the matrix, factor by factor, those of the surface last.
    pub fn columns(&self) -> &[Arc<Columns>] {
        &self.columns
    }

    /// Returns the columns of other samples, or of a part of the samples, in the same factors.
    ///
    /// `places` are as in [`Preinverted::new`], for all samples that the problem was made of.
    ///
    /// # Panics
    ///
    /// If a place is missing that the plan has a factor for.
    pub fn columns_of(&self, problem: &Problem, places: &[DVec2]) -> Vec<Arc<Columns>> {
        columns_in(problem, places, &self.factors, self.plan.surface)
    }

    /// Returns, for each sample as columns count them, its index in the order in which they were given.
    pub fn order(&self) -> &[usize] {
        &self.order
    }

    /// Returns the number of samples.
    pub fn samples(&self) -> usize {
        self.order.len()
    }

    /// Returns the number of texels that are solved for.
    pub fn unknowns(&self) -> usize {
        self.columns.iter().map(|columns| columns.unknowns()).sum()
    }

    /// Returns the indices of texels that no sample touches, which smoothing alone determines: one list for
    /// each factor, that of the surface last.
    pub fn untouched_texels(&self) -> Vec<Vec<usize>> {
        self.columns.iter().map(|columns| columns.untouched_texels(&self.ones)).collect()
    }

    /// Returns memory for solutions of this many channels.
    pub fn workspace(&self, channels: usize) -> PreinvertedWorkspace {
        let unknowns = self.unknowns();
        let (components, scratch) = match &self.inverse {
            Inverse::Cholesky(factor) => (0, factor.scratch(channels)),
            Inverse::Svd(basis) => (basis.components(), MemBuffer::new(Default::default())),
        };
        PreinvertedWorkspace {
            channels,
            targets: vec![0.0; channels * self.samples()],
            products: vec![0.0; channels * unknowns],
            solution: vec![0.0; channels * unknowns],
            coefficients: vec![0.0; channels * components],
            scratch,
        }
    }

    /// Solves for the factors of new values and leaves the solution in the workspace.
    ///
    /// `values` are in sr⁻¹, by channel, in the order in which the samples were given; each channel is fitted
    /// through its map. With a Cholesky factor nothing is allocated.
    ///
    /// # Panics
    ///
    /// If the workspace is not one of [`Preinverted::workspace`], or unless there are as many channels
    /// of values and maps as it has, and one value for each sample.
    pub fn solve(
        &self,
        values: &[Vec<f64>],
        maps: &[ChannelTransform],
        workspace: &mut PreinvertedWorkspace,
    ) {
        let channels = workspace.channels;
        assert_eq!((values.len(), maps.len()), (channels, channels), "a map for each channel");
        for (channel, (values, map)) in values.iter().zip(maps).enumerate() {
            assert_eq!(values.len(), self.samples(), "a value for each sample");
            let targets = workspace.targets[channel..].iter_mut().step_by(channels);
            for (target, place) in targets.zip(&self.order) {
                *target = map.forward(values[*place]);
            }
        }
        workspace.products.fill(0.0);
        let mut rest = workspace.products.as_mut_slice();
        for columns in &self.columns {
            let (own, others) = rest.split_at_mut(channels * columns.unknowns());
            columns.add_transposed_rows(&self.ones, &workspace.targets, channels, own);
            rest = others;
        }
        let unknowns = self.unknowns();
        for (row, products) in workspace.products.chunks_exact(channels).enumerate() {
            for (channel, value) in products.iter().enumerate() {
                workspace.solution[channel * unknowns + row] = *value;
            }
        }
        match &self.inverse {
            Inverse::Cholesky(factor) => {
                let sides = MatMut::from_column_major_slice_mut(
                    &mut workspace.solution,
                    unknowns,
                    channels,
                );
                factor.solve_with(sides, &mut workspace.scratch);
            }
            Inverse::Svd(basis) => {
                basis.coefficients(&workspace.solution, &mut workspace.coefficients);
                basis.expand(&workspace.coefficients, &mut workspace.solution);
            }
        }
    }

    /// Returns the fit of a problem whose samples lie at the places that the solver was made for, like
    /// [`factorize`](crate::factorize).
    ///
    /// # Errors
    ///
    /// [`FactorError::Factors`] where there is a factor over the surface, which no [`FactoredBrdf`] has.
    ///
    /// # Panics
    ///
    /// Unless there is a value for each sample.
    pub fn fit(&self, problem: &Problem) -> Result<Fit, FactorError> {
        if self.plan.surface.is_some() {
            return Err(FactorError::Factors {
                found: "a factor over the surface".to_owned(),
                expected: "factors of directions alone",
            });
        }
        let values: Vec<Vec<f64>> =
            problem.values().iter().map(|values| problem.in_given_order(values)).collect();
        let mut workspace = self.workspace(values.len());
        self.solve(&values, problem.maps(), &mut workspace);
        let model = self.model(&workspace, problem.maps())?.into_angular();
        let clamp = problem.params().clamp;
        Ok(Fit {
            model: if clamp { model.with_ceilings(problem.largest_values())? } else { model },
            samples_used: problem.len(),
            dropped: problem.dropped(),
            clamped: problem.clamped(),
            zeros: problem.zeros(),
            unknowns: self.unknowns(),
            smoothed_texels: self.untouched_texels().iter().map(Vec::len).sum(),
            solver: Solver::Cholesky,
            iterations: 0,
            converged: true,
            predictions: self.predictions(&workspace),
        })
    }

    /// Returns the log values that the solution gives for the samples, by channel, in the order in which
    /// they were given.
    pub fn predictions(&self, workspace: &PreinvertedWorkspace) -> Vec<Vec<f64>> {
        let system = LinearSystem::new(self.columns.clone(), &self.ones);
        workspace
            .solution
            .chunks_exact(self.unknowns())
            .map(|x| {
                let mut given = vec![0.0; self.samples()];
                for (value, place) in system.predict(x).into_iter().zip(&self.order) {
                    given[*place] = value;
                }
                given
            })
            .collect()
    }

    /// Returns the model of the solution in a workspace, whose values were fitted through these maps.
    ///
    /// # Errors
    ///
    /// [`FactorError::Factors`] unless there are one or three channels.
    pub fn model(
        &self,
        workspace: &PreinvertedWorkspace,
        maps: &[ChannelTransform],
    ) -> Result<SurfaceProduct, FactorError> {
        self.model_of(&workspace.solution, maps)
    }

    /// Returns the model of log texels, `[channel][unknown]`, whose values were fitted through these maps.
    ///
    /// # Errors
    ///
    /// As [`Preinverted::model`].
    ///
    /// # Panics
    ///
    /// Unless there is a number for each unknown of each channel.
    pub fn model_of(
        &self,
        solution: &[f64],
        maps: &[ChannelTransform],
    ) -> Result<SurfaceProduct, FactorError> {
        let unknowns = self.unknowns();
        assert_eq!(solution.len(), maps.len() * unknowns, "a number for each unknown");
        let mut factors = self.factors.clone();
        let mut start = 0;
        let mut texels_of = |columns: &Columns, count: usize| {
            let mut texels = vec![[0.0_f64; 4]; count];
            for (channel, x) in solution.chunks_exact(unknowns).enumerate() {
                let own = columns.texels(&x[start..][..columns.unknowns()]);
                texels.iter_mut().zip(own).for_each(|(t, v)| t[channel] = v.unwrap_or(0.0));
            }
            start += columns.unknowns();
            texels
        };
        for (factor, columns) in factors.iter_mut().zip(&self.columns) {
            let texels = texels_of(columns, factor.grid().texels());
            store(factor, &texels)?;
        }
        let surface = self.plan.surface.zip(self.columns.last()).map(|((size, wraps), columns)| {
            let mut texels = texels_of(columns, size * size);
            let mean = take_out_mean(&mut texels);
            #[expect(clippy::cast_possible_truncation, reason = "textures are stored as f32")]
            let texels = texels.iter().map(|texel| texel.map(|v| v as f32)).collect();
            (SurfaceTexture { size, wraps, texels }, mean)
        });
        settle_constants(&mut factors, surface.as_ref().map_or([0.0; 4], |(_, mean)| *mean))?;
        let angular = FactoredBrdf::new(factors, maps.to_vec(), self.theta_max)?;
        SurfaceProduct::new(angular, surface.map(|(surface, _)| surface))
    }
}

impl fmt::Debug for PreinvertedWorkspace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut debug = f.debug_struct("PreinvertedWorkspace");
        debug.field("channels", &self.channels).field("solution", &self.solution);
        debug.finish_non_exhaustive()
    }
}

impl PreinvertedWorkspace {
    /// Returns the log texels of all factors, `[channel][unknown]`, factor after factor, that of the surface
    /// last.
    pub fn solution(&self) -> &[f64] {
        &self.solution
    }

    /// Returns the coefficients β, `[channel][component]`, which describe the values where the basis is
    /// known; empty with a Cholesky factor.
    pub fn coefficients(&self) -> &[f64] {
        &self.coefficients
    }
}

/// Factors without texels, and where samples read them.
fn layout(
    problem: &Problem,
    places: &[DVec2],
    plan: &Plan,
) -> Result<(Vec<Factor>, Vec<Arc<Columns>>), FactorError> {
    let refuse = |option, expected| Err(FactorError::Option { option, value: f64::NAN, expected });
    if problem.params().weight != Weight::Log {
        return refuse("the weight", "`log`, which does not depend on values");
    }
    if problem.params().log_map == LogTransform::Log {
        return refuse("the log map", "one that drops no samples");
    }
    let factors: Vec<Factor> = plan
        .factors
        .iter()
        .map(|(spec, size)| problem.empty_factor(spec, *size))
        .collect::<Result<_, _>>()?;
    if let Some((size, _)) = plan.surface {
        let (min, max) = (*crate::Grid::SIZES.start(), *crate::Grid::SIZES.end());
        if !crate::Grid::SIZES.contains(&size) {
            return Err(FactorError::TextureSize { size, min, max });
        }
        if places.len() != problem.len() {
            return Err(FactorError::Factors {
                found: format!("{} texture coordinates of {} samples", places.len(), problem.len()),
                expected: "one place on the surface for each sample",
            });
        }
    }
    let columns = columns_in(problem, places, &factors, plan.surface);
    Ok((factors, columns))
}

/// Where samples read factors, that of the surface last.
fn columns_in(
    problem: &Problem,
    places: &[DVec2],
    factors: &[Factor],
    surface: Option<(usize, bool)>,
) -> Vec<Arc<Columns>> {
    let angular = factors.iter().map(|factor| problem.columns(factor));
    let surface = surface.map(|(size, wraps)| problem.surface_columns(size, places, wraps));
    angular.chain(surface).map(Arc::new).collect()
}

/// Makes the mean of each channel 0 and returns what it was.
fn take_out_mean(texels: &mut [[f64; 4]]) -> [f64; 4] {
    let count = texels.len() as f64;
    let mean: [f64; 4] =
        std::array::from_fn(|channel| texels.iter().map(|t| t[channel]).sum::<f64>() / count);
    for texel in texels {
        texel.iter_mut().zip(mean).for_each(|(v, mean)| *v -= mean);
    }
    mean
}
