//! The power iteration as Wang, Tran and Luebke 2004 print it, for comparison only.
//!
//! It stops when the Rayleigh quotient settles. Where the two leading eigenvalues have equal size and
//! opposite sign, the iterate swings between two vectors that are no eigenvectors, and the quotient
//! settles on a number that is no eigenvalue. The wrong component is then subtracted.

use faer::{Mat, MatRef};
use rand_core::SeedableRng;
use rand_xoshiro::SplitMix64;

use crate::krylov::random_block;
use crate::product::transposed_product;

/// The quotient and the vector that one loop of the power iteration ended with.
#[derive(Clone, Debug, PartialEq)]
pub struct PowerPair {
    /// The Rayleigh quotient λ.
    pub value: f64,
    /// The unit vector v.
    pub vector: Vec<f64>,
    /// Residual ‖Mv − λv‖ / |λ|, with M what was left of the matrix; the iteration does not stop by it.
    pub residual: f64,
    /// Number of products with the matrix.
    pub iterations: usize,
}

/// Change of the quotient, relative, that counts as convergence.
const SETTLED: f64 = 1e-6;
const MOST_ITERATIONS: usize = 5_000;

/// Returns the first `rank` pairs by power iteration with deflation, from seeded random vectors.
pub fn power_iteration(matrix: MatRef<'_, f64>, rank: usize, seed: u64) -> Vec<PowerPair> {
    let mut rest = matrix.to_owned();
    let mut rng = SplitMix64::seed_from_u64(seed);
    (0..rank)
        .map(|_| {
            let pair = dominant(&rest, &mut rng);
            for column in 0..rest.ncols() {
                let scale = pair.value * pair.vector[column];
                rest.col_mut(column)
                    .iter_mut()
                    .zip(&pair.vector)
                    .for_each(|(value, v)| *value -= scale * v);
            }
            pair
        })
        .collect()
}

fn dominant(matrix: &Mat<f64>, rng: &mut SplitMix64) -> PowerPair {
    let mut vector = random_block(matrix.nrows(), 1, rng);
    let mut value = f64::INFINITY;
    let mut residual = f64::INFINITY;
    let mut iterations = 0;
    while iterations < MOST_ITERATIONS {
        let norm = vector.col(0).norm_l2();
        if norm <= 0.0 {
            break;
        }
        vector.col_mut(0).iter_mut().for_each(|v| *v /= norm);
        let image = transposed_product(matrix.as_ref(), vector.as_ref());
        let quotient: f64 = vector.col(0).iter().zip(image.col(0).iter()).map(|(a, b)| a * b).sum();
        let off = image.col(0) - vector.col(0) * faer::Scale(quotient);
        residual = off.norm_l2() / quotient.abs();
        iterations += 1;
        let settled = (quotient - value).abs() <= SETTLED * quotient.abs();
        value = quotient;
        if settled {
            break;
        }
        vector = image;
    }
    let norm = vector.col(0).norm_l2();
    let unit = vector.col(0).iter().map(|v| if norm > 0.0 { v / norm } else { 0.0 });
    PowerPair {
        value: if value.is_finite() { value } else { 0.0 },
        vector: unit.collect(),
        residual,
        iterations,
    }
}
