//! Maps for given products: non-negative least squares, smoothed.

use rayon::prelude::*;

use crate::coefficient_map::{MapTaps, read};

/// Parts of the samples whose sums are added in order, so that threads change nothing.
pub(crate) const CHUNKS: usize = 8;
/// Steps towards the least error for each set of products.
const STEPS: usize = 6;
/// Weight of the difference between neighbours, as a share of the mean weight of a texel.
const SMOOTHING: f32 = 3e-3;
/// Rounds over the coefficients of a texel.
const ROUNDS: usize = 12;

/// What maps are fitted to.
pub(crate) struct MapProblem<'a> {
    /// Of each sample, where it reads the maps.
    pub(crate) taps: &'a [MapTaps],
    /// Its colour.
    pub(crate) wanted: &'a [[f32; 3]],
    /// Its colour in each product.
    pub(crate) products: &'a [Vec<[f32; 3]>],
    /// Texels a side.
    pub(crate) size: usize,
    /// Whether the first and the last column are neighbours.
    pub(crate) wraps: bool,
}

/// For each texel the products' Gram matrix and what they have in common with the residual.
struct Sums {
    gram: Vec<f32>,
    gradient: Vec<f32>,
}

impl MapProblem<'_> {
    /// Moves maps, `[product][texel]`, towards the least squared error. Each step minimizes a sum over
    /// texels that lies above the error and touches it where the maps are, so that none raises it.
    pub(crate) fn improve(&self, maps: &mut [Vec<f32>]) {
        let count = self.products.len();
        let gram = self.sums(maps, true).gram;
        let texels = self.size * self.size;
        let mean = {
            let touched = gram.chunks_exact(count * count).filter(|g| g[0] > 0.0).count().max(1);
            let traces = gram.chunks_exact(count * count);
            let traces = traces.map(|g| (0..count).map(|j| g[j * count + j]).sum::<f32>());
            traces.sum::<f32>() / (touched * count) as f32
        };
        let smoothing = SMOOTHING * mean;
        for _ in 0..STEPS {
            let gradient = self.sums(maps, false).gradient;
            let new: Vec<Vec<f32>> = (0..texels)
                .into_par_iter()
                .map(|texel| {
                    let gram = &gram[texel * count * count..][..count * count];
                    let gradient = &gradient[texel * count..][..count];
                    self.step(maps, texel, gram, gradient, smoothing)
                })
                .collect();
            for (texel, values) in new.iter().enumerate() {
                for (map, value) in maps.iter_mut().zip(values) {
                    map[texel] = *value;
                }
            }
        }
    }

    /// A texel's coefficients after a step, 0 and above.
    fn step(
        &self,
        maps: &[Vec<f32>],
        texel: usize,
        gram: &[f32],
        gradient: &[f32],
        smoothing: f32,
    ) -> Vec<f32> {
        let count = maps.len();
        let own: Vec<f32> = maps.iter().map(|map| map[texel]).collect();
        let around = self.neighbours(texel);
        let (mut wanted, mut curvature) = (gradient.to_vec(), 0.0);
        for other in around.into_iter().flatten() {
            // (a − b)² lies below 2 (a − m)² + 2 (b − m)², m their mean.
            curvature += 2.0 * smoothing;
            for (j, wanted) in wanted.iter_mut().enumerate() {
                *wanted += smoothing * (maps[j][other] - own[j]);
            }
        }
        let mut moved = vec![0.0_f32; count];
        for _ in 0..ROUNDS {
            for j in 0..count {
                let diagonal = gram[j * count + j] + curvature;
                if diagonal <= 0.0 {
                    continue;
                }
                let others: f32 =
                    (0..count).filter(|k| *k != j).map(|k| gram[j * count + k] * moved[k]).sum();
                moved[j] = ((wanted[j] - others) / diagonal).max(-own[j]);
            }
        }
        own.iter().zip(moved).map(|(own, moved)| (own + moved).max(0.0)).collect()
    }

    fn neighbours(&self, texel: usize) -> [Option<usize>; 4] {
        let (column, row, size) = (texel % self.size, texel / self.size, self.size);
        let first = row * size;
        let beside = |inside: bool, at: usize, around: usize| {
            if inside { Some(at) } else { self.wraps.then_some(around) }
        };
        [
            beside(column > 0, texel.wrapping_sub(1), first + size - 1),
            beside(column + 1 < size, texel + 1, first),
            (row > 0).then(|| texel - size),
            (row + 1 < size).then(|| texel + size),
        ]
    }

    /// Sums over samples, of the Gram matrices or of the gradient.
    fn sums(&self, maps: &[Vec<f32>], of_gram: bool) -> Sums {
        let (count, texels) = (self.products.len(), self.size * self.size);
        let len = self.taps.len().div_ceil(CHUNKS).max(1);
        let parts: Vec<Vec<f32>> = (0..self.taps.len().div_ceil(len))
            .into_par_iter()
            .map(|chunk| {
                let range = chunk * len..self.taps.len().min((chunk + 1) * len);
                let mut sums = vec![0.0; texels * count * if of_gram { count } else { 1 }];
                let mut own = vec![[0.0_f32; 3]; count];
                for at in range {
                    own.iter_mut().zip(self.products).for_each(|(own, all)| *own = all[at]);
                    if of_gram {
                        self.add_gram(at, &own, &mut sums);
                    } else {
                        self.add_gradient(at, &own, maps, &mut sums);
                    }
                }
                sums
            })
            .collect();
        let mut total = vec![0.0; parts.first().map_or(0, Vec::len)];
        for part in &parts {
            total.iter_mut().zip(part).for_each(|(sum, v)| *sum += v);
        }
        match of_gram {
            true => Sums { gram: total, gradient: Vec::new() },
            false => Sums { gram: Vec::new(), gradient: total },
        }
    }

    fn add_gram(&self, at: usize, own: &[[f32; 3]], sums: &mut [f32]) {
        let count = own.len();
        for j in 0..count {
            for k in 0..=j {
                let product = dot(&own[j], &own[k]);
                for (texel, share) in &self.taps[at] {
                    let gram = &mut sums[texel * count * count..][..count * count];
                    gram[j * count + k] += share * product;
                    if j != k {
                        gram[k * count + j] += share * product;
                    }
                }
            }
        }
    }

    fn add_gradient(&self, at: usize, own: &[[f32; 3]], maps: &[Vec<f32>], sums: &mut [f32]) {
        let count = own.len();
        let mut left = self.wanted[at];
        for (value, map) in own.iter().zip(maps) {
            let c = read(map, &self.taps[at]);
            left.iter_mut().zip(value).for_each(|(left, v)| *left -= c * v);
        }
        for (j, value) in own.iter().enumerate() {
            let product = dot(&left, value);
            for (texel, share) in &self.taps[at] {
                sums[texel * count + j] += share * product;
            }
        }
    }
}

fn dot(a: &[f32; 3], b: &[f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
