//! Truncated decompositions of a matrix into a model.

use brdf_job::Job;
use faer::{Mat, MatRef};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::krylov::fix_signs;
use crate::matrix::RankError;
use crate::model::SecondSide;
use crate::normalized::normalized_factors;
use crate::{
    BrdfMatrix, HemisphereGrid, KrylovParams, NonnegativeParams, SeparableBrdf, SeparableError,
    TopPairs, nonnegative_factors, power_iteration, top_eigenpairs, top_singular_triplets,
};

/// The decompositions that a model can be made by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Decomposition {
    /// Truncated singular value decomposition, which has the least squared error of its rank.
    #[default]
    Svd,
    /// Eigenpairs of largest magnitude of the symmetrized matrix: one set of textures for both sides, and a
    /// sign for each term. Source: Wang, Tran and Luebke 2004.
    Eigen(EigenSolver),
    /// Non-negative factors, so that no value is negative.
    Nmf,
    /// One term, by the norms of rows. Source: Kautz and McCool 1999.
    Normalized,
}

/// The methods by which eigenpairs are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum EigenSolver {
    /// A block Krylov method that stops by residuals: [`top_eigenpairs`].
    #[default]
    Krylov,
    /// The power iteration printed by Wang, Tran and Luebke 2004, which fails where eigenvalues of
    /// opposite sign are equal.
    Power,
}

/// The options of a factorization.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeparableParams {
    /// Decomposition to use.
    pub decomposition: Decomposition,
    /// Number of terms, ≥ 1. Where the last ones belong to a group of equal magnitude, the group is
    /// completed.
    pub rank: usize,
    /// Whether all channels share one decomposition, with scalar textures on the first side.
    pub joint_rgb: bool,
    /// Largest residual of a pair, relative to its value.
    pub tolerance: f64,
}

impl Default for SeparableParams {
    fn default() -> Self {
        Self { decomposition: Decomposition::Svd, rank: 4, joint_rgb: false, tolerance: 1e-5 }
    }
}

/// The values and residuals of a decomposition of one channel, or of all channels together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ChannelSpectrum {
    /// Singular values, eigenvalues with sign, or the norms of non-negative terms, of the weighted
    /// matrix.
    pub values: Vec<f64>,
    /// Residual ‖Mv − λv‖ / |λ| of each value; empty for decompositions that have no such measure.
    pub residuals: Vec<f64>,
    /// Number of terms beyond the rank that complete a group of equal magnitude.
    pub added: usize,
    /// Whether a group goes on beyond the last term.
    pub cuts_a_group: bool,
    /// Whether the iteration met its tolerance.
    pub converged: bool,
}

/// A fitted model, with the decomposition and the errors of its fit.
#[derive(Clone, Debug)]
pub struct SeparableFit {
    /// The model; channels with fewer terms than others have zeros.
    pub model: SeparableBrdf,
    /// Decomposition of each channel; one entry where all were taken together.
    pub spectra: Vec<ChannelSpectrum>,
    /// Errors over the matrix: for every rank where the leading terms of the decomposition make a model, else
    /// for the last rank alone.
    pub errors: Vec<RankError>,
}

/// Returns the model of the leading terms of a matrix's decomposition.
///
/// The `job` is told of progress and can stop the work.
///
/// ```
/// use brdf_job::Job;
/// use brdf_model::Preset;
/// use brdf_param::{HemisphereMap, Parametrization};
/// use brdf_separable::{
///     BrdfMatrix, Decomposition, HemisphereGrid, Layout, MatrixParams, SeparableParams,
///     factorize_matrix,
/// };
///
/// let plastic = Preset::find("plastic").expect("a preset").brdf();
/// let grid = HemisphereGrid::Plane { map: HemisphereMap::OrthographicDisc, resolution: 8 };
/// let layout = Layout::new(Parametrization::Standard, grid, grid);
/// let matrix = BrdfMatrix::sample(&plastic, &layout, &MatrixParams::default())?;
/// let params = SeparableParams { decomposition: Decomposition::Svd, rank: 4, ..Default::default() };
/// let fit = factorize_matrix(&matrix, &params, &Job::new())?;
/// let errors: Vec<f64> = fit.errors.iter().map(|error| error.relative_residual).collect();
/// assert!(errors.windows(2).all(|pair| pair[1] <= pair[0]), "more terms, less error");
/// # Ok::<(), brdf_separable::SeparableError>(())
/// ```
///
/// # Errors
///
/// [`SeparableError::Rank`] for a rank that the matrix cannot have; [`SeparableError::NotSymmetric`]
/// for eigenpairs of a layout whose sides differ, or of all channels together;
/// [`SeparableError::Negative`] for non-negative factors of a matrix with negative values;
/// [`SeparableError::Dense`] where a dense decomposition fails; [`SeparableError::Stopped`] where the
/// job is stopped.
pub fn factorize_matrix(
    matrix: &BrdfMatrix,
    params: &SeparableParams,
    job: &Job<'_>,
) -> Result<SeparableFit, SeparableError> {
    let channels = matrix.maps().len();
    let is_eigen = matches!(params.decomposition, Decomposition::Eigen(_));
    if is_eigen && !matrix.layout().is_symmetric() {
        return Err(SeparableError::NotSymmetric {
            found: "the two sides of this layout differ",
            expected: "the standard parametrization and the same chart for light and view",
        });
    }
    if is_eigen && params.joint_rgb && channels > 1 {
        return Err(SeparableError::NotSymmetric {
            found: "three channels side by side make no symmetric matrix",
            expected: "one channel at a time (the SVD takes them together)",
        });
    }
    job.begin("decomposing", channels as u64);
    let scaled: Vec<Mat<f64>> = (0..channels).map(|c| matrix.scaled(c)).collect();
    let parts: Vec<Part> = if params.joint_rgb && channels > 1 {
        vec![decompose(side_by_side(&scaled).as_ref(), params, job)?]
    } else {
        scaled
            .par_iter()
            .map(|m| {
                let part = decompose(m.as_ref(), params, job);
                job.advance(1);
                part
            })
            .collect::<Result<_, _>>()?
    };
    let rank = parts.iter().map(|part| part.first.ncols()).max().unwrap_or(0).max(1);
    let model = assemble(matrix, &parts, rank, is_eigen)?;
    let ranks: Vec<usize> = match params.decomposition {
        Decomposition::Svd | Decomposition::Eigen(_) => (1..=rank).collect(),
        Decomposition::Nmf | Decomposition::Normalized => vec![rank],
    };
    Ok(SeparableFit {
        errors: matrix.rank_errors(&model, &ranks),
        model,
        spectra: parts.into_iter().map(|part| part.spectrum).collect(),
    })
}

/// Both sides of a decomposition, one term a column, scaled alike, and signs.
struct Part {
    first: Mat<f64>,
    second: Mat<f64>,
    signs: Vec<f64>,
    spectrum: ChannelSpectrum,
}

fn side_by_side(channels: &[Mat<f64>]) -> Mat<f64> {
    let (rows, columns) = (channels[0].nrows(), channels[0].ncols());
    Mat::from_fn(rows, columns * channels.len(), |row, column| {
        channels[column / columns][(row, column % columns)]
    })
}

fn decompose(
    matrix: MatRef<'_, f64>,
    params: &SeparableParams,
    job: &Job<'_>,
) -> Result<Part, SeparableError> {
    job.check()?;
    let krylov =
        KrylovParams { rank: params.rank, tolerance: params.tolerance, ..KrylovParams::default() };
    match params.decomposition {
        Decomposition::Svd => Ok(Part::of_pairs(top_singular_triplets(matrix, &krylov)?)),
        Decomposition::Eigen(EigenSolver::Krylov) => {
            Ok(Part::of_pairs(top_eigenpairs(matrix, &krylov)?))
        }
        Decomposition::Eigen(EigenSolver::Power) => {
            let pairs = power_iteration(matrix, params.rank, 1);
            let mut vectors =
                Mat::from_fn(matrix.nrows(), pairs.len(), |row, k| pairs[k].vector[row]);
            fix_signs(&mut vectors);
            let residuals: Vec<f64> = pairs.iter().map(|p| p.residual).collect();
            Ok(Part::of_pairs(TopPairs {
                values: pairs.iter().map(|p| p.value).collect(),
                right: vectors.clone(),
                left: vectors,
                added: 0,
                cuts_a_group: false,
                converged: residuals.iter().all(|r| *r <= params.tolerance),
                residuals,
                products: pairs.iter().map(|p| p.iterations).sum(),
            }))
        }
        Decomposition::Nmf => {
            let options = NonnegativeParams { rank: params.rank, ..NonnegativeParams::default() };
            let (first, second, sweeps) = nonnegative_factors(matrix, &options, job)?;
            Ok(Part::of_sides(first, second, sweeps < options.sweeps))
        }
        Decomposition::Normalized => {
            if params.rank != 1 {
                let (rows, columns) = (matrix.nrows(), matrix.ncols());
                return Err(SeparableError::Rank { rank: params.rank, max: 1, rows, columns });
            }
            let (g, h) = normalized_factors(matrix);
            let first = Mat::from_fn(g.len(), 1, |row, _| g[row]);
            let second = Mat::from_fn(h.len(), 1, |row, _| h[row]);
            Ok(Part::of_sides(first, second, true))
        }
    }
}

impl Part {
    /// √|λ| v on both sides, the sign beside.
    fn of_pairs(pairs: TopPairs) -> Self {
        let side = |vectors: &Mat<f64>| {
            Mat::from_fn(vectors.nrows(), vectors.ncols(), |row, k| {
                pairs.values[k].abs().sqrt() * vectors[(row, k)]
            })
        };
        Self {
            first: side(&pairs.left),
            second: side(&pairs.right),
            signs: pairs.values.iter().map(|v| v.signum()).collect(),
            spectrum: ChannelSpectrum {
                values: pairs.values,
                residuals: pairs.residuals,
                added: pairs.added,
                cuts_a_group: pairs.cuts_a_group,
                converged: pairs.converged,
            },
        }
    }

    fn of_sides(first: Mat<f64>, second: Mat<f64>, converged: bool) -> Self {
        let size = |k: usize| first.col(k).norm_l2() * second.col(k).norm_l2();
        let spectrum = ChannelSpectrum {
            values: (0..first.ncols()).map(size).collect(),
            residuals: Vec::new(),
            added: 0,
            cuts_a_group: false,
            converged,
        };
        Self { signs: vec![1.0; first.ncols()], first, second, spectrum }
    }
}

/// Takes the weights out again and puts the terms into textures.
fn assemble(
    matrix: &BrdfMatrix,
    parts: &[Part],
    rank: usize,
    shared: bool,
) -> Result<SeparableBrdf, SeparableError> {
    let channels = matrix.maps().len();
    let layout = *matrix.layout();
    let [row_scales, column_scales] = matrix.scales();
    let columns = matrix.columns().len();
    let row_texels: Vec<usize> = matrix.rows().iter().map(|n| n.texel).collect();
    let column_texels: Vec<usize> = matrix.columns().iter().map(|n| n.texel).collect();
    let first = textures(&layout.first, &row_texels, rank, parts.len(), |node, term, channel| {
        let side = &parts[channel].first;
        if term < side.ncols() { side[(node, term)] / row_scales[node] } else { 0.0 }
    });
    let sign = |term: usize, channel: usize| {
        let signs = &parts[channel.min(parts.len() - 1)].signs;
        signs.get(term).copied().unwrap_or(1.0)
    };
    let second = if shared {
        let signs = (0..rank).flat_map(|k| (0..channels).map(move |c| (k, c)));
        SecondSide::Signs(signs.map(|(k, c)| if sign(k, c) < 0.0 { -1.0 } else { 1.0 }).collect())
    } else {
        SecondSide::Textures(textures(
            &layout.second,
            &column_texels,
            rank,
            channels,
            |node, term, channel| {
                // Channels that were taken together stand below each other.
                let (part, row) = match parts {
                    [all] => (all, channel * columns + node),
                    _ => (&parts[channel], node),
                };
                if term < part.second.ncols() {
                    sign(term, channel) * part.second[(row, term)] / column_scales[node]
                } else {
                    0.0
                }
            },
        ))
    };
    SeparableBrdf::new(layout, matrix.maps().to_vec(), rank, first, second)
}

/// Textures `[texel, term, channel]` from values at nodes, continued over the texels between.
fn textures(
    chart: &HemisphereGrid,
    nodes: &[usize],
    rank: usize,
    channels: usize,
    value: impl Fn(usize, usize, usize) -> f64,
) -> Vec<f32> {
    let width = rank * channels;
    let mut out = vec![0.0; chart.texels() * width];
    let mut known = vec![false; chart.texels()];
    for (node, &texel) in nodes.iter().enumerate() {
        known[texel] = true;
        for term in 0..rank {
            for channel in 0..channels {
                #[expect(clippy::cast_possible_truncation, reason = "textures are stored in f32")]
                let narrow = value(node, term, channel) as f32;
                out[texel * width + term * channels + channel] = narrow;
            }
        }
    }
    chart.fill_unknown(&mut known, &mut out, width);
    out
}
