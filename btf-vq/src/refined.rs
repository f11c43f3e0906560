//! Books beyond the paper's: codes are centres of clusters at every level instead of texels that came
//! first, each level is clustered in the metric of the images, and rows are built from the bottom up
//! against what the levels below really hold.

use faer::MatRef;
use rayon::prelude::*;

use crate::cluster::{Clusters, cluster_shapes, cluster_values};
use crate::nearest::{CodeSet, Match, dot};
use crate::subspace::{Subspace, energies};
use crate::survey::{Survey, channel_weights};
use crate::{AngularGrid, Books, Chroma};

/// Rows of the books that are chosen; M has a row for each pair that occurs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names are those of the books")]
pub struct BookSizes {
    pub p4: usize,
    pub p3: usize,
    pub p2: usize,
    pub p1: usize,
    pub i2: usize,
    pub i1: usize,
    pub c: usize,
}

/// Sum of squared errors, in the metric of the survey, that each level adds.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct LevelErrors {
    /// Of choosing among P4.
    pub p4: f64,
    /// Of choosing among P3.
    pub p3: f64,
    /// Of choosing among P2.
    pub p2: f64,
    /// Of choosing among P1.
    pub p1: f64,
    /// Of choosing among I2.
    pub i2: f64,
    /// After all, of all texels, with scales not yet quantised.
    pub total: f64,
}

/// Books and a row of P6 for each texel of a survey.
#[derive(Clone, Debug)]
pub struct Encoded {
    /// The books.
    pub books: Books,
    /// Row of P4 of each texel.
    pub index: Vec<u32>,
    /// Its scale.
    pub scale: Vec<f32>,
    /// What was lost.
    pub errors: LevelErrors,
}

/// Iterations at every level: a tradeoff of time, of which they take most.
const ITERATIONS: usize = 5;
/// Dimensions in which 3D slices are compared.
const SLICE_DIMS: usize = 48;
/// Dimensions in which the luminance of 2D slices is compared.
const SLICE2_DIMS: usize = 32;
/// Slices that these dimensions are found on.
const SLICE_SAMPLE: usize = 1536;
/// Codes that are expanded together.
const CHUNK: usize = 64;

/// Builds books of these sizes for a survey.
pub fn encode_refined(survey: &Survey, sizes: &BookSizes) -> Encoded {
    let metric = Metric::of(survey);
    let dims = survey.space.dims;
    let texel_weights = survey.texel_weights();
    let texels = cluster_shapes(&survey.coefficients, dims, &texel_weights, sizes.p4, ITERATIONS);
    let mut errors = LevelErrors { p4: texels.distortion, ..LevelErrors::default() };
    let usage4 = usage(&texels, &texel_weights);

    let slices = ThreeD::cluster(survey, &metric, &texels.codes, &usage4, sizes.p3);
    errors.p3 = slices.clusters.distortion;
    let two = TwoD::cluster(survey, &metric, &slices, sizes, &mut errors);

    let mut books = Books::new(survey.grid, survey.encoding, Chroma::Relative);
    two.build(&mut books);
    slices.build(&metric, &two, &mut books);
    choose_p3(survey, &metric, &texels.codes, &slices.space, &mut books);
    let matches = choose_p4(survey, &books);
    let left = survey.energies.iter().zip(&matches).zip(&texel_weights);
    errors.total = left.map(|((e, m), w)| f64::from(w * (e - m.score))).sum();
    let (index, scale) = matches.iter().map(|m| (narrow(m.code), m.gain)).unzip();
    Encoded { books, index, scale, errors }
}

fn narrow(index: usize) -> u32 {
    u32::try_from(index).unwrap_or(u32::MAX)
}

/// Weighted energy that each code stands for.
fn usage(clusters: &Clusters, weights: &[f32]) -> Vec<f32> {
    let mut usage = vec![0.0; clusters.count];
    for ((code, gain), weight) in clusters.assignment.iter().zip(&clusters.gains).zip(weights) {
        usage[*code as usize] += weight * gain * gain;
    }
    usage
}

/// Weights of parts of a texel, the same for all of a kind: means over the parts that are shared.
struct Metric {
    grid: AngularGrid,
    channels: [f32; 3],
    /// Roots, `[channel][theta][alpha][beta]`.
    root3: Vec<f32>,
    /// `[theta]`: how much a view counts against the mean.
    view: Vec<f32>,
    /// `[alpha][beta]`, of mean 1 over views.
    light: Vec<f32>,
}

impl Metric {
    #[expect(clippy::cast_precision_loss, reason = "grids are small")]
    fn of(survey: &Survey) -> Self {
        let grid = survey.grid;
        let (nodes, slice) = (grid.node_count(), grid.slice_len());
        let channels = channel_weights(survey.encoding);
        let luma = survey.root_weights[..nodes].iter().map(|r| r * r / channels[0]);
        let mut three = vec![0.0_f32; grid.thetas * slice];
        for (at, weight) in luma.enumerate() {
            three[at % (grid.thetas * slice)] += weight / grid.phis as f32;
        }
        let root3 = channels.iter().flat_map(|c| three.iter().map(move |w| (c * w).sqrt()));
        let root3 = root3.collect();
        let view: Vec<f32> =
            three.chunks_exact(slice).map(|v| v.iter().sum::<f32>() / slice as f32).collect();
        let mut light = vec![0.0_f32; slice];
        let total: f32 = view.iter().sum();
        for (at, weight) in three.iter().enumerate() {
            light[at % slice] += weight / total;
        }
        Self { grid, channels, root3, view, light }
    }

    /// Values of a 3D slice in one channel and view.
    fn view_values<'a>(&self, slice3: &'a [f32], channel: usize, theta: usize) -> &'a [f32] {
        let slice = self.grid.slice_len();
        &slice3[(channel * self.grid.thetas + theta) * slice..][..slice]
    }
}

/// 3D slices: one azimuth of the view, `[channel][theta][alpha][beta]`.
struct ThreeD {
    space: Subspace,
    clusters: Clusters,
    /// Centres as values, with the length that they have in the metric as a scale.
    centres: Vec<f32>,
    usage: Vec<f32>,
}

impl ThreeD {
    fn cluster(
        survey: &Survey,
        metric: &Metric,
        codes: &[f32],
        usage4: &[f32],
        count: usize,
    ) -> Self {
        let grid = survey.grid;
        let len = metric.root3.len();
        let texels = codes.len() / survey.space.dims;
        let wanted = SLICE_SAMPLE / grid.phis + 1;
        let step = texels.div_ceil(wanted).max(1);
        let chosen: Vec<f32> = (0..texels)
            .step_by(step)
            .flat_map(|at| codes[at * survey.space.dims..][..survey.space.dims].to_vec())
            .collect();
        let sample: Vec<f32> =
            (0..grid.phis).flat_map(|phi| slices_of(survey, metric, &chosen, phi)).collect();
        let space = Subspace::of(&sample, len, SLICE_DIMS);
        let (mut coefficients, mut weights) = (Vec::new(), Vec::new());
        for phi in 0..grid.phis {
            for block in codes.chunks(CHUNK * 16 * survey.space.dims) {
                coefficients.extend(space.project(&slices_of(survey, metric, block, phi)));
            }
            weights.extend_from_slice(usage4);
        }
        let clusters = cluster_shapes(&coefficients, space.dims, &weights, count, ITERATIONS);
        let mut centres = space.lift(&clusters.codes);
        for centre in centres.chunks_exact_mut(len) {
            centre.iter_mut().zip(&metric.root3).for_each(|(v, r)| *v /= r);
            let luma = len / 3;
            centre[..luma].iter_mut().for_each(|v| *v = v.max(0.0));
        }
        let usage = usage(&clusters, &weights);
        Self { space, clusters, centres, usage }
    }

    /// Rows of P3: a row of M and a scale for each view.
    fn build(&self, metric: &Metric, two: &TwoD, books: &mut Books) {
        let (grid, slice) = (metric.grid, metric.grid.slice_len());
        let pairs: Vec<[u32; 2]> =
            two.luma.assignment.iter().zip(&two.chroma.assignment).map(|(p, i)| [*p, *i]).collect();
        let mut merged = pairs.clone();
        merged.sort_unstable();
        merged.dedup();
        books.m.index = merged.concat();
        let expanded: Vec<f32> = (0..merged.len())
            .into_par_iter()
            .flat_map_iter(|m| {
                let mut values = vec![0.0; 3 * slice];
                books.expand_m(m, &mut values);
                values
            })
            .collect();
        for (at, pair) in pairs.iter().enumerate() {
            let m = merged.binary_search(pair).unwrap_or(0);
            let (centre, theta) = (at / grid.thetas, at % grid.thetas);
            let centre = &self.centres[centre * 3 * grid.thetas * slice..];
            let rebuilt = &expanded[m * 3 * slice..][..3 * slice];
            let (mut product, mut square) = (0.0, 0.0);
            for channel in 0..3 {
                let wanted = metric.view_values(centre, channel, theta);
                for ((r, v), w) in rebuilt[channel * slice..].iter().zip(wanted).zip(&metric.light)
                {
                    product += metric.channels[channel] * w * r * v;
                    square += metric.channels[channel] * w * r * r;
                }
            }
            books.p3.index.push(narrow(m));
            books.p3.scale.push(if square > 0.0 { (product / square).max(0.0) } else { 0.0 });
        }
    }
}

/// One azimuth of texels given by coefficients of the survey, weighted: `[texel][channel][theta]…`.
fn slices_of(survey: &Survey, metric: &Metric, coefficients: &[f32], phi: usize) -> Vec<f32> {
    let (grid, nodes) = (survey.grid, survey.grid.node_count());
    let part = grid.thetas * grid.slice_len();
    let basis: Vec<f32> = survey
        .space
        .basis
        .chunks_exact(3 * nodes)
        .flat_map(|row| {
            (0..3).flat_map(move |channel| row[channel * nodes + phi * part..][..part].iter())
        })
        .copied()
        .collect();
    let matrix = MatRef::from_row_major_slice(&basis, survey.space.dims, 3 * part);
    let mut slices = crate::subspace::products(coefficients, survey.space.dims, matrix);
    slices.par_chunks_exact_mut(3 * part).for_each(|slice| {
        for channel in 0..3 {
            let roots = &survey.root_weights[channel * nodes + phi * part..][..part];
            let target = &metric.root3[channel * part..][..part];
            for ((v, own), shared) in slice[channel * part..].iter_mut().zip(roots).zip(target) {
                *v *= shared / own;
            }
        }
    });
    slices
}

/// 2D slices: luminance and chrominance over the lights of one view.
struct TwoD {
    luma: Clusters,
    chroma: Clusters,
    slices1: Clusters,
    colours1: Clusters,
    colours: Clusters,
    metric1: Vec<f32>,
    metric2: Vec<f32>,
}

impl TwoD {
    fn cluster(
        survey: &Survey,
        metric: &Metric,
        three: &ThreeD,
        sizes: &BookSizes,
        errors: &mut LevelErrors,
    ) -> Self {
        let (grid, slice) = (survey.grid, survey.grid.slice_len());
        let part = 3 * grid.thetas * slice;
        let root2: Vec<f32> = metric.light.iter().map(|w| w.sqrt()).collect();
        let views = || {
            three.centres.chunks_exact(part).zip(&three.usage).flat_map(|(centre, usage)| {
                (0..grid.thetas).map(move |theta| (centre, theta, usage * metric.view[theta]))
            })
        };
        let luma: Vec<f32> = views()
            .flat_map(|(centre, theta, _)| metric.view_values(centre, 0, theta))
            .zip(root2.iter().cycle())
            .map(|(v, r)| v * r)
            .collect();
        let weights: Vec<f32> = views().map(|v| v.2 * metric.channels[0]).collect();
        let step = (weights.len() / SLICE_SAMPLE).max(1);
        let sample: Vec<f32> = luma.chunks_exact(slice).step_by(step).flatten().copied().collect();
        let space = Subspace::of(&sample, slice, SLICE2_DIMS);
        let short = space.project(&luma);
        let mut luma = cluster_shapes(&short, space.dims, &weights, sizes.p2, ITERATIONS);
        luma.codes = space.lift(&luma.codes);
        errors.p2 = luma.distortion;
        let (ratios, ratio_weights) = chroma_ratios(metric, views());
        let (chroma, totals2) =
            cluster_values(&ratios, 2 * slice, &ratio_weights, sizes.i2, ITERATIONS);
        errors.i2 = chroma.distortion;

        let (root1, slices1, usage2) = one_d_luma(grid, metric, &luma, &weights);
        let slices1 = cluster_shapes(&slices1, grid.betas, &usage2, sizes.p1, ITERATIONS);
        errors.p1 = slices1.distortion;
        let colour_rows = by_alpha(grid, &chroma.codes);
        let (colours1, totals1) = cluster_values(
            &colour_rows,
            2 * grid.betas,
            &by_alpha(grid, &totals2),
            sizes.i1,
            ITERATIONS,
        );
        let (colours, _) = cluster_values(
            &by_node(grid, &colours1.codes),
            2,
            &by_node(grid, &totals1),
            sizes.c,
            2 * ITERATIONS,
        );
        Self { luma, chroma, slices1, colours1, colours, metric1: root1, metric2: root2 }
    }

    /// P1, P2, C, I1 and I2.
    fn build(&self, books: &mut Books) {
        let grid = books.grid;
        books.p1.values = self
            .slices1
            .codes
            .iter()
            .zip(self.metric1.iter().cycle())
            .map(|(v, r)| (v / r).max(0.0))
            .collect();
        books.c.values.clone_from(&self.colours.codes);
        books.i1.index.clone_from(&self.colours.assignment);
        books.i2.index.clone_from(&self.colours1.assignment);
        books.p2.index.clone_from(&self.slices1.assignment);
        for (row, index) in books.p2.index.iter().enumerate() {
            let alpha = row % grid.alphas;
            let wanted = &self.luma.codes[row * grid.betas..][..grid.betas];
            let roots = &self.metric2[alpha * grid.betas..][..grid.betas];
            let rebuilt = books.p1.row(*index as usize);
            let (mut product, mut square) = (0.0, 0.0);
            for ((v, r), p) in wanted.iter().zip(roots).zip(rebuilt) {
                product += v * r * p;
                square += r * r * p * p;
            }
            books.p2.scale.push(if square > 0.0 { (product / square).max(0.0) } else { 0.0 });
        }
    }
}

/// Chrominance over luminance of 2D slices, `[slice][channel][node]`, and what each counts.
fn chroma_ratios<'a>(
    metric: &Metric,
    views: impl Iterator<Item = (&'a [f32], usize, f32)>,
) -> (Vec<f32>, Vec<f32>) {
    let (mut ratios, mut weights) = (Vec::new(), Vec::new());
    for (centre, theta, usage) in views {
        let luma = metric.view_values(centre, 0, theta);
        for channel in 1..3 {
            let chroma = metric.view_values(centre, channel, theta);
            let values = chroma.iter().zip(luma).zip(&metric.light);
            for ((c, y), w) in values {
                let y = y.max(1e-6);
                ratios.push((c / y).clamp(-4.0, 4.0));
                weights.push(usage * metric.channels[channel] * w * y * y);
            }
        }
    }
    (ratios, weights)
}

/// 1D slices of the centres of P2 in a metric that does not depend on α.
fn one_d_luma(
    grid: AngularGrid,
    metric: &Metric,
    luma: &Clusters,
    weights: &[f32],
) -> (Vec<f32>, Vec<f32>, Vec<f32>) {
    let (alphas, betas) = (grid.alphas, grid.betas);
    let mut along = vec![0.0_f32; betas];
    let mut across = vec![0.0_f32; alphas];
    for (at, w) in metric.light.iter().enumerate() {
        across[at / betas] += w;
        along[at % betas] += w;
    }
    let total: f32 = across.iter().sum();
    let root1: Vec<f32> = along.iter().map(|w| (w / total * across_mean(&across)).sqrt()).collect();
    let usage2 = usage(luma, weights);
    let mut slices = Vec::with_capacity(luma.codes.len());
    let mut usages = Vec::new();
    for (row, slice) in luma.codes.chunks_exact(betas).enumerate() {
        let (code, alpha) = (row / alphas, row % alphas);
        for (beta, v) in slice.iter().enumerate() {
            let own = metric.light[alpha * betas + beta].sqrt();
            slices.push((v / own).max(0.0) * root1[beta]);
        }
        usages.push(usage2[code] * across[alpha] / across_mean(&across));
    }
    (root1, slices, usages)
}

#[expect(clippy::cast_precision_loss, reason = "grids are small")]
fn across_mean(across: &[f32]) -> f32 {
    across.iter().sum::<f32>() / across.len() as f32
}

/// `[code][channel][alpha][beta]` as `[code][alpha][channel][beta]`.
fn by_alpha(grid: AngularGrid, values: &[f32]) -> Vec<f32> {
    let (alphas, betas) = (grid.alphas, grid.betas);
    let codes = values.chunks_exact(2 * alphas * betas);
    codes
        .flat_map(|code| {
            (0..alphas).flat_map(move |alpha| {
                (0..2).flat_map(move |channel| {
                    code[(channel * alphas + alpha) * betas..][..betas].iter()
                })
            })
        })
        .copied()
        .collect()
}

/// `[code][channel][beta]` as `[code][beta][channel]`.
fn by_node(grid: AngularGrid, values: &[f32]) -> Vec<f32> {
    let betas = grid.betas;
    values
        .chunks_exact(2 * betas)
        .flat_map(|code| (0..betas).flat_map(move |beta| [code[beta], code[betas + beta]]))
        .collect()
}

/// Rows of P4: for each azimuth of each centre the row of P3, as it really is, that fits best.
fn choose_p3(survey: &Survey, metric: &Metric, codes: &[f32], space: &Subspace, books: &mut Books) {
    let phis = survey.grid.phis;
    let rows = books.p3.rows();
    let expand = |row: usize, out: &mut [f32]| books.expand_p3(row, out);
    let (set, lengths) = code_set(space, rows, &metric.root3, &expand);
    let texels = codes.len() / survey.space.dims;
    let mut index = vec![0; texels * phis];
    let mut scale = vec![0.0; texels * phis];
    for phi in 0..phis {
        let wanted = with_rest(&space.project(&slices_of(survey, metric, codes, phi)), space.dims);
        for (texel, found) in set.nearest(&wanted, &[]).iter().enumerate() {
            index[texel * phis + phi] = narrow(found.code);
            let length = lengths[found.code];
            scale[texel * phis + phi] = if length > 0.0 { found.gain / length } else { 0.0 };
        }
    }
    books.p4.index = index;
    books.p4.scale = scale;
}

/// The best row of P4, as it really is, for each texel, with the scale for it as gain.
fn choose_p4(survey: &Survey, books: &Books) -> Vec<Match> {
    let expand = |row: usize, out: &mut [f32]| books.expand_p4(row, out);
    let (set, lengths) = code_set(&survey.space, books.p4.rows(), &survey.root_weights, &expand);
    let wanted = with_rest(&survey.coefficients, survey.space.dims);
    let mut matches = set.nearest(&wanted, &[]);
    for found in &mut matches {
        let length = lengths[found.code];
        found.gain = if length > 0.0 { found.gain / length } else { 0.0 };
    }
    matches
}

/// Rows of a book as codes in a subspace, with one more coordinate for what lies outside, so that
/// they keep their lengths; and these lengths.
fn code_set(
    space: &Subspace,
    rows: usize,
    root_weights: &[f32],
    expand: &(dyn Fn(usize, &mut [f32]) + Sync),
) -> (CodeSet, Vec<f32>) {
    let chunks: Vec<(Vec<f32>, Vec<f32>)> = (0..rows.div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let rows = chunk * CHUNK..rows.min((chunk + 1) * CHUNK);
            let mut values = vec![0.0; rows.len() * space.len];
            for (row, out) in rows.clone().zip(values.chunks_exact_mut(space.len)) {
                expand(row, out);
                out.iter_mut().zip(root_weights).for_each(|(v, r)| *v *= r);
            }
            let mut projected = vec![0.0; rows.len() * space.dims];
            space.project_block(&values, &mut projected);
            (projected, energies(&values, space.len))
        })
        .collect();
    let mut set = CodeSet::new(space.dims + 1, 0);
    let mut lengths = Vec::with_capacity(rows);
    for (projected, energies) in chunks {
        for (row, energy) in projected.chunks_exact(space.dims).zip(energies) {
            let outside = (energy - dot(row, row)).max(0.0).sqrt();
            let full: Vec<f32> = row.iter().copied().chain([outside]).collect();
            lengths.push(set.push(&full, &[]));
        }
    }
    (set, lengths)
}

/// Vectors of a subspace with the coordinate for what lies outside, 0.
fn with_rest(coefficients: &[f32], dims: usize) -> Vec<f32> {
    coefficients.chunks_exact(dims).flat_map(|v| v.iter().copied().chain([0.0])).collect()
}
