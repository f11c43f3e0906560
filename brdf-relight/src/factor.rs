//! BRDFs as light maps and view maps.

use brdf_job::Job;
use brdf_model::{Brdf, Channels};
use brdf_param::{HemisphereMap, Parametrization};
use brdf_separable::{
    BrdfMatrix, Decomposition, EigenSolver, HemisphereGrid, Layout, MatrixParams, SeparableFit,
    SeparableParams, factorize_matrix,
};
use serde::{Deserialize, Serialize};

use crate::error::RelightError;

/// The number of channels of light maps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum LightMaps {
    /// Three channels: eigenpairs of red, green and blue each (the paper's).
    Rgb,
    /// One channel: singular vectors of all channels together; only view maps have colour.
    Joint,
}

/// Options of [`factor_for_relighting`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MapParams {
    /// Number of terms; groups of equal magnitude are completed beyond it.
    pub rank: usize,
    /// Number of channels of light maps.
    pub light_maps: LightMaps,
    /// Texels along a side of the maps.
    pub resolution: usize,
    /// p of the weights cosᵖθ: above 0, grazing directions count less.
    pub weight_power: f64,
}

/// Returns a BRDF factored over the orthographic discs of light and view.
///
/// ```
/// use brdf_job::Job;
/// use brdf_model::Preset;
/// use brdf_relight::{BrdfMaps, LightMaps, MapParams, factor_for_relighting};
///
/// let plastic = Preset::find("plastic").expect("a built-in material").brdf();
/// let params = MapParams { rank: 4, light_maps: LightMaps::Joint, resolution: 16, weight_power: 0.0 };
/// let fit = factor_for_relighting(&plastic, &params, &Job::new())?;
/// let maps = BrdfMaps::of(&fit.model)?;
/// assert_eq!((maps.terms, maps.light_channels()), (4, 1));
/// # Ok::<(), brdf_relight::RelightError>(())
/// ```
///
/// # Errors
///
/// [`RelightError::Separable`], such as a rank that the BRDF cannot give.
pub fn factor_for_relighting(
    brdf: &dyn Brdf,
    params: &MapParams,
    job: &Job<'_>,
) -> Result<SeparableFit, RelightError> {
    let map = HemisphereMap::OrthographicDisc;
    let chart = HemisphereGrid::Plane { map, resolution: params.resolution };
    let layout = Layout::new(Parametrization::Standard, chart, chart);
    let matrix_params = MatrixParams {
        channels: Channels::Rgb,
        weight_power: params.weight_power,
        ..MatrixParams::default()
    };
    let matrix = BrdfMatrix::sample(brdf, &layout, &matrix_params)?;
    let (matrix, decomposition) = match params.light_maps {
        LightMaps::Rgb => (matrix.symmetrized()?, Decomposition::Eigen(EigenSolver::Krylov)),
        LightMaps::Joint => (matrix, Decomposition::Svd),
    };
    let joint_rgb = params.light_maps == LightMaps::Joint;
    let settings =
        SeparableParams { decomposition, rank: params.rank, joint_rgb, ..Default::default() };
    Ok(factorize_matrix(&matrix, &settings, job)?)
}
