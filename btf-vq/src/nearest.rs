//! The best of many codes for each of many vectors, by blocked matrix products.
//!
//! The error of a code is that which is left after the best scale of its luminance:
//! ‖y − s·c‖² + ‖d − e‖² with free s ≥ 0, for a vector of luminance y and chrominance d, and a code
//! (c, e). With ‖c‖ = 1 it is ‖y‖² + ‖d‖² − score, score = max(0, ⟨y, c⟩)² + 2⟨d, e⟩ − ‖e‖².

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use rayon::prelude::*;

/// Vectors that meet the codes together.
const QUERIES: usize = 64;
/// Codes that meet them together: a tile of products is 64 kB.
const CODES: usize = 256;
/// Scores this close, relative to the length of the vectors, are compared again one by one, so that
/// rounding in the products decides nothing.
const CLOSE: f32 = 1e-4;

/// A set of codes that can be searched for the nearest one to a vector. Codes have luminance of unit length (or
/// zero) and, where there is any, chrominance as it is.
///
/// ```
/// let mut codes = btf_vq::CodeSet::new(2, 0);
/// codes.push(&[1.0, 0.0], &[]);
/// codes.push(&[0.0, 2.0], &[]);
/// let found = codes.nearest(&[0.1, 3.0], &[]);
/// assert_eq!(found[0].code, 1);
/// ```
#[derive(Clone, Debug, Default)]
pub struct CodeSet {
    luma_len: usize,
    chroma_len: usize,
    luma: Vec<f32>,
    chroma: Vec<f32>,
    chroma_sq: Vec<f32>,
}

/// The best code of a vector, with scale and error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Match {
    /// Index of the code; the lowest of equals.
    pub code: usize,
    /// Best scale of its unit luminance, 0 or above.
    pub gain: f32,
    /// Explained part: the squared length of the vector less this is the squared error.
    pub score: f32,
}

impl CodeSet {
    /// Returns an empty set for vectors of `luma_len` values of luminance and `chroma_len` of chrominance.
    pub fn new(luma_len: usize, chroma_len: usize) -> Self {
        Self { luma_len, chroma_len, ..Self::default() }
    }

    /// Returns the number of codes.
    pub fn len(&self) -> usize {
        self.chroma_sq.len()
    }

    /// Returns whether there are no codes.
    pub fn is_empty(&self) -> bool {
        self.chroma_sq.is_empty()
    }

    /// Adds a code, whose luminance is scaled to unit length, and returns the length it had.
    pub fn push(&mut self, luma: &[f32], chroma: &[f32]) -> f32 {
        let length = dot(luma, luma).sqrt();
        let unit = if length > 0.0 { length.recip() } else { 0.0 };
        self.luma.extend(luma.iter().map(|v| v * unit));
        self.chroma.extend_from_slice(chroma);
        self.chroma_sq.push(dot(chroma, chroma));
        length
    }

    /// Returns the luminance, of unit length, and the chrominance of a code.
    pub fn code(&self, code: usize) -> (&[f32], &[f32]) {
        (
            &self.luma[code * self.luma_len..][..self.luma_len],
            &self.chroma[code * self.chroma_len..][..self.chroma_len],
        )
    }

    /// Replaces a code by other values and returns the length that their luminance has.
    pub fn replace(&mut self, code: usize, luma: &[f32], chroma: &[f32]) -> f32 {
        let length = dot(luma, luma).sqrt();
        let unit = if length > 0.0 { length.recip() } else { 0.0 };
        let place = &mut self.luma[code * self.luma_len..][..self.luma_len];
        place.iter_mut().zip(luma).for_each(|(p, v)| *p = v * unit);
        self.chroma[code * self.chroma_len..][..self.chroma_len].copy_from_slice(chroma);
        self.chroma_sq[code] = dot(chroma, chroma);
        length
    }

    /// Returns how one code fits one vector.
    pub fn matched(&self, code: usize, luma: &[f32], chroma: &[f32]) -> Match {
        let (unit, colour) = self.code(code);
        let gain = dot(luma, unit).max(0.0);
        let score = gain * gain + 2.0 * dot(chroma, colour) - self.chroma_sq[code];
        Match { code, gain, score }
    }

    /// Returns the best of the codes from `from` on for one vector, found one after another: the oracle of
    /// [`CodeSet::nearest`].
    pub fn scan(&self, luma: &[f32], chroma: &[f32], from: usize) -> Option<Match> {
        (from..self.len())
            .map(|code| self.matched(code, luma, chroma))
            .reduce(|best, next| if next.score > best.score { next } else { best })
    }

    /// Vectors in buffers of luminance and chrominance.
    fn count(&self, luma: &[f32], chroma: &[f32]) -> usize {
        match self.luma_len {
            0 => chroma.len() / self.chroma_len.max(1),
            len => luma.len() / len,
        }
    }

    /// Returns the best code for each vector, found in parallel; empty if there are no codes.
    pub fn nearest(&self, luma: &[f32], chroma: &[f32]) -> Vec<Match> {
        self.nearest_few(luma, chroma, 1)
            .into_iter()
            .filter_map(|few| few.first().copied())
            .collect()
    }

    /// Returns the `few` best codes for each vector, best first and the lower first of equals; fewer if there are
    /// fewer codes. In parallel.
    pub fn nearest_few(&self, luma: &[f32], chroma: &[f32], few: usize) -> Vec<Vec<Match>> {
        let count = self.count(luma, chroma);
        let found: Vec<Vec<Vec<Match>>> = (0..count.div_ceil(QUERIES))
            .into_par_iter()
            .map_init(Products::default, |products, block| {
                let first = block * QUERIES;
                let last = count.min(first + QUERIES);
                let chroma = &chroma[first * self.chroma_len..last * self.chroma_len];
                let luma = &luma[first * self.luma_len..last * self.luma_len];
                self.block(luma, chroma, few, products)
            })
            .collect();
        found.into_iter().flatten().collect()
    }

    fn block(
        &self,
        luma: &[f32],
        chroma: &[f32],
        few: usize,
        products: &mut Products,
    ) -> Vec<Vec<Match>> {
        let count = self.count(luma, chroma);
        let vector = |at: usize| {
            let luma = &luma[at * self.luma_len..][..self.luma_len];
            (luma, &chroma[at * self.chroma_len..][..self.chroma_len])
        };
        let slack: Vec<f32> = (0..count)
            .map(|at| {
                let (luma, chroma) = vector(at);
                CLOSE * (dot(luma, luma) + dot(chroma, chroma) + f32::MIN_POSITIVE)
            })
            .collect();
        let mut best: Vec<Vec<Match>> = vec![Vec::with_capacity(few + 1); count];
        for first in (0..self.len()).step_by(CODES) {
            let codes = CODES.min(self.len() - first);
            products.fill(self, luma, chroma, first, codes);
            for (at, best) in best.iter_mut().enumerate() {
                let scores = products.scores(at, codes, &self.chroma_sq[first..][..codes]);
                let top = largest(scores);
                let mut least = least_of(best, few);
                if top < least - slack[at] {
                    continue;
                }
                let (luma, chroma) = vector(at);
                for (offset, score) in scores.iter().enumerate() {
                    // Below the largest of this tile nothing can win where one is wanted.
                    let bar = if few == 1 { least.max(top) } else { least };
                    if *score >= bar - slack[at] {
                        insert(best, self.matched(first + offset, luma, chroma), few);
                        least = least_of(best, few);
                    }
                }
            }
        }
        best
    }
}

/// The score that a newcomer has to beat.
fn least_of(best: &[Match], few: usize) -> f32 {
    if best.len() < few {
        f32::NEG_INFINITY
    } else {
        best.last().map_or(f32::NEG_INFINITY, |m| m.score)
    }
}

/// Keeps the best, in order; codes come in ascending order, so equals stay behind.
fn insert(best: &mut Vec<Match>, next: Match, few: usize) {
    let place = best.partition_point(|m| m.score >= next.score);
    if place < few {
        best.insert(place, next);
        best.truncate(few);
    }
}

/// Products of a tile of vectors with a tile of codes.
#[derive(Default)]
struct Products {
    luma: Vec<f32>,
    chroma: Vec<f32>,
}

impl Products {
    fn fill(&mut self, set: &CodeSet, luma: &[f32], chroma: &[f32], first: usize, codes: usize) {
        let units = &set.luma[first * set.luma_len..];
        products(luma, units, set.luma_len, codes, &mut self.luma);
        if set.luma_len == 0 {
            self.luma.clear();
            self.luma.resize(set.count(luma, chroma) * codes, 0.0);
        }
        let colours = &set.chroma[first * set.chroma_len..];
        products(chroma, colours, set.chroma_len, codes, &mut self.chroma);
    }

    /// Turns a row of products into scores.
    fn scores(&mut self, at: usize, codes: usize, chroma_sq: &[f32]) -> &[f32] {
        let row = &mut self.luma[at * codes..][..codes];
        for v in &mut *row {
            let gain = if *v > 0.0 { *v } else { 0.0 };
            *v = gain * gain;
        }
        if !self.chroma.is_empty() {
            let colours = &self.chroma[at * codes..][..codes];
            for ((score, product), sq) in row.iter_mut().zip(colours).zip(chroma_sq) {
                *score += 2.0 * product - sq;
            }
        }
        row
    }
}

/// The largest value, in lanes that compilers turn into vectors.
fn largest(values: &[f32]) -> f32 {
    let (blocks, rest) = values.as_chunks::<16>();
    let mut lanes = [f32::NEG_INFINITY; 16];
    for block in blocks {
        for (lane, v) in lanes.iter_mut().zip(block) {
            *lane = if *v > *lane { *v } else { *lane };
        }
    }
    lanes.iter().chain(rest).copied().fold(f32::NEG_INFINITY, f32::max)
}

/// `out[vector][code]`; nothing for vectors of no values.
fn products(vectors: &[f32], codes: &[f32], len: usize, count: usize, out: &mut Vec<f32>) {
    if len == 0 {
        out.clear();
        return;
    }
    let rows = vectors.len() / len;
    out.resize(rows * count, 0.0);
    matmul(
        MatMut::from_row_major_slice_mut(&mut out[..rows * count], rows, count),
        Accum::Replace,
        MatRef::from_row_major_slice(vectors, rows, len),
        MatRef::from_row_major_slice(&codes[..count * len], count, len).transpose(),
        1.0,
        Par::Seq,
    );
}

/// Eight running sums, added in one order: the same on every machine.
pub(crate) fn dot(a: &[f32], b: &[f32]) -> f32 {
    let (a_blocks, a_rest) = a.as_chunks::<8>();
    let (b_blocks, b_rest) = b.as_chunks::<8>();
    let mut sums = [0.0_f32; 8];
    for (a, b) in a_blocks.iter().zip(b_blocks) {
        for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum += a * b;
        }
    }
    let rest: f32 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f32>() + rest
}
