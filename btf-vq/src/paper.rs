//! The paper's encoder: texels come one after another, and what no code is similar enough to becomes
//! a code, taken apart into slices of one dimension less for which the same holds.
//!
//! Source: Havran, Filip and Myszkowski 2010, sections 4.2 to 4.5 and 5.1.1. What it leaves open:
//! the nearest code is the one of least squared error after the best scale of its luminance; with
//! SSIM, the most similar of the few nearest.

use brdf_job::Job;
use rayon::prelude::*;

use crate::nearest::{CodeSet, Match, dot};
use crate::projected_texels::channel_weights;
use crate::ssim::{SliceSsim, percentile_98};
use crate::{AngularGrid, BookRows, Chroma, Codebooks, IndexCodebook, TexelSet, VqError};

/// A similarity measure of slices, with its threshold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measure {
    /// Mean squared error in sRGB of a texel; of 3D slices 0.4 of it, of 2D slices 0.4², along β 0.4³.
    Mse(f32),
    /// 98th percentile of 1 − SSIM over light directions, the same for all slices.
    Ssim(f32),
}

impl Measure {
    fn times(self, factor: f32) -> Self {
        match self {
            Self::Mse(epsilon) => Self::Mse(factor * epsilon),
            Self::Ssim(epsilon) => Self::Ssim(factor * epsilon),
        }
    }
}

/// Options of the paper's encoder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaperParams {
    /// Similarity measure and threshold below which slices share a row.
    pub measure: Measure,
    /// Most rows of P4, as a share of all texels.
    pub budget: f64,
}

/// Shares of texels seen with the threshold and with one 2.5 times as large.
const PASSES: [(f64, f32); 2] = [(0.01, 1.0), (0.04, 2.5)];
/// Nearest codes among which the most similar is taken.
const FEW: usize = 3;
/// Thresholds of chrominance, Euclidean on [0, 1]: I2, I1 and C (section 4.4.1).
const CHROMA_THRESHOLDS: [f32; 3] = [0.5, 0.2, 0.1];
/// Threshold of a level's MSE relative to the level above.
const PER_LEVEL: f32 = 0.4;

/// What a level does with its slices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Level {
    P4,
    P3,
    M,
    P2,
    P1,
    I2,
    I1,
    C,
}

impl Level {
    /// Slices that meet the book together; those that become codes meet each other one by one.
    fn chunk(self) -> usize {
        match self {
            Self::P4 => 8,
            Self::P3 => 64,
            Self::M | Self::P2 | Self::I2 => 128,
            Self::P1 | Self::I1 | Self::C => 512,
        }
    }
}

/// A code and the scale to take it with.
#[derive(Clone, Copy, Debug)]
struct Entry {
    row: u32,
    scale: f32,
}

/// Codes of a level, with the lengths that their rows have at unit scale.
#[derive(Clone, Debug)]
struct Codes {
    set: CodeSet,
    lengths: Vec<f32>,
}

impl Codes {
    fn new(luma: usize, chroma: usize) -> Self {
        Self { set: CodeSet::new(luma, chroma), lengths: Vec::new() }
    }

    fn entry(&self, found: Match) -> Entry {
        let length = self.lengths[found.code];
        let scale = if length > 0.0 { found.gain / length } else { 0.0 };
        Entry { row: u32::try_from(found.code).unwrap_or(u32::MAX), scale }
    }
}

/// Slices of a level: luminance and weighted chrominance, each slice after the other.
struct Slices {
    luma: Vec<f32>,
    chroma: Vec<f32>,
}

/// The encoder's state: books under construction and what their rows look like.
#[derive(Debug)]
struct Encoder {
    grid: AngularGrid,
    books: Codebooks,
    measure: Measure,
    most_p4: usize,
    /// Roots of the weights of the chrominances.
    roots: [f32; 2],
    p4: Codes,
    p3: Codes,
    m: Codes,
    p2: Codes,
    p1: Codes,
    i2: Codes,
    i1: Codes,
    c: Codes,
}

/// Compresses sets of texels as the paper does, into books that may hold others already, whose rows stay as they
/// are.
///
/// Returns the books and, for each set, a row of P6 a texel. Work is counted in texels, those seen first twice.
///
/// # Errors
///
/// [`VqError::Source`], [`VqError::NotFinite`]; [`VqError::Stopped`].
///
/// # Panics
///
/// If the books are of another grid or encoding, or hold relative chrominance.
pub fn encode_paper(
    sets: &[TexelSet<'_>],
    params: &PaperParams,
    books: Codebooks,
    job: &Job<'_>,
) -> Result<(Codebooks, Vec<IndexCodebook>), VqError> {
    for set in sets {
        assert!(
            (&books.grid, books.encoding, books.chroma)
                == (set.grid(), set.encoding(), Chroma::Absolute),
            "books of the sets' kind"
        );
    }
    let total: usize = sets.iter().map(TexelSet::len).sum();
    job.begin("building codebooks", 2 * total as u64);
    let mut encoder = Encoder::new(params, total, books);
    for (pass, (share, factor)) in PASSES.iter().enumerate() {
        encoder.measure = params.measure.times(*factor);
        for set in sets {
            let order = halton_texels(set.width(), set.height());
            let skip = if pass == 0 { 0 } else { part(set.len(), PASSES[0].0) };
            let count = part(set.len(), *share);
            let seen = &order[skip.min(order.len())..(skip + count).min(order.len())];
            for texels in seen.chunks(crate::TEXEL_BLOCK) {
                encoder.learn(&set.gather(texels)?);
                job.check()?;
                job.advance(texels.len() as u64);
            }
        }
    }
    encoder.measure = params.measure;
    let mut textures = Vec::new();
    for set in sets {
        textures.push(encoder.place(set, job)?);
    }
    Ok((encoder.books, textures))
}

/// A share of texels, at least one.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "shares of at most 2²⁸ texels"
)]
fn part(texels: usize, share: f64) -> usize {
    ((texels as f64 * share).round() as usize).max(1)
}

/// All texels in the order of the Halton sequence in bases 2 and 3, without repeats.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "places in an image")]
fn halton_texels(width: usize, height: usize) -> Vec<usize> {
    let wanted = part(width * height, PASSES.iter().map(|p| p.0).sum()) + PASSES.len();
    let mut seen = vec![false; width * height];
    let mut order = Vec::with_capacity(wanted);
    let mut index = 1;
    while order.len() < wanted.min(width * height) {
        let x = (radical_inverse(index, 2) * width as f64) as usize;
        let y = (radical_inverse(index, 3) * height as f64) as usize;
        let texel = y.min(height - 1) * width + x.min(width - 1);
        if !std::mem::replace(&mut seen[texel], true) {
            order.push(texel);
        }
        index += 1;
    }
    order
}

fn radical_inverse(mut index: u32, base: u32) -> f64 {
    let (mut result, mut digit) = (0.0, 1.0 / f64::from(base));
    while index > 0 {
        result += f64::from(index % base) * digit;
        index /= base;
        digit /= f64::from(base);
    }
    result
}

impl Encoder {
    /// An encoder that goes on from books.
    fn new(params: &PaperParams, texels: usize, books: Codebooks) -> Self {
        let grid = books.grid;
        let (slice, betas) = (grid.slice_len(), grid.betas);
        let three = grid.thetas * slice;
        let four = grid.node_count();
        let [_, u, v] = channel_weights(books.encoding);
        let rows = BookRows::of(&books);
        let mut encoder = Self {
            grid,
            books,
            measure: params.measure,
            most_p4: rows.p4 + part(texels, params.budget),
            roots: [u.sqrt(), v.sqrt()],
            p4: Codes::new(four, 2 * four),
            p3: Codes::new(three, 2 * three),
            m: Codes::new(slice, 2 * slice),
            p2: Codes::new(slice, 0),
            p1: Codes::new(betas, 0),
            i2: Codes::new(0, 2 * slice),
            i1: Codes::new(0, 2 * betas),
            c: Codes::new(0, 2),
        };
        for (level, rows) in [
            (Level::P1, rows.p1),
            (Level::P2, rows.p2),
            (Level::C, rows.c),
            (Level::I1, rows.i1),
            (Level::I2, rows.i2),
            (Level::M, rows.m),
            (Level::P3, rows.p3),
            (Level::P4, rows.p4),
        ] {
            let (luma, chroma) = encoder.lengths(level);
            let (luma, chroma) = (vec![0.0; luma], vec![0.0; chroma]);
            for _ in 0..rows {
                let codes = encoder.codes_mut(level);
                codes.set.push(&luma, &chroma);
                codes.lengths.push(0.0);
            }
            encoder.rebuild(level, 0);
        }
        encoder
    }

    /// Slices from texels `[texel][channel][node]`.
    fn slices(&self, texels: &[f32]) -> Slices {
        let nodes = self.grid.node_count();
        let mut slices = Slices { luma: Vec::new(), chroma: Vec::new() };
        for texel in texels.chunks_exact(3 * nodes) {
            slices.luma.extend_from_slice(&texel[..nodes]);
            for (channel, root) in texel[nodes..].chunks_exact(nodes).zip(self.roots) {
                slices.chroma.extend(channel.iter().map(|v| v * root));
            }
        }
        slices
    }

    /// Lets the books grow until they hold these texels well enough.
    fn learn(&mut self, texels: &[f32]) {
        let slices = self.slices(texels);
        self.encode(Level::P4, &slices);
    }

    fn codes(&self, level: Level) -> &Codes {
        match level {
            Level::P4 => &self.p4,
            Level::P3 => &self.p3,
            Level::M => &self.m,
            Level::P2 => &self.p2,
            Level::P1 => &self.p1,
            Level::I2 => &self.i2,
            Level::I1 => &self.i1,
            Level::C => &self.c,
        }
    }

    fn codes_mut(&mut self, level: Level) -> &mut Codes {
        match level {
            Level::P4 => &mut self.p4,
            Level::P3 => &mut self.p3,
            Level::M => &mut self.m,
            Level::P2 => &mut self.p2,
            Level::P1 => &mut self.p1,
            Level::I2 => &mut self.i2,
            Level::I1 => &mut self.i1,
            Level::C => &mut self.c,
        }
    }

    /// Values of luminance and of chrominance of a slice.
    fn lengths(&self, level: Level) -> (usize, usize) {
        let (slice, betas) = (self.grid.slice_len(), self.grid.betas);
        match level {
            Level::P4 => (self.grid.node_count(), 2 * self.grid.node_count()),
            Level::P3 => (self.grid.thetas * slice, 2 * self.grid.thetas * slice),
            Level::M => (slice, 2 * slice),
            Level::P2 => (slice, 0),
            Level::P1 => (betas, 0),
            Level::I2 => (0, 2 * slice),
            Level::I1 => (0, 2 * betas),
            Level::C => (0, 2),
        }
    }

    /// A code for each slice: a similar one, or a new one.
    fn encode(&mut self, level: Level, slices: &Slices) -> Vec<Entry> {
        let (luma_len, chroma_len) = self.lengths(level);
        let chunk = level.chunk();
        let count = match luma_len {
            0 => slices.chroma.len() / chroma_len,
            len => slices.luma.len() / len,
        };
        let mut entries = Vec::with_capacity(count);
        for first in (0..count).step_by(chunk) {
            let last = count.min(first + chunk);
            let part = Slices {
                luma: slices.luma[first * luma_len..last * luma_len].to_vec(),
                chroma: slices.chroma[first * chroma_len..last * chroma_len].to_vec(),
            };
            entries.extend(self.encode_chunk(level, &part, last - first));
        }
        entries
    }

    /// The same for slices that meet the book together. New codes stand for themselves until all
    /// have been matched, then they become what the books below make of them.
    fn encode_chunk(&mut self, level: Level, slices: &Slices, count: usize) -> Vec<Entry> {
        let (luma_len, chroma_len) = self.lengths(level);
        let slice = |at: usize| {
            let luma = &slices.luma[at * luma_len..][..luma_len];
            (luma, &slices.chroma[at * chroma_len..][..chroma_len])
        };
        let old = self.codes(level).set.len();
        let few = match self.measure {
            Measure::Mse(_) => 1,
            Measure::Ssim(_) => FEW,
        };
        let mut nearest = self.codes(level).set.nearest_few(&slices.luma, &slices.chroma, few);
        nearest.resize(count, Vec::new());
        let mut found = Vec::with_capacity(count);
        let mut fresh = Vec::new();
        for (at, nearest) in nearest.iter_mut().enumerate() {
            let (luma, chroma) = slice(at);
            nearest.extend(self.codes(level).set.scan(luma, chroma, old));
            let best = self.most_similar(level, nearest, luma, chroma);
            let is_full = level == Level::P4 && self.codes(level).set.len() >= self.most_p4;
            match best {
                Some((found_match, is_close)) if is_close || is_full => found.push(found_match),
                _ => {
                    let codes = self.codes_mut(level);
                    let gain = codes.set.push(luma, chroma);
                    codes.lengths.push(gain);
                    fresh.push(at);
                    found.push(Match { code: codes.set.len() - 1, gain, score: f32::INFINITY });
                }
            }
        }
        self.take_apart(level, &fresh, old, &slice);
        found
            .iter()
            .enumerate()
            .map(|(at, found)| {
                let (luma, chroma) = slice(at);
                let codes = self.codes(level);
                codes.entry(codes.set.matched(found.code, luma, chroma))
            })
            .collect()
    }

    /// The most similar of some codes and whether it is similar enough.
    fn most_similar(
        &self,
        level: Level,
        candidates: &[Match],
        luma: &[f32],
        chroma: &[f32],
    ) -> Option<(Match, bool)> {
        let measured = candidates.iter().map(|m| (*m, self.error(level, m, luma, chroma)));
        let best = measured.reduce(|a, b| if b.1 < a.1 { b } else { a })?;
        Some((best.0, best.1 <= self.threshold(level)))
    }

    /// What the error of a slice may be.
    fn threshold(&self, level: Level) -> f32 {
        let levels = match (self.measure, level) {
            (_, Level::C) => return CHROMA_THRESHOLDS[2],
            (Measure::Ssim(epsilon), _) => return epsilon,
            (Measure::Mse(_), Level::I2) => return CHROMA_THRESHOLDS[0],
            (Measure::Mse(_), Level::I1) => return CHROMA_THRESHOLDS[1],
            (Measure::Mse(_), Level::P4) => 0,
            (Measure::Mse(_), Level::P3) => 1,
            (Measure::Mse(_), Level::M | Level::P2) => 2,
            (Measure::Mse(_), Level::P1) => 3,
        };
        match self.measure {
            Measure::Mse(epsilon) | Measure::Ssim(epsilon) => epsilon * PER_LEVEL.powi(levels),
        }
    }

    /// How far a code is from a slice.
    fn error(&self, level: Level, found: &Match, luma: &[f32], chroma: &[f32]) -> f32 {
        let square = (dot(luma, luma) + dot(chroma, chroma) - found.score).max(0.0);
        match (self.measure, level) {
            // Chrominance is weighted for the comparison of colours; thresholds are without.
            (_, Level::C) | (Measure::Mse(_), Level::I1 | Level::I2) => {
                self.plain_chroma_distance(level, found.code, chroma)
            }
            (Measure::Mse(_), _) => square / luma.len() as f32,
            (Measure::Ssim(_), _) => self.dissimilarity(level, found, luma, chroma),
        }
    }

    fn plain_chroma_distance(&self, level: Level, code: usize, chroma: &[f32]) -> f32 {
        let other = self.codes(level).set.code(code).1;
        let half = chroma.len() / 2;
        let part = |range: std::ops::Range<usize>, root: f32| -> f32 {
            let (a, b) = (&chroma[range.clone()], &other[range]);
            a.iter().zip(b).map(|(a, b)| ((a - b) / root).powi(2)).sum()
        };
        (part(0..half, self.roots[0]) + part(half..2 * half, self.roots[1])).sqrt()
    }

    /// 98th percentile of 1 − SSIM over all nodes and channels.
    fn dissimilarity(&self, level: Level, found: &Match, luma: &[f32], chroma: &[f32]) -> f32 {
        let (unit, colours) = self.codes(level).set.code(found.code);
        let rows = if matches!(level, Level::P1 | Level::I1) { 1 } else { self.grid.alphas };
        let mut ssim = SliceSsim::new(rows, self.grid.betas);
        let scaled: Vec<f32> = unit.iter().map(|v| v * found.gain).collect();
        let mut values = Vec::with_capacity(luma.len() + chroma.len());
        ssim.dissimilarities(luma, &scaled, 0.0, &mut values);
        let half = chroma.len() / 2;
        for (channel, root) in self.roots.iter().enumerate() {
            let range = channel * half..(channel + 1) * half;
            let plain = |v: &[f32]| -> Vec<f32> { v.iter().map(|v| v / root).collect() };
            let (a, b) = (plain(&chroma[range.clone()]), plain(&colours[range]));
            ssim.dissimilarities(&a, &b, 0.5, &mut values);
        }
        percentile_98(&mut values)
    }

    /// Builds rows for new codes from slices of one dimension less.
    fn take_apart<'a>(
        &mut self,
        level: Level,
        fresh: &[usize],
        old: usize,
        slice: &impl Fn(usize) -> (&'a [f32], &'a [f32]),
    ) {
        if fresh.is_empty() {
            return;
        }
        let of = |parts: usize, at: usize, part: usize| {
            let (luma, chroma) = slice(at);
            cut(luma, chroma, parts, part)
        };
        let gather = |parts: usize| {
            let mut all = Slices { luma: Vec::new(), chroma: Vec::new() };
            for (at, part) in fresh.iter().flat_map(|at| (0..parts).map(move |part| (*at, part))) {
                let (luma, chroma) = of(parts, at, part);
                all.luma.extend(luma);
                all.chroma.extend(chroma);
            }
            all
        };
        match level {
            Level::P4 => {
                let entries = self.encode(Level::P3, &gather(self.grid.phis));
                extend(&mut self.books.p4, &entries);
            }
            Level::P3 => {
                let entries = self.encode(Level::M, &gather(self.grid.thetas));
                extend(&mut self.books.p3, &entries);
            }
            Level::M => {
                let all = gather(1);
                let luma = Slices { luma: all.luma, chroma: Vec::new() };
                let chroma = Slices { luma: Vec::new(), chroma: all.chroma };
                let p2 = self.encode(Level::P2, &luma);
                let i2 = self.encode(Level::I2, &chroma);
                for (p2, i2) in p2.iter().zip(&i2) {
                    self.books.m.index.extend([p2.row, i2.row]);
                }
            }
            Level::P2 => {
                let entries = self.encode(Level::P1, &gather(self.grid.alphas));
                extend(&mut self.books.p2, &entries);
            }
            Level::I2 => {
                let entries = self.encode(Level::I1, &gather(self.grid.alphas));
                self.books.i2.index.extend(entries.iter().map(|e| e.row));
            }
            Level::I1 => {
                let entries = self.encode(Level::C, &gather(self.grid.betas));
                self.books.i1.index.extend(entries.iter().map(|e| e.row));
            }
            Level::P1 => {
                self.books.p1.values.extend(fresh.iter().flat_map(|at| slice(*at).0));
            }
            Level::C => {
                for at in fresh {
                    let chroma = slice(*at).1;
                    let pair = [chroma[0] / self.roots[0], chroma[1] / self.roots[1]];
                    self.books.c.values.extend(pair);
                }
            }
        }
        self.rebuild(level, old);
    }

    /// Replaces new codes by what their rows give.
    fn rebuild(&mut self, level: Level, old: usize) {
        let (luma_len, chroma_len) = self.lengths(level);
        let half = chroma_len / 2;
        let books = &self.books;
        let rows: Vec<Vec<f32>> = (old..self.codes(level).set.len())
            .into_par_iter()
            .map(|row| {
                let mut values = vec![0.0; luma_len + chroma_len];
                match level {
                    Level::P4 => books.expand_p4(row, &mut values),
                    Level::P3 => books.expand_p3(row, &mut values),
                    Level::P2 => books.expand_p2(row, &mut values),
                    Level::M => books.expand_m(row, &mut values),
                    Level::I2 => {
                        let (first, second) = values.split_at_mut(half);
                        books.expand_i2(row, 0, first);
                        books.expand_i2(row, 1, second);
                    }
                    Level::I1 => books.expand_i1(row, &mut values),
                    Level::P1 => values.copy_from_slice(books.p1.row(row)),
                    Level::C => values.copy_from_slice(books.c.row(row)),
                }
                values
            })
            .collect();
        let roots = self.roots;
        let codes = self.codes_mut(level);
        for (row, mut values) in (old..).zip(rows) {
            let (luma, chroma) = values.split_at_mut(luma_len);
            for (channel, root) in chroma.chunks_exact_mut(half.max(1)).zip(roots) {
                channel.iter_mut().for_each(|v| *v *= root);
            }
            codes.lengths[row] = codes.set.replace(row, luma, chroma);
        }
    }

    /// A row of P6 for each texel of a set; the books stay as they are.
    fn place(&self, set: &TexelSet<'_>, job: &Job<'_>) -> Result<IndexCodebook, VqError> {
        let few = match self.measure {
            Measure::Mse(_) => 1,
            Measure::Ssim(_) => FEW,
        };
        let nodes = self.grid.node_count();
        let (blocks, _) = set.map_blocks(0..set.len(), |texels, values| {
            if job.is_stopped() {
                return Vec::new();
            }
            let slices = self.slices(values);
            let nearest = self.p4.set.nearest_few(&slices.luma, &slices.chroma, few);
            job.advance(texels.len() as u64);
            let entries = nearest.iter().enumerate().map(|(at, nearest)| {
                let luma = &slices.luma[at * nodes..][..nodes];
                let chroma = &slices.chroma[2 * at * nodes..][..2 * nodes];
                let best = match few {
                    1 => nearest.first().copied(),
                    _ => self.most_similar(Level::P4, nearest, luma, chroma).map(|best| best.0),
                };
                best.map_or(Entry { row: 0, scale: 0.0 }, |found| self.p4.entry(found))
            });
            entries.collect::<Vec<Entry>>()
        })?;
        job.check()?;
        let mut texture = IndexCodebook { len: 1, ..IndexCodebook::default() };
        extend(&mut texture, &blocks.concat());
        Ok(texture)
    }
}

fn extend(book: &mut IndexCodebook, entries: &[Entry]) {
    book.index.extend(entries.iter().map(|e| e.row));
    book.scale.extend(entries.iter().map(|e| e.scale));
}

/// One of equal parts of a slice: of its luminance and of both its chrominances.
fn cut<'a>(luma: &'a [f32], chroma: &'a [f32], parts: usize, part: usize) -> (&'a [f32], Vec<f32>) {
    let len = luma.len() / parts;
    let half = chroma.len() / 2;
    let each = half / parts;
    let of = |channel: usize| chroma[channel * half + part * each..][..each].iter().copied();
    (&luma[part * len..][..len], of(0).chain(of(1)).collect())
}
