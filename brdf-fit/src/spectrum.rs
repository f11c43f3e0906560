//! How many terms a material's light × view matrix needs.

use brdf_job::Job;
use brdf_model::{Brdf, Channels};
use brdf_param::{HemisphereMap, Parametrization};
use brdf_separable::{
    BrdfMatrix, ChannelSpectrum, Decomposition, EigenSolver, HemisphereGrid, Layout, MatrixParams,
    RankCosineRms, SeparableParams, cosine_rms_by_rank, factorize_matrix,
};

use crate::error::FitError;
use crate::material::Material;

/// Terms of a spectrum.
const TERMS: usize = 24;

fn light_view(resolution: usize) -> Layout {
    let grid = HemisphereGrid::Plane { map: HemisphereMap::OrthographicDisc, resolution };
    Layout::new(Parametrization::Standard, grid, grid)
}

/// Returns the 24 largest singular values of a material's light × view matrix over orthographic discs of so many
/// texels a side, for each channel.
///
/// # Errors
///
/// [`FitError::Separable`]; [`FitError::Stopped`].
pub fn light_view_spectrum(
    material: &Material<'_>,
    resolution: usize,
    job: &Job<'_>,
) -> Result<Vec<ChannelSpectrum>, FitError> {
    let params = MatrixParams { channels: material.channels(), ..MatrixParams::default() };
    let matrix = BrdfMatrix::sample(material.brdf(), &light_view(resolution), &params)?;
    let params = SeparableParams { rank: TERMS, tolerance: 1e-3, ..SeparableParams::default() };
    Ok(factorize_matrix(&matrix, &params, job)?.spectra)
}

/// Cosine-weighted RMS of 1, 2, … eigenpairs at one resolution, sr⁻¹.
#[derive(Clone, Debug, PartialEq)]
pub struct RankErrors {
    /// Texels along each side.
    pub resolution: usize,
    /// Over all pairs, where a few grazing ones may rule.
    pub absolute: Vec<f64>,
    /// Over those within 80° of the normal.
    pub within_80: Vec<f64>,
}

/// Resolutions and ranks of figure 4 of Wang, Tran and Luebke 2004.
const RESOLUTIONS: [usize; 4] = [16, 32, 48, 64];
const RANKS: usize = 16;

/// Returns the errors of up to 16 eigenpairs of a BRDF at four resolutions.
///
/// # Errors
///
/// [`FitError::Separable`]; [`FitError::Stopped`].
pub fn rank_errors(brdf: &dyn Brdf, job: &Job<'_>) -> Result<Vec<RankErrors>, FitError> {
    let jobs = job.split([1.0, 4.0, 9.0, 16.0]);
    let each = RESOLUTIONS.iter().zip(&jobs).map(|(&resolution, job)| {
        let params = MatrixParams { channels: Channels::Rgb, ..MatrixParams::default() };
        let matrix = BrdfMatrix::sample(brdf, &light_view(resolution), &params)?.symmetrized()?;
        let params = SeparableParams {
            decomposition: Decomposition::Eigen(EigenSolver::Krylov),
            rank: RANKS,
            tolerance: 1e-4,
            ..SeparableParams::default()
        };
        let fit = factorize_matrix(&matrix, &params, job)?;
        let errors = cosine_rms_by_rank(brdf, &fit.model, 1);
        let of = |pick: fn(&RankCosineRms) -> f64| errors.iter().map(pick).take(RANKS).collect();
        Ok(RankErrors { resolution, absolute: of(|e| e.absolute), within_80: of(|e| e.within_80) })
    });
    each.collect()
}
