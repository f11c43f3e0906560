//! Codebooks by Lloyd's iteration, for vectors that are scaled copies of codes and for plain ones.
//!
//! Source: Y. Linde, A. Buzo and R. M. Gray, "An Algorithm for Vector Quantizer Design", IEEE
//! Transactions on Communications 28(1), 1980; gain and shape: M. J. Sabin and R. M. Gray, "Product
//! Code Vector Quantizers for Waveform and Voice Coding", IEEE Transactions on Acoustics, Speech, and
//! Signal Processing 32(3), 1984.

use faer::MatRef;
use rayon::prelude::*;

use crate::nearest::{CodeSet, Match, dot};
use crate::subspace::products;

/// Codes and who belongs to them.
#[derive(Clone, Debug)]
pub(crate) struct Clusters {
    /// Codes that were given and stay as they are; they come before those found.
    pub(crate) fixed: usize,
    /// Those found, `[code][len]`; some may have nobody.
    pub(crate) codes: Vec<f32>,
    /// Code of each vector, counted from the first fixed one.
    pub(crate) assignment: Vec<u32>,
    /// Best scale of it; 1 for plain vectors.
    pub(crate) gains: Vec<f32>,
    /// Weighted sum of squared errors.
    pub(crate) distortion: f64,
}

/// Vectors for each code on which codes are found.
const TRAINING: usize = 24;

/// Codes of unit length, beside fixed ones, for vectors `[vector][len]` that are copies of them at any
/// scale above 0. At most `count` are found; where that is one for each vector, they are the vectors.
pub(crate) fn cluster_shapes(
    vectors: &[f32],
    len: usize,
    weights: &[f32],
    fixed: &[f32],
    count: usize,
    iterations: usize,
) -> Clusters {
    let mut codes = CodeSet::new(len, 0);
    for code in fixed.chunks_exact(len) {
        codes.push(code, &[]);
    }
    let fixed = codes.len();
    if count >= weights.len() {
        let gains: Vec<f32> = vectors.chunks_exact(len).map(|v| codes.push(v, &[])).collect();
        let assignment = (fixed..codes.len()).map(narrow).collect();
        return Clusters { fixed, codes: found(&codes, fixed), assignment, gains, distortion: 0.0 };
    }
    let energies = |vectors: &[f32], weights: &[f32]| -> Vec<f32> {
        vectors.chunks_exact(len).zip(weights).map(|(v, w)| w * dot(v, v)).collect()
    };
    // Codes are found on some of the vectors; all choose among them.
    let step = (weights.len() / (TRAINING * count.max(1))).max(1);
    let picked: Vec<f32> = vectors.chunks_exact(len).step_by(step).flatten().copied().collect();
    let picked_weights: Vec<f32> = weights.iter().step_by(step).copied().collect();
    let energy = energies(&picked, &picked_weights);
    let unserved = match fixed {
        0 => energy.clone(),
        _ => errors(&energy, &picked_weights, &codes.nearest(&picked, &[])),
    };
    for at in spread(&unserved, count) {
        codes.push(&picked[at * len..][..len], &[]);
    }
    for _ in 0..iterations {
        let matches = codes.nearest(&picked, &[]);
        codes = updated(&codes, fixed, &picked, len, &picked_weights, &energy, &matches);
    }
    let matches = codes.nearest(vectors, &[]);
    let errors = errors(&energies(vectors, weights), weights, &matches);
    Clusters {
        fixed,
        codes: found(&codes, fixed),
        assignment: matches.iter().map(|m| narrow(m.code)).collect(),
        gains: matches.iter().map(|m| m.gain).collect(),
        distortion: errors.iter().map(|e| f64::from(*e)).sum(),
    }
}

/// The codes that are not fixed.
fn found(codes: &CodeSet, fixed: usize) -> Vec<f32> {
    (fixed..codes.len()).flat_map(|at| codes.code(at).0.to_vec()).collect()
}

fn narrow(index: usize) -> u32 {
    u32::try_from(index).unwrap_or(u32::MAX)
}

fn errors(energy: &[f32], weights: &[f32], matches: &[Match]) -> Vec<f32> {
    let left = energy.iter().zip(weights).zip(matches);
    left.map(|((e, w), m)| (e - w * m.score).max(0.0)).collect()
}

/// Each code that is not fixed becomes the mean of its vectors, weighted by their scales; codes without
/// vectors become those vectors that are served worst.
fn updated(
    codes: &CodeSet,
    fixed: usize,
    vectors: &[f32],
    len: usize,
    weights: &[f32],
    energy: &[f32],
    matches: &[Match],
) -> CodeSet {
    let members = members(matches.iter().map(|m| m.code), codes.len());
    let means: Vec<Vec<f32>> = members[fixed..]
        .par_iter()
        .map(|members| {
            let mut mean = vec![0.0; len];
            for &at in members {
                let factor = weights[at] * matches[at].gain;
                let vector = &vectors[at * len..][..len];
                mean.iter_mut().zip(vector).for_each(|(m, v)| *m += factor * v);
            }
            mean
        })
        .collect();
    let mut worst = worst_first(&errors(energy, weights, matches)).into_iter();
    let mut fresh = CodeSet::new(len, 0);
    for code in 0..fixed {
        fresh.push(codes.code(code).0, &[]);
    }
    for mean in &means {
        if mean.iter().any(|v| *v != 0.0) {
            fresh.push(mean, &[]);
        } else if let Some(at) = worst.next() {
            fresh.push(&vectors[at * len..][..len], &[]);
        }
    }
    fresh
}

/// Numbers of the vectors of each code, in order.
fn members(codes: impl Iterator<Item = usize>, count: usize) -> Vec<Vec<usize>> {
    let mut members = vec![Vec::new(); count];
    for (at, code) in codes.enumerate() {
        members[code].push(at);
    }
    members
}

/// Vectors with an error, the largest first.
fn worst_first(errors: &[f32]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..errors.len()).filter(|at| errors[*at] > 0.0).collect();
    order.sort_by(|a, b| errors[*b].total_cmp(&errors[*a]).then(a.cmp(b)));
    order
}

/// Up to `count` different places, spread evenly over the running sum of weights.
fn spread(weights: &[f32], count: usize) -> Vec<usize> {
    let total: f64 = weights.iter().map(|w| f64::from(*w)).sum();
    let count = count.min(weights.len());
    if count == weights.len() || total <= 0.0 {
        return (0..count).collect();
    }
    let step = total / count as f64;
    let (mut sum, mut next) = (0.0, 0.5 * step);
    let mut places = Vec::with_capacity(count);
    for (at, weight) in weights.iter().enumerate() {
        sum += f64::from(*weight);
        if sum > next {
            places.push(at);
            while next < sum {
                next += step;
            }
        }
    }
    places
}

/// Codes, beside fixed ones, for plain vectors `[vector][len]`, each of whose values has a weight of its
/// own, and the sums of weights behind the values of each code found.
pub(crate) fn cluster_values(
    vectors: &[f32],
    len: usize,
    weights: &[f32],
    fixed: &[f32],
    count: usize,
    iterations: usize,
) -> (Clusters, Vec<f32>) {
    let vector_count = vectors.len() / len;
    let fixed_count = fixed.len() / len;
    let gains = vec![1.0; vector_count];
    if count >= vector_count {
        let assignment = (fixed_count..fixed_count + vector_count).map(narrow).collect();
        let codes = vectors.to_vec();
        let own = Clusters { fixed: fixed_count, codes, assignment, gains, distortion: 0.0 };
        return (own, weights.to_vec());
    }
    // Σ W (x − c)² = Σ W x² − 2 (Σ W x c − ½ Σ W c²): a product of (W x, W) with (c, −½ c²).
    let queries: Vec<f32> = vectors
        .chunks_exact(len)
        .zip(weights.chunks_exact(len))
        .flat_map(|(v, w)| v.iter().zip(w).map(|(v, w)| v * w).chain(w.iter().copied()))
        .collect();
    let energy: Vec<f32> = vectors
        .chunks_exact(len)
        .zip(weights.chunks_exact(len))
        .map(|(v, w)| v.iter().zip(w).map(|(v, w)| v * v * w).sum())
        .collect();
    let mass: Vec<f32> = weights.chunks_exact(len).map(|w| w.iter().sum()).collect();
    let seeds = spread(&mass, count);
    let mut codes = fixed.to_vec();
    codes.extend(seeds.iter().flat_map(|at| &vectors[at * len..][..len]));
    let (mut assignment, mut totals) = (Vec::new(), Vec::new());
    for pass in 0..=iterations {
        if pass > 0 {
            let (found, sums) =
                updated_values(&codes, fixed_count, vectors, weights, len, &assignment);
            codes.truncate(fixed.len());
            codes.extend(found);
            totals = sums;
        }
        assignment = nearest_values(&codes, &queries, len);
    }
    let distortion = assignment
        .iter()
        .enumerate()
        .map(|(at, code)| {
            let query = &queries[2 * at * len..][..2 * len];
            f64::from(energy[at] - 2.0 * value_score(&codes[code * len..][..len], query))
        })
        .sum();
    let codes = codes.split_off(fixed.len());
    let assignment = assignment.into_iter().map(narrow).collect();
    (Clusters { fixed: fixed_count, codes, assignment, gains, distortion }, totals)
}

/// ⟨W x, c⟩ − ½⟨W, c²⟩.
fn value_score(code: &[f32], query: &[f32]) -> f32 {
    let (wx, w) = query.split_at(code.len());
    code.iter().zip(wx.iter().zip(w)).map(|(c, (wx, w))| c * (wx - 0.5 * w * c)).sum()
}

fn nearest_values(codes: &[f32], queries: &[f32], len: usize) -> Vec<usize> {
    let extended: Vec<f32> = codes
        .chunks_exact(len)
        .flat_map(|code| code.iter().copied().chain(code.iter().map(|c| -0.5 * c * c)))
        .collect();
    let count = codes.len() / len;
    let matrix = MatRef::from_row_major_slice(&extended, count, 2 * len).transpose();
    let blocks: Vec<Vec<usize>> = queries
        .par_chunks(256 * 2 * len)
        .map(|block| products(block, 2 * len, matrix).chunks_exact(count).map(largest).collect())
        .collect();
    blocks.concat()
}

/// Place of the largest value, the lowest of equals.
fn largest(values: &[f32]) -> usize {
    let top = values.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    values.iter().position(|v| *v >= top).unwrap_or(0)
}

/// Weighted means for the codes that are not fixed, and the sums of weights behind each value; a code
/// without vectors stays.
fn updated_values(
    codes: &[f32],
    fixed: usize,
    vectors: &[f32],
    weights: &[f32],
    len: usize,
    assignment: &[usize],
) -> (Vec<f32>, Vec<f32>) {
    let members = members(assignment.iter().copied(), codes.len() / len);
    let means: Vec<(Vec<f32>, Vec<f32>)> = members[fixed..]
        .par_iter()
        .enumerate()
        .map(|(found, members)| {
            let code = fixed + found;
            let (mut sums, mut totals) = (vec![0.0; len], vec![0.0; len]);
            for &at in members {
                for i in 0..len {
                    let weight = weights[at * len + i];
                    sums[i] += weight * vectors[at * len + i];
                    totals[i] += weight;
                }
            }
            for (i, (sum, total)) in sums.iter_mut().zip(&totals).enumerate() {
                *sum = if *total > 0.0 { *sum / total } else { codes[code * len + i] };
            }
            (sums, totals)
        })
        .collect();
    let (codes, totals): (Vec<_>, Vec<_>) = means.into_iter().unzip();
    (codes.concat(), totals.concat())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scaled_copies_of_a_few_shapes_are_found_again() {
        let shapes = [[1.0, 0.0, 0.2, 0.0], [0.0, 1.0, 0.0, 0.5], [0.3, 0.3, 1.0, 0.1]];
        let vectors: Vec<f32> = (0..90_u8)
            .flat_map(|i| shapes[usize::from(i % 3)].map(|v| v * (1.0 + f32::from(i) / 30.0)))
            .collect();
        let clusters = cluster_shapes(&vectors, 4, &[1.0; 90], &[], 3, 8);
        assert!(clusters.distortion < 1e-4, "{}", clusters.distortion);
        assert_eq!(clusters.assignment[0], clusters.assignment[3]);
        assert_ne!(clusters.assignment[0], clusters.assignment[1]);
    }

    #[test]
    fn fixed_codes_stay_and_serve_whom_they_can() {
        let vectors = [2.0, 0.0, 0.0, 3.0, 4.0, 0.0, 0.1, 5.0, 0.0, 1.0];
        let clusters = cluster_shapes(&vectors, 2, &[1.0; 5], &[1.0, 0.0], 1, 8);
        assert_eq!((clusters.fixed, clusters.assignment.as_slice()), (1, &[0, 1, 0, 1, 1][..]));
        let weights = [1.0; 10];
        let (values, _) = cluster_values(&vectors, 2, &weights, &[4.0, 0.0], 2, 8);
        assert_eq!(values.assignment[2], 0);
        assert_eq!(values.codes.len(), 4);
    }

    #[test]
    fn values_of_no_weight_count_for_nothing() {
        let vectors = [1.0, 50.0, 1.0, -50.0, 2.0, 7.0, 2.0, 9.0];
        let weights = [1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0];
        let (clusters, _) = cluster_values(&vectors, 2, &weights, &[], 2, 5);
        assert_eq!(clusters.assignment, [0, 0, 1, 1]);
        assert!(clusters.distortion.abs() < 1e-6);
    }
}
