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

/// What light maps hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum LightMaps {
    /// Red, green and blue: eigenpairs of each channel (the paper's).
    Rgb,
    /// One number: singular vectors of all channels together; only view maps have colour.
    Joint,
}

/// Options of the factorization.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MapParams {
    /// Number of terms; groups of equal magnitude are completed beyond it.
    pub rank: usize,
    /// What light maps hold.
    pub light_maps: LightMaps,
    /// Texels along a side of the maps.
    pub resolution: usize,
    /// p of the weights cosᵖθ: above 0, grazing directions count less.
    pub weight_power: f64,
}

/// Returns a BRDF factored over the orthographic discs of light and view.
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
