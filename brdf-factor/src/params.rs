//! The options of a factorization.

use brdf_param::Bound;
use serde::{Deserialize, Serialize};

use crate::{FactorError, LogTransform};

/// A way to solve the least-squares problem.
///
/// The solutions of all three agree to 1e-8 in the values that they give for the samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Solver {
    /// Dense Cholesky factorization of the normal equations: exact and fast up to
    /// [`Solver::MAX_DENSE`] unknowns.
    Cholesky,
    /// LSMR on A itself, matrix-free (Fong and Saunders 2011), for large textures.
    Lsmr,
    /// Quasi-minimal residuals on the normal equations (Freund and Nachtigal 1991), the choice of
    /// McCool, Ang and Ahmad 2001 and of Cole 2002; kept for comparison and for tests.
    Qmr,
}

impl Solver {
    /// The largest number of unknowns that is factored densely; beyond it the matrix would pass 512 MiB.
    pub const MAX_DENSE: usize = 8192;

    /// Returns the default solver for a number of unknowns: Cholesky up to [`Solver::MAX_DENSE`], LSMR
    /// beyond.
    pub fn for_unknowns(unknowns: usize) -> Self {
        if unknowns <= Self::MAX_DENSE { Self::Cholesky } else { Self::Lsmr }
    }
}

/// The weight of a sample: the number that its squared log residual is multiplied by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Weight {
    /// Weight 1, so that relative errors are made small.
    #[default]
    Log,
    /// Weight f, the mean over channels.
    F,
    /// Weight f², which comes close to making linear errors small.
    F2,
    /// The weight under which the four errors of a [`FidelityErrors`](brdf_model::FidelityErrors) are made small
    /// together: displayed values, cube roots, energy and logarithms.
    Fidelity,
}

/// The textures that are solved for together when a model has several terms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum TermSolve {
    /// All textures.
    #[default]
    All,
    /// The last n textures; earlier ones stay as they are in the model of fewer terms. Cole 2002 takes 2.
    Last(usize),
}

/// What a value of 0 asks of the logarithm that is fitted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Zeros {
    /// ln a, as for any other value.
    #[default]
    Exact,
    /// ln a or less: values end at 0, so that a model below it is right. Zeros are censored data.
    Below,
}

/// The options of a factorization.
///
/// ```
/// use brdf_factor::{FactorParams, Weight};
///
/// let params = FactorParams { texture_size: 16, weight: Weight::F, ..FactorParams::default() };
/// assert!(params.theta_max < std::f64::consts::FRAC_PI_2);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FactorParams {
    /// Texels along each side of a texture, within [`crate::Grid::SIZES`].
    pub texture_size: usize,
    /// The bound by which the image of the coordinates is fitted into the texture.
    pub bound: Bound,
    /// Smoothing μ ≥ 0: the Laplacian of each masked texel is weighted by λ² = μ Σw / (texels of the
    /// factor). 1e-4 costs nothing measurable; 1e-3 raises the log error by 5–14 %.
    pub smoothing: f64,
    /// The logarithm that is fitted.
    pub log_map: LogTransform,
    /// a of [`LogTransform::Offset`] over the mean of each channel, above 0. Values well below a are not told apart.
    pub offset: f64,
    /// The weights of samples.
    pub weight: Weight,
    /// The textures that are solved for together, where there are several terms.
    pub terms: TermSolve,
    /// Whether a model is held at the largest fitted value of each channel.
    pub clamp: bool,
    /// What values of 0 ask for.
    pub zeros: Zeros,
    /// Grazing limit in radians, (0, π/2]. Samples beyond it must not be given, and evaluation pulls
    /// directions back to it.
    pub theta_max: f64,
    /// The solver of the linear system; `None` lets [`Solver::for_unknowns`] choose.
    pub solver: Option<Solver>,
}

impl Default for FactorParams {
    fn default() -> Self {
        Self {
            texture_size: 32,
            bound: Bound::Disc,
            smoothing: 1e-4,
            log_map: LogTransform::Offset,
            offset: 1e-5,
            weight: Weight::Log,
            terms: TermSolve::All,
            clamp: true,
            zeros: Zeros::Exact,
            theta_max: 80_f64.to_radians(),
            solver: None,
        }
    }
}

impl FactorParams {
    pub(crate) fn check(&self) -> Result<(), FactorError> {
        // Written so that NaN is refused.
        if !(self.smoothing >= 0.0 && self.smoothing.is_finite()) {
            return Err(FactorError::Option {
                option: "smoothing",
                value: self.smoothing,
                expected: "0 or more",
            });
        }
        if !(self.offset > 0.0 && self.offset.is_finite()) {
            return Err(FactorError::Option {
                option: "the offset",
                value: self.offset,
                expected: "more than 0",
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
