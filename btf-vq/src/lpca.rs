//! Local principal components: clusters of texels, each an affine space of few dimensions, with bytes
//! for coefficients and bases. The rival of the codebooks, on the same grid and as randomly readable.
//!
//! Source: G. Müller, J. Meseth and R. Klein, "Compression and Real-Time Rendering of Measured BTFs
//! Using Local PCA", Vision, Modeling and Visualisation 2003; bytes instead of floats are ours.

use std::ops::Range;

use faer::{Mat, Side};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::books::level_size;
use crate::cluster::cluster_shapes;
use crate::colour::from_luma_chroma;
use crate::nearest::dot;
use crate::survey::Survey;
use crate::{AngularGrid, Encoding, SharedBytes, Taps, VqError};

/// Rounds of choosing spaces and clusters.
const ITERATIONS: usize = 12;

/// Affine spaces in the coefficients of a survey and a place in one of them for each texel.
#[derive(Clone, Debug)]
pub struct LocalPca {
    /// Dimensions of the survey.
    dims: usize,
    components: usize,
    /// `[cluster][1 + component][dim]`: the mean, then orthonormal directions.
    spaces: Vec<f32>,
    cluster: Vec<u32>,
    /// `[texel][component]`.
    coefficients: Vec<f32>,
    /// Sum of squared errors in the metric of the survey, before anything is quantised.
    pub error: f64,
}

impl LocalPca {
    /// Fits so many spaces of so many dimensions to the texels of a survey.
    pub fn fit(survey: &Survey, clusters: usize, components: usize) -> Self {
        let dims = survey.space.dims;
        let components = components.min(dims);
        let ones = vec![1.0; survey.texels()];
        let start = cluster_shapes(&survey.coefficients, dims, &ones, clusters, 4);
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

    /// Clusters.
    pub fn clusters(&self) -> usize {
        self.spaces.len() / ((self.components + 1) * self.dims)
    }

    /// Components of each.
    pub fn components(&self) -> usize {
        self.components
    }
}

/// Bytes of bases and texels with values of so many bytes.
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

/// The best of the fits whose bases and texels take at most so many bytes.
///
/// # Errors
///
/// [`VqError::Budget`] where not even one component of one cluster fits.
pub fn fit_lpca(survey: &Survey, bytes: usize, value: usize) -> Result<LocalPca, VqError> {
    let mut best: Option<LocalPca> = None;
    for components in [1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 24, 32] {
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
fn fit_spaces(survey: &Survey, cluster: &[u32], count: usize, components: usize) -> Vec<f32> {
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
            #[expect(clippy::cast_precision_loss, reason = "far fewer than 2⁵³ texels")]
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
fn place(survey: &Survey, spaces: &[f32], components: usize) -> Vec<(u32, f32)> {
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

/// A straight line from codes to values.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Steps {
    /// Value of code 0.
    pub min: f32,
    /// Difference of neighbouring codes.
    pub step: f32,
}

impl Steps {
    fn over(values: impl Iterator<Item = f32>) -> Self {
        let (min, max) =
            values.fold((f32::INFINITY, f32::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        if min < max {
            Self { min, step: (max - min) / 255.0 }
        } else {
            Self { min: min.min(max), step: 0.0 }
        }
    }

    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
    fn encode(self, value: f32) -> u8 {
        if self.step > 0.0 {
            ((value - self.min) / self.step).round().clamp(0.0, 255.0) as u8
        } else {
            0
        }
    }

    fn decode(self, code: u8) -> f32 {
        self.min + self.step * f32::from(code)
    }
}

/// A texture over local principal components.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LpcaMaterial {
    /// What it is called.
    pub name: String,
    /// Texels in a row of the finest level.
    pub width: usize,
    /// Rows of the finest level.
    pub height: usize,
    /// Whether values contain the cosine of the light's polar angle.
    pub cosine_included: bool,
    /// Resolutions.
    pub levels: usize,
}

/// What the streams mean.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LpcaHeader {
    /// Nodes.
    pub grid: AngularGrid,
    /// What values mean.
    pub encoding: Encoding,
    /// Number of spaces, 1 to 256.
    pub clusters: usize,
    /// Dimensions of each, 0 to 64.
    pub components: usize,
    /// Of bases, `[cluster][mean, components …]`.
    pub basis: Vec<Steps>,
    /// Of coefficients, `[cluster][component]`.
    pub coefficients: Vec<Steps>,
    /// The textures.
    pub materials: Vec<LpcaMaterial>,
}

impl LpcaHeader {
    /// Bytes of a texel: its cluster, if there are several, and its coefficients.
    fn texel_len(&self) -> usize {
        usize::from(self.clusters > 1) + self.components
    }

    /// Names of the streams, in order.
    pub fn stream_names(&self) -> Vec<String> {
        let textures = self.materials.iter().enumerate().flat_map(|(index, material)| {
            (0..material.levels).map(move |level| format!("texels.{index}.{level}"))
        });
        std::iter::once("basis".to_owned()).chain(textures).collect()
    }

    fn check(&self) -> Result<(), VqError> {
        self.grid.check()?;
        let refuse = |what, found: String, expected| Err(VqError::Header { what, found, expected });
        let Self { clusters, components, .. } = *self;
        if !(1..=256).contains(&clusters) || components > 64 {
            let found = format!("{clusters} × {components}");
            return refuse("clusters × components", found, "1 to 256 clusters of at most 64");
        }
        let lines = [self.basis.len(), self.coefficients.len()];
        if lines != [clusters * (components + 1), clusters * components] {
            return refuse("the number of ranges", format!("{lines:?}"), "one for each vector");
        }
        let steps = self.basis.iter().chain(&self.coefficients);
        if !steps.clone().all(|s| s.min.is_finite() && s.step.is_finite()) {
            return refuse("a range", "not finite".to_owned(), "finite numbers");
        }
        for material in &self.materials {
            let texels = material.width.checked_mul(material.height);
            let is_sound = texels.is_some_and(|n| (1..=1 << 28).contains(&n));
            if !is_sound || !(1..=28).contains(&material.levels) {
                let found = format!("{} × {}", material.width, material.height);
                return refuse("a texture's size", found, "1 to 2^28 texels and 1 to 28 levels");
            }
        }
        Ok(())
    }
}

/// Local principal components in bytes.
#[derive(Clone)]
pub struct LpcaModel {
    header: LpcaHeader,
    bytes: SharedBytes,
    ranges: Vec<Range<usize>>,
}

impl std::fmt::Debug for LpcaModel {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("LpcaModel").field("header", &self.header).finish_non_exhaustive()
    }
}

impl LpcaModel {
    /// A model from its header and where each of [`LpcaHeader::stream_names`] lies in `bytes`.
    ///
    /// # Errors
    ///
    /// [`VqError::Header`], [`VqError::Grid`], [`VqError::Stream`], [`VqError::Index`].
    pub fn new(
        header: LpcaHeader,
        bytes: SharedBytes,
        ranges: Vec<Range<usize>>,
    ) -> Result<Self, VqError> {
        header.check()?;
        let model = Self { header, bytes, ranges };
        let header = &model.header;
        let nodes = header.clusters * header.grid.node_count() * 3;
        let mut expected = vec![("basis", nodes, header.components + 1)];
        for material in &header.materials {
            for level in 0..material.levels {
                let (width, height) = level_size(material.width, material.height, level);
                expected.push(("texels", width * height, header.texel_len()));
            }
        }
        for (at, (book, rows, len)) in expected.into_iter().enumerate() {
            let found = model.stream(at).len();
            if found != rows * len {
                return Err(VqError::Stream { book, found, expected: rows * len, rows });
            }
            let is_texture = at > 0 && header.clusters > 1;
            let clusters = model.stream(at).iter().step_by(len.max(1)).enumerate();
            let bad =
                clusters.filter(|_| is_texture).find(|c| usize::from(*c.1) >= header.clusters);
            if let Some((row, index)) = bad {
                let index = u32::from(*index);
                return Err(VqError::Index {
                    book,
                    row,
                    index,
                    target: "basis",
                    rows: header.clusters,
                });
            }
        }
        Ok(model)
    }

    /// Packs a fit of a survey whose texels are those of the levels of these materials, one after
    /// another. Every value loses what a byte cannot hold.
    ///
    /// # Errors
    ///
    /// [`VqError::Header`] for more clusters or components than a model can have.
    pub fn pack(
        survey: &Survey,
        fit: &LocalPca,
        materials: Vec<LpcaMaterial>,
    ) -> Result<Self, VqError> {
        let (clusters, components) = (fit.clusters(), fit.components);
        let vectors = components + 1;
        let values = survey.space.lift(&fit.spaces);
        let len = survey.space.len;
        let plain: Vec<Vec<f32>> = values
            .chunks_exact(len)
            .map(|v| v.iter().zip(&survey.root_weights).map(|(v, r)| v / r).collect())
            .collect();
        let basis: Vec<Steps> = plain.iter().map(|v| Steps::over(v.iter().copied())).collect();
        let nodes = survey.grid.node_count();
        let mut bytes = Vec::with_capacity(clusters * vectors * len);
        for cluster in 0..clusters {
            for node in 0..nodes {
                for channel in 0..3 {
                    let at = channel * nodes + node;
                    let of = |v: usize| {
                        basis[cluster * vectors + v].encode(plain[cluster * vectors + v][at])
                    };
                    bytes.extend((0..vectors).map(of));
                }
            }
        }
        let coefficients: Vec<Steps> = (0..clusters * components)
            .map(|at| {
                let (cluster, component) = (at / components, at % components);
                let members = fit.coefficients.chunks_exact(components).zip(&fit.cluster);
                let own = members.filter(|(_, c)| **c as usize == cluster);
                Steps::over(own.map(|(x, _)| x[component]))
            })
            .map(|s| if s.min.is_finite() { s } else { Steps { min: 0.0, step: 0.0 } })
            .collect();
        let mut ranges: Vec<Range<usize>> = std::iter::once(0..bytes.len()).collect();
        let mut texel = 0;
        for material in &materials {
            for level in 0..material.levels {
                let (width, height) = level_size(material.width, material.height, level);
                let start = bytes.len();
                for at in texel..texel + width * height {
                    let cluster = fit.cluster[at] as usize;
                    if clusters > 1 {
                        bytes.push(u8::try_from(cluster).unwrap_or(u8::MAX));
                    }
                    let own = &fit.coefficients[at * components..][..components];
                    let lines = &coefficients[cluster * components..][..components];
                    bytes.extend(own.iter().zip(lines).map(|(x, line)| line.encode(*x)));
                }
                texel += width * height;
                ranges.push(start..bytes.len());
            }
        }
        let header = LpcaHeader {
            grid: survey.grid,
            encoding: survey.encoding,
            clusters,
            components,
            basis,
            coefficients,
            materials,
        };
        Self::new(header, std::sync::Arc::new(bytes), ranges)
    }

    /// What the streams mean.
    pub fn header(&self) -> &LpcaHeader {
        &self.header
    }

    /// A stream, by its place in [`LpcaHeader::stream_names`].
    pub fn stream(&self, at: usize) -> &[u8] {
        let bytes: &[u8] = (*self.bytes).as_ref();
        self.ranges.get(at).and_then(|range| bytes.get(range.clone())).unwrap_or_default()
    }

    /// A reader of one of the textures; `None` if there are fewer.
    pub fn decoder(&self, material: usize) -> Option<LpcaDecoder<'_>> {
        let texture = self.header.materials.get(material)?;
        let first = 1 + self.header.materials[..material].iter().map(|m| m.levels).sum::<usize>();
        let levels = (0..texture.levels)
            .map(|level| {
                let (width, height) = level_size(texture.width, texture.height, level);
                (width, height, self.stream(first + level))
            })
            .collect();
        Some(LpcaDecoder { header: &self.header, basis: self.stream(0), levels })
    }
}

/// Reads a texture of local principal components.
#[derive(Clone, Debug)]
pub struct LpcaDecoder<'a> {
    header: &'a LpcaHeader,
    basis: &'a [u8],
    levels: Vec<(usize, usize, &'a [u8])>,
}

/// Most vectors of a space.
const MAX_VECTORS: usize = 65;

impl LpcaDecoder<'_> {
    /// The grid.
    pub fn grid(&self) -> &AngularGrid {
        &self.header.grid
    }

    /// What values mean.
    pub fn encoding(&self) -> Encoding {
        self.header.encoding
    }

    /// Resolutions.
    pub fn levels(&self) -> usize {
        self.levels.len()
    }

    /// Texels in a row, and rows, of a level; levels past the last are the last.
    pub fn size(&self, level: usize) -> (usize, usize) {
        let (width, height, _) = self.levels[level.min(self.levels.len() - 1)];
        (width, height)
    }

    /// Cluster of a texel, and the factors of its vectors' codes and their sum of minima.
    fn factors(
        &self,
        level: usize,
        texel: usize,
        factors: &mut [f32; MAX_VECTORS],
    ) -> (usize, f32) {
        let header = self.header;
        let bytes = &self.levels[level].2[texel * header.texel_len()..][..header.texel_len()];
        let (cluster, codes) = match header.clusters {
            1 => (0, bytes),
            _ => (usize::from(bytes[0]), &bytes[1..]),
        };
        let vectors = header.components + 1;
        let lines = &header.coefficients[cluster * header.components..][..header.components];
        let basis = &header.basis[cluster * vectors..][..vectors];
        factors[0] = basis[0].step;
        let mut constant = basis[0].min;
        for (at, (line, code)) in lines.iter().zip(codes).enumerate() {
            let x = line.decode(*code);
            factors[at + 1] = x * basis[at + 1].step;
            constant += x * basis[at + 1].min;
        }
        (cluster, constant)
    }

    /// Luminance and chrominances of a node of a cluster, given factors.
    #[inline]
    fn node(&self, cluster: usize, node: usize, factors: &[f32], constant: f32) -> [f32; 3] {
        let vectors = self.header.components + 1;
        let at = (cluster * self.header.grid.node_count() + node) * 3 * vectors;
        let codes = &self.basis[at..at + 3 * vectors];
        std::array::from_fn(|channel| {
            let row = &codes[channel * vectors..][..vectors];
            constant + row.iter().zip(factors).map(|(c, f)| f32::from(*c) * f).sum::<f32>()
        })
    }

    /// RGB, as [`LpcaDecoder::encoding`] says, of a texel of a level between the nodes around `taps`.
    ///
    /// # Panics
    ///
    /// If there is no such level or texel.
    pub fn texel(&self, level: usize, texel: usize, taps: &Taps) -> [f32; 3] {
        let mut factors = [0.0; MAX_VECTORS];
        let (cluster, constant) = self.factors(level, texel, &mut factors);
        let mut sum = [0.0; 3];
        for (node, weight) in taps.nodes(&self.header.grid) {
            let value = self.node(cluster, node, &factors, constant);
            sum.iter_mut().zip(value).for_each(|(s, v)| *s += weight * v);
        }
        self.rgb(sum)
    }

    fn rgb(&self, [y, a, b]: [f32; 3]) -> [f32; 3] {
        match self.header.encoding {
            Encoding::Srgb => from_luma_chroma(Encoding::Srgb, [y.max(0.0), a, b]),
            Encoding::Linear if y > 0.0 => from_luma_chroma(Encoding::Linear, [y, a / y, b / y]),
            Encoding::Linear => [0.0; 3],
        }
    }

    /// A whole level for one pair of directions: bases are interpolated once.
    ///
    /// # Panics
    ///
    /// If there is no such level or `out` is of another size.
    pub fn image(&self, level: usize, taps: &Taps, out: &mut [[f32; 3]]) {
        let (width, height, _) = self.levels[level];
        assert_eq!(out.len(), width * height, "a value for each texel");
        let vectors = self.header.components + 1;
        let nodes = taps.nodes(&self.header.grid);
        let mut basis = vec![0.0; self.header.clusters * 3 * vectors];
        for (cluster, target) in basis.chunks_exact_mut(3 * vectors).enumerate() {
            for (node, weight) in nodes {
                let at = (cluster * self.header.grid.node_count() + node) * 3 * vectors;
                let codes = &self.basis[at..at + 3 * vectors];
                target.iter_mut().zip(codes).for_each(|(t, c)| *t += weight * f32::from(*c));
            }
        }
        let mut factors = [0.0; MAX_VECTORS];
        for (texel, value) in out.iter_mut().enumerate() {
            let (cluster, constant) = self.factors(level, texel, &mut factors);
            let rows = &basis[cluster * 3 * vectors..][..3 * vectors];
            *value = self.rgb(std::array::from_fn(|channel| {
                let row = &rows[channel * vectors..][..vectors];
                constant + row.iter().zip(&factors).map(|(c, f)| c * f).sum::<f32>()
            }));
        }
    }

    /// Luminance of a texel at all light nodes of a view of the grid, `[alpha][beta]`, at least 0.
    ///
    /// # Panics
    ///
    /// If there is no such level, texel or view, or `out` is shorter.
    pub fn view_luminance(&self, level: usize, texel: usize, view: usize, out: &mut [f32]) {
        let mut factors = [0.0; MAX_VECTORS];
        let (cluster, constant) = self.factors(level, texel, &mut factors);
        let slice = self.header.grid.slice_len();
        for (offset, value) in out[..slice].iter_mut().enumerate() {
            let node = view * slice + offset;
            *value = self.node(cluster, node, &factors, constant)[0].max(0.0);
        }
    }
}
