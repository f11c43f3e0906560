//! Spaces fitted to texels.

use brdf_job::Job;
use faer::{Mat, Side};
use rayon::prelude::*;

use crate::cluster::cluster_shapes;
use crate::nearest::dot;
use crate::projected_texels::ProjectedTexels;
use crate::{AngularGrid, VqError};

/// Rounds of choosing spaces and clusters.
const ITERATIONS: usize = 12;

/// A fit of local principal components: affine spaces in the coefficients of a survey, and a place in one of them
/// for each texel.
#[derive(Clone, Debug)]
pub struct LocalPca {
    /// Dimensions of the survey.
    dims: usize,
    pub(super) components: usize,
    /// `[cluster][1 + component][dim]`: the mean, then orthonormal directions.
    pub(crate) spaces: Vec<f32>,
    pub(crate) cluster: Vec<u32>,
    /// `[texel][component]`.
    pub(crate) coefficients: Vec<f32>,
    /// Sum of squared errors in the metric of the survey, before anything is quantized.
    pub error: f64,
}

impl LocalPca {
    /// Fits `clusters` spaces of `components` dimensions to the texels of a survey.
    pub fn fit(survey: &ProjectedTexels, clusters: usize, components: usize) -> Self {
        let dims = survey.space.dims;
        let components = components.min(dims);
        let ones = vec![1.0; survey.texels()];
        let start = cluster_shapes(&survey.coefficients, dims, &ones, &[], clusters, 4);
        let mut cluster = start.assignment;
        let count = start.codes.len() / dims;
        let mut spaces = Vec::new();
        let mut placed = Vec::new();
        for _ in 0..ITERATIONS {
            spaces = fit_spaces(survey, &cluster, count, components);
            placed = place(survey, &spaces, components);
            cluster = placed.iter().map(|p| p.0).collect();
        }
        let error = placed.iter().zip(&survey.energies).zip(survey.coefficients.chunks_exact(dims));
        let error = error
            .map(|((p, energy), x)| f64::from(p.1) + f64::from((energy - dot(x, x)).max(0.0)))
            .sum();
        let coefficients = survey
            .coefficients
            .par_chunks_exact(dims)
            .zip(&cluster)
            .flat_map_iter(|(x, cluster)| {
                let space = space_of(&spaces, *cluster as usize, components, dims);
                coordinates(space, x, dims)
            })
            .collect();
        Self { dims, components, spaces, cluster, coefficients, error }
    }

    /// Returns the number of clusters.
    pub fn clusters(&self) -> usize {
        self.spaces.len() / ((self.components + 1) * self.dims)
    }

    /// Returns the number of components of each cluster.
    pub fn components(&self) -> usize {
        self.components
    }
}

/// Returns the bytes of bases and texels where each value takes `value` bytes.
pub fn lpca_bytes(
    grid: &AngularGrid,
    texels: usize,
    clusters: usize,
    components: usize,
    value: usize,
) -> usize {
    let basis = clusters * (components + 1) * 3 * grid.node_count() * value;
    basis + texels * (usize::from(clusters > 1) + components * value)
}

/// Numbers of components that are tried.
const COMPONENTS: [usize; 13] = [1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 24, 32];

/// Returns the best of the fits whose bases and texels take at most `bytes` bytes, `value` bytes a value.
///
/// # Errors
///
/// [`VqError::Budget`] where not even one component of one cluster fits; [`VqError::Stopped`].
pub fn fit_lpca(
    survey: &ProjectedTexels,
    bytes: usize,
    value: usize,
    job: &Job<'_>,
) -> Result<LocalPca, VqError> {
    job.begin("fitting components", COMPONENTS.len() as u64);
    let mut best: Option<LocalPca> = None;
    for components in COMPONENTS {
        job.check()?;
        job.advance(1);
        let size =
            |clusters| lpca_bytes(&survey.grid, survey.texels(), clusters, components, value);
        let Some(clusters) = (1..=256).rev().find(|c| size(*c) <= bytes) else { break };
        let fit = LocalPca::fit(survey, clusters, components);
        if best.as_ref().is_none_or(|b| fit.error < b.error) {
            best = Some(fit);
        }
    }
    best.ok_or_else(|| VqError::Budget {
        bytes: bytes as u64,
        what: "one principal component".to_owned(),
        least: lpca_bytes(&survey.grid, survey.texels(), 1, 1, value) as u64,
    })
}

fn space_of(spaces: &[f32], cluster: usize, components: usize, dims: usize) -> &[f32] {
    let len = (components + 1) * dims;
    &spaces[cluster * len..][..len]
}

fn coordinates(space: &[f32], x: &[f32], dims: usize) -> Vec<f32> {
    let centred: Vec<f32> = x.iter().zip(space).map(|(x, m)| x - m).collect();
    space[dims..].chunks_exact(dims).map(|axis| dot(axis, &centred)).collect()
}

/// Means and principal directions of the texels of each cluster.
fn fit_spaces(
    survey: &ProjectedTexels,
    cluster: &[u32],
    count: usize,
    components: usize,
) -> Vec<f32> {
    let dims = survey.space.dims;
    let mut members = vec![Vec::new(); count];
    for (texel, cluster) in cluster.iter().enumerate() {
        members[*cluster as usize].push(texel);
    }
    let spaces: Vec<Vec<f32>> = members
        .par_iter()
        .map(|members| {
            let texel = |at: &usize| &survey.coefficients[at * dims..][..dims];
            let mut mean = vec![0.0_f64; dims];
            for x in members.iter().map(texel) {
                mean.iter_mut().zip(x).for_each(|(m, v)| *m += f64::from(*v));
            }
            let share = 1.0 / members.len().max(1) as f64;
            mean.iter_mut().for_each(|m| *m *= share);
            affine_space(&mean, members.iter().map(texel), components)
        })
        .collect();
    spaces.concat()
}

#[expect(clippy::cast_possible_truncation, reason = "spaces are kept in f32")]
fn affine_space<'a>(
    mean: &[f64],
    members: impl Iterator<Item = &'a [f32]>,
    components: usize,
) -> Vec<f32> {
    let dims = mean.len();
    let centred: Vec<f32> =
        members.flat_map(|x| x.iter().zip(mean).map(|(v, m)| v - *m as f32)).collect();
    let rows = faer::MatRef::from_row_major_slice(&centred, centred.len() / dims, dims);
    let mut covariance = Mat::<f32>::zeros(dims, dims);
    let (dst, accum) = (covariance.as_mut(), faer::Accum::Replace);
    faer::linalg::matmul::matmul(dst, accum, rows.transpose(), rows, 1.0, faer::Par::Seq);
    let wide = Mat::from_fn(dims, dims, |i, j| f64::from(covariance[(i, j)]));
    let mut space: Vec<f32> = mean.iter().map(|m| *m as f32).collect();
    match wide.self_adjoint_eigen(Side::Lower) {
        Ok(eigen) => {
            let vectors = eigen.U();
            for component in 0..components {
                let column = dims - 1 - component;
                space.extend((0..dims).map(|i| vectors[(i, column)] as f32));
            }
        }
        // Not reached for finite values; no directions are a space too.
        Err(_) => space.extend(vec![0.0; components * dims]),
    }
    space
}

/// The nearest space of each texel and the squared distance to it.
fn place(survey: &ProjectedTexels, spaces: &[f32], components: usize) -> Vec<(u32, f32)> {
    let dims = survey.space.dims;
    survey
        .coefficients
        .par_chunks_exact(dims)
        .map(|x| {
            let mut best = (0, f32::INFINITY);
            for (at, space) in spaces.chunks_exact((components + 1) * dims).enumerate() {
                let centred: Vec<f32> = x.iter().zip(space).map(|(x, m)| x - m).collect();
                let inside: f32 =
                    space[dims..].chunks_exact(dims).map(|a| dot(a, &centred).powi(2)).sum();
                let left = (dot(&centred, &centred) - inside).max(0.0);
                if left < best.1 {
                    best = (u32::try_from(at).unwrap_or(0), left);
                }
            }
            best
        })
        .collect()
}
