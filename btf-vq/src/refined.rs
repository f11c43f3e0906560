//! Codebooks beyond the paper's: codes are centres of clusters at every level instead of texels that came
//! first, each level is clustered in the metric of the images, and rows are built from the bottom up
//! against what the levels below really hold.

use std::collections::BTreeMap;
use std::ops::Range;

use brdf_job::Job;
use faer::MatRef;
use rayon::prelude::*;

use crate::cluster::{Clusters, cluster_shapes, cluster_values};
use crate::error::VqError;
use crate::nearest::{CodeSet, Match, dot};
use crate::projected_texels::{ProjectedTexels, channel_weights};
use crate::subspace::{Subspace, energies};
use crate::{AngularGrid, Chroma, Codebooks};

/// Numbers of rows of the books that are chosen. M is not among them: it has a row for each pair that occurs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names are those of the books")]
pub struct CodebookSizes {
    pub p4: usize,
    pub p3: usize,
    pub p2: usize,
    pub p1: usize,
    pub i2: usize,
    pub i1: usize,
    pub c: usize,
}

/// Sums of squared errors, in the metric of the survey, that each level of the books adds.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct LevelErrors {
    /// Error of choosing among P4.
    pub p4: f64,
    /// Error of choosing among P3.
    pub p3: f64,
    /// Error of choosing among P2.
    pub p2: f64,
    /// Error of choosing among P1.
    pub p1: f64,
    /// Error of choosing among I2.
    pub i2: f64,
    /// Error after all, of all texels, with scales not yet quantized.
    pub total: f64,
}

/// The result of [`encode_refined`]: codebooks, and a row of P6 for each texel of a survey.
#[derive(Clone, Debug)]
pub struct Encoded {
    /// The books.
    pub books: Codebooks,
    /// Row of P4 of each texel.
    pub index: Vec<u32>,
    /// Scale of each texel.
    pub scale: Vec<f32>,
    /// Errors that each level added.
    pub errors: LevelErrors,
}

/// Iterations at every level: a tradeoff of time, of which they take most.
const ITERATIONS: usize = 4;
/// Dimensions in which 3D slices of one texture are compared; each further one brings half as many
/// again. All of them where there are few slices.
const SLICE_DIMS: usize = 48;
const FEW_SLICES: usize = 128;
/// Slices that these dimensions are found on.
const SLICE_SAMPLE: usize = 1536;
/// Codes that are expanded together.
const CHUNK: usize = 64;

/// Adds rows, of these numbers, to books so that they hold the textures of some surveys.
///
/// Rows that the books have serve where they fit and stay as they are. The new rows index old and new ones alike.
/// Textures have rows of P4 of their own, in proportion to their texels, and share all books below, so that time
/// grows with the number of textures and not with its square.
///
/// # Errors
///
/// [`VqError::Stopped`].
///
/// # Panics
///
/// If there are no surveys, or the books are of another grid or encoding, or hold chrominance itself.
pub fn encode_refined(
    surveys: &[ProjectedTexels],
    sizes: &CodebookSizes,
    mut books: Codebooks,
    job: &Job<'_>,
) -> Result<Encoded, VqError> {
    job.begin("clustering texels", 4);
    for survey in surveys {
        assert!(
            (books.grid, books.encoding, books.chroma)
                == (survey.grid, survey.encoding, Chroma::Relative),
            "books of the surveys' kind"
        );
    }
    let metric = Metric::of(surveys);
    let texels: usize = surveys.iter().map(ProjectedTexels::texels).sum();
    let exemplars: Vec<Exemplars<'_>> = surveys
        .iter()
        .map(|survey| {
            job.check()?;
            let count = (sizes.p4 * survey.texels()).div_ceil(texels.max(1));
            Ok(Exemplars::find(survey, count, &books))
        })
        .collect::<Result<_, VqError>>()?;
    job.advance(1);
    job.rename("clustering slices");
    let p4 = exemplars.iter().map(|e| e.distortion).sum();
    let mut errors = LevelErrors { p4, ..LevelErrors::default() };
    let slices = ThreeD::cluster(&exemplars, &metric, sizes.p3, &books);
    job.check()?;
    job.advance(1);
    errors.p3 = slices.distortion;
    let two = TwoD::cluster(&metric, &slices, sizes, &books, &mut errors);

    job.check()?;
    job.advance(1);
    job.rename("building codebooks");
    two.build(&mut books);
    slices.build(&metric, &two, &mut books);
    let old = books.p4.rows();
    choose_p3(&exemplars, &metric, &slices.space, &mut books);
    let (mut index, mut scale) = (Vec::new(), Vec::new());
    let mut own = old..old;
    for exemplars in &exemplars {
        own = own.end..own.end + exemplars.len();
        let survey = exemplars.survey;
        let matches = choose_p4(survey, old, own.clone(), &books);
        let left = survey.energies.iter().zip(&matches).zip(survey.texel_weights());
        errors.total += left.map(|((e, m), w)| f64::from(w * (e - m.score))).sum::<f64>();
        index.extend(matches.iter().map(|m| narrow(m.code)));
        scale.extend(matches.iter().map(|m| m.gain));
    }
    job.advance(1);
    Ok(Encoded { books, index, scale, errors })
}

/// Centres of the texels of a survey, which will have rows of P4.
struct Exemplars<'a> {
    survey: &'a ProjectedTexels,
    /// `[centre][dim]`.
    codes: Vec<f32>,
    /// Weighted energy that each stands for.
    usage: Vec<f32>,
    distortion: f64,
}

impl<'a> Exemplars<'a> {
    fn find(survey: &'a ProjectedTexels, count: usize, books: &Codebooks) -> Self {
        let (dims, weights) = (survey.space.dims, survey.texel_weights());
        let expand = |row: usize, out: &mut [f32]| books.expand_p4(row, out);
        let old = rows_in(&survey.space, 0..books.p4.rows(), &survey.root_weights, &expand);
        let clusters = cluster_in(dims, &survey.coefficients, &weights, &old, count);
        let usage = usage(&clusters, dims, &weights);
        Self { survey, codes: clusters.codes, usage, distortion: clusters.distortion }
    }

    fn len(&self) -> usize {
        self.usage.len()
    }

    /// Coefficients of some that lie evenly.
    fn every(&self, step: usize) -> Vec<f32> {
        self.codes.chunks_exact(self.survey.space.dims).step_by(step).flatten().copied().collect()
    }
}

fn narrow(index: usize) -> u32 {
    u32::try_from(index).unwrap_or(u32::MAX)
}

/// Codes for vectors of a subspace beside old rows, which have one more coordinate ([`rows_in`]).
fn cluster_in(
    dims: usize,
    coefficients: &[f32],
    weights: &[f32],
    old: &[f32],
    count: usize,
) -> Clusters {
    if old.is_empty() {
        return cluster_shapes(coefficients, dims, weights, old, count, ITERATIONS);
    }
    let vectors = with_rest(coefficients, dims);
    let mut clusters = cluster_shapes(&vectors, dims + 1, weights, old, count, ITERATIONS);
    let inside = clusters.codes.chunks_exact(dims + 1).flat_map(|code| &code[..dims]);
    clusters.codes = inside.copied().collect();
    clusters
}

/// Weighted energy that each code found stands for.
fn usage(clusters: &Clusters, len: usize, weights: &[f32]) -> Vec<f32> {
    let mut usage = vec![0.0; clusters.codes.len() / len];
    for ((code, gain), weight) in clusters.assignment.iter().zip(&clusters.gains).zip(weights) {
        if let Some(found) = (*code as usize).checked_sub(clusters.fixed) {
            usage[found] += weight * gain * gain;
        }
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
    fn of(surveys: &[ProjectedTexels]) -> Self {
        let (grid, encoding) = (surveys[0].grid, surveys[0].encoding);
        let (nodes, slice) = (grid.node_count(), grid.slice_len());
        let channels = channel_weights(encoding);
        let mut three = vec![0.0_f32; grid.thetas * slice];
        let share = (surveys.len() * grid.phis) as f32;
        for survey in surveys {
            for (at, root) in survey.root_weights[..nodes].iter().enumerate() {
                three[at % (grid.thetas * slice)] += root * root / channels[0] / share;
            }
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
    distortion: f64,
    /// Centres found, as values, with the length that they have in the metric as a scale.
    centres: Vec<f32>,
    usage: Vec<f32>,
}

impl ThreeD {
    fn cluster(
        exemplars: &[Exemplars<'_>],
        metric: &Metric,
        count: usize,
        books: &Codebooks,
    ) -> Self {
        let (phis, len) = (metric.grid.phis, metric.root3.len());
        let rows: usize = exemplars.iter().map(Exemplars::len).sum();
        let step = rows.div_ceil(SLICE_SAMPLE / phis + 1).max(1);
        let mut sample = Vec::new();
        for exemplars in exemplars {
            let chosen = exemplars.every(step);
            for phi in 0..phis {
                sample.extend(slices_of(exemplars.survey, metric, &chosen, phi));
            }
        }
        let few = rows * phis <= FEW_SLICES;
        let dims = if few { FEW_SLICES } else { SLICE_DIMS * (1 + exemplars.len()) / 2 };
        let space = Subspace::of(&sample, len, dims);
        let (mut coefficients, mut weights) = (Vec::new(), Vec::new());
        for Exemplars { survey, codes, usage, .. } in exemplars {
            for phi in 0..phis {
                for block in codes.chunks(CHUNK * 16 * survey.space.dims) {
                    coefficients.extend(space.project(&slices_of(survey, metric, block, phi)));
                }
                weights.extend_from_slice(usage);
            }
        }
        let old = rows_in(&space, 0..books.p3.rows(), &metric.root3, &|row, out| {
            books.expand_p3(row, out);
        });
        let clusters = cluster_in(space.dims, &coefficients, &weights, &old, count);
        let mut centres = space.lift(&clusters.codes);
        for centre in centres.chunks_exact_mut(len) {
            centre.iter_mut().zip(&metric.root3).for_each(|(v, r)| *v /= r);
            let luma = len / 3;
            centre[..luma].iter_mut().for_each(|v| *v = v.max(0.0));
        }
        let usage = usage(&clusters, space.dims, &weights);
        Self { space, distortion: clusters.distortion, centres, usage }
    }

    /// Rows of P3: a row of M and a scale for each view.
    fn build(&self, metric: &Metric, two: &TwoD, books: &mut Codebooks) {
        let (grid, slice) = (metric.grid, metric.grid.slice_len());
        let pairs: Vec<[u32; 2]> =
            two.luma.assignment.iter().zip(&two.chroma.assignment).map(|(p, i)| [*p, *i]).collect();
        let old: Vec<[u32; 2]> = books.m.index.as_chunks().0.to_vec();
        let mut merged: BTreeMap<[u32; 2], usize> = BTreeMap::new();
        for (row, pair) in old.iter().enumerate() {
            merged.entry(*pair).or_insert(row);
        }
        let mut fresh: Vec<[u32; 2]> =
            pairs.iter().filter(|pair| !merged.contains_key(*pair)).copied().collect();
        fresh.sort_unstable();
        fresh.dedup();
        merged.extend(fresh.iter().copied().zip(old.len()..));
        books.m.index.extend(fresh.as_flattened());
        let expanded: Vec<f32> = (0..books.m.rows())
            .into_par_iter()
            .flat_map_iter(|m| {
                let mut values = vec![0.0; 3 * slice];
                books.expand_m(m, &mut values);
                values
            })
            .collect();
        for (at, pair) in pairs.iter().enumerate() {
            let m = merged[pair];
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
fn slices_of(
    survey: &ProjectedTexels,
    metric: &Metric,
    coefficients: &[f32],
    phi: usize,
) -> Vec<f32> {
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
        metric: &Metric,
        three: &ThreeD,
        sizes: &CodebookSizes,
        books: &Codebooks,
        errors: &mut LevelErrors,
    ) -> Self {
        let (grid, slice) = (metric.grid, metric.grid.slice_len());
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
        let luma = luma_slices(&luma, &root2, &weights, sizes.p2, books);
        errors.p2 = luma.distortion;
        let (ratios, ratio_weights) = chroma_ratios(metric, views());
        let old = rows_of(books.i2.rows(), 2 * slice, |row, out| {
            let (first, second) = out.split_at_mut(slice);
            books.expand_i2(row, 0, first);
            books.expand_i2(row, 1, second);
        });
        let (chroma, totals2) =
            cluster_values(&ratios, 2 * slice, &ratio_weights, &old, sizes.i2, ITERATIONS);
        errors.i2 = chroma.distortion;

        let (root1, slices1, usage2) = one_d_luma(grid, metric, &luma, &weights);
        let old: Vec<f32> =
            books.p1.values.iter().zip(root1.iter().cycle()).map(|(v, r)| v * r).collect();
        let slices1 = cluster_shapes(&slices1, grid.betas, &usage2, &old, sizes.p1, ITERATIONS);
        errors.p1 = slices1.distortion;
        let colour_rows = by_alpha(grid, &chroma.codes);
        let old = rows_of(books.i1.rows(), 2 * grid.betas, |row, out| books.expand_i1(row, out));
        let (colours1, totals1) = cluster_values(
            &colour_rows,
            2 * grid.betas,
            &by_alpha(grid, &totals2),
            &old,
            sizes.i1,
            ITERATIONS,
        );
        let (colours, _) = cluster_values(
            &by_node(grid, &colours1.codes),
            2,
            &by_node(grid, &totals1),
            &books.c.values,
            sizes.c,
            2 * ITERATIONS,
        );
        Self { luma, chroma, slices1, colours1, colours, metric1: root1, metric2: root2 }
    }

    /// P1, P2, C, I1 and I2.
    fn build(&self, books: &mut Codebooks) {
        let grid = books.grid;
        let values = self.slices1.codes.iter().zip(self.metric1.iter().cycle());
        books.p1.values.extend(values.map(|(v, r)| (v / r).max(0.0)));
        books.c.values.extend(&self.colours.codes);
        books.i1.index.extend(&self.colours.assignment);
        books.i2.index.extend(&self.colours1.assignment);
        books.p2.index.extend(&self.slices1.assignment);
        for (row, index) in self.slices1.assignment.iter().enumerate() {
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

/// Codes for the luminance of 2D slices, weighted; found in a subspace unless each slice is a code.
fn luma_slices(
    slices: &[f32],
    root2: &[f32],
    weights: &[f32],
    count: usize,
    books: &Codebooks,
) -> Clusters {
    let len = root2.len();
    if count >= weights.len() {
        let old = rows_of(books.p2.rows(), len, |row, out| {
            books.expand_p2(row, out);
            out.iter_mut().zip(root2).for_each(|(v, r)| *v *= r);
        });
        return cluster_shapes(slices, len, weights, &old, count, 0);
    }
    // A quarter of the nodes hold a slice of 11 × 11; finer ones are smooth.
    let dims = (len / 4).clamp(1, 128);
    let step = (weights.len() / SLICE_SAMPLE).max(1);
    let sample: Vec<f32> = slices.chunks_exact(len).step_by(step).flatten().copied().collect();
    let space = Subspace::of(&sample, len, dims);
    let old = rows_in(&space, 0..books.p2.rows(), root2, &|row, out| books.expand_p2(row, out));
    let mut luma = cluster_in(space.dims, &space.project(slices), weights, &old, count);
    luma.codes = space.lift(&luma.codes);
    luma
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
    let usage2 = usage(luma, alphas * betas, weights);
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

/// New rows of P4: for each azimuth of each centre the row of P3, as it really is, that fits best.
fn choose_p3(
    exemplars: &[Exemplars<'_>],
    metric: &Metric,
    space: &Subspace,
    books: &mut Codebooks,
) {
    let phis = metric.grid.phis;
    let expand = |row: usize, out: &mut [f32]| books.expand_p3(row, out);
    let rows = rows_in(space, 0..books.p3.rows(), &metric.root3, &expand);
    let (set, lengths) = code_set(&rows, space.dims);
    for exemplars in exemplars {
        let count = exemplars.len() * phis;
        let (mut index, mut scale) = (vec![0; count], vec![0.0; count]);
        for phi in 0..phis {
            let slices = slices_of(exemplars.survey, metric, &exemplars.codes, phi);
            let wanted = with_rest(&space.project(&slices), space.dims);
            for (row, found) in set.nearest(&wanted, &[]).iter().enumerate() {
                index[row * phis + phi] = narrow(found.code);
                scale[row * phis + phi] = gain(found, &lengths);
            }
        }
        books.p4.index.extend(index);
        books.p4.scale.extend(scale);
    }
}

/// The best row of P4, as it really is, for each texel, with the scale for it as gain: among `old` ones
/// at the start and those that were made for the survey.
fn choose_p4(
    survey: &ProjectedTexels,
    old: usize,
    own: Range<usize>,
    books: &Codebooks,
) -> Vec<Match> {
    let (space, roots) = (&survey.space, &survey.root_weights);
    let expand = |row: usize, out: &mut [f32]| books.expand_p4(row, out);
    let between = own.start - old;
    let rows = [rows_in(space, 0..old, roots, &expand), rows_in(space, own, roots, &expand)];
    let (set, lengths) = code_set(&rows.concat(), space.dims);
    let mut matches = set.nearest(&with_rest(&survey.coefficients, space.dims), &[]);
    for found in &mut matches {
        found.gain = gain(found, &lengths);
        found.code += if found.code < old { 0 } else { between };
    }
    matches
}

/// The scale of a row of this length that a match of its direction asks for.
fn gain(found: &Match, lengths: &[f32]) -> f32 {
    let length = lengths[found.code];
    if length > 0.0 { found.gain / length } else { 0.0 }
}

/// Rows of a book in a subspace, with their last coordinate ([`rows_in`]), as codes, and their lengths.
fn code_set(rows: &[f32], dims: usize) -> (CodeSet, Vec<f32>) {
    let mut set = CodeSet::new(dims + 1, 0);
    let lengths = rows.chunks_exact(dims + 1).map(|row| set.push(row, &[])).collect();
    (set, lengths)
}

/// Rows of a book, weighted, in a subspace, with one more coordinate for what lies outside, so that
/// they keep their lengths: `[row][dims + 1]`.
fn rows_in(
    space: &Subspace,
    rows: Range<usize>,
    root_weights: &[f32],
    expand: &(dyn Fn(usize, &mut [f32]) + Sync),
) -> Vec<f32> {
    let chunks: Vec<Vec<f32>> = (0..rows.len().div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let first = rows.start + chunk * CHUNK;
            let rows = first..rows.end.min(first + CHUNK);
            let mut values = vec![0.0; rows.len() * space.len];
            for (row, out) in rows.clone().zip(values.chunks_exact_mut(space.len)) {
                expand(row, out);
                out.iter_mut().zip(root_weights).for_each(|(v, r)| *v *= r);
            }
            let mut projected = vec![0.0; rows.len() * space.dims];
            space.project_block(&values, &mut projected);
            let mut full = with_rest(&projected, space.dims);
            let rows = full.chunks_exact_mut(space.dims + 1).zip(energies(&values, space.len));
            for (row, energy) in rows {
                let inside = dot(&row[..space.dims], &row[..space.dims]);
                row[space.dims] = (energy - inside).max(0.0).sqrt();
            }
            full
        })
        .collect();
    chunks.concat()
}

/// Rows of a book as they are.
fn rows_of(rows: usize, len: usize, expand: impl Fn(usize, &mut [f32])) -> Vec<f32> {
    let mut values = vec![0.0; rows * len];
    values.chunks_exact_mut(len).enumerate().for_each(|(row, out)| expand(row, out));
    values
}

/// Vectors of a subspace with the coordinate for what lies outside, 0.
fn with_rest(coefficients: &[f32], dims: usize) -> Vec<f32> {
    coefficients.chunks_exact(dims).flat_map(|v| v.iter().copied().chain([0.0])).collect()
}
