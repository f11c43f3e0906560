//! GGX lobes by Levenberg–Marquardt: the analytic model that people fit by hand.
//!
//! Unknowns are the logarithms of all parameters, so that they stay positive. The sum that falls is that of squares of
//! the four measures of [`Fidelity`](brdf_model::Fidelity) over both its sets of pairs, each over its present mean: what
//! lowers their geometric mean.

use brdf_factor::CholeskyFactor;
use brdf_job::{Job, Stopped};
use brdf_model::{Brdf as _, GgxLobe, GgxLobes, MeasuredValue, Rgb, SampleSet};
use brdf_param::DirectionPair;
use rayon::prelude::*;

/// Roughness of the first lobe, at each start.
const STARTS: [f64; 4] = [0.01, 0.04, 0.12, 0.4];
/// Roughness of each further lobe over that of the one before, at the start.
const WIDER: f64 = 4.0;
/// Times that measures are brought to their present mean.
const ROUNDS: usize = 5;
/// Steps of a round.
const STEPS: usize = 12;
/// A step that lowers the sum by less than this part of it ends a round.
const CONVERGED: f64 = 1e-4;
/// Step of the logarithm of α for derivatives.
const DIFFERENCE: f64 = 1e-4;
/// Logarithms stay within ±LIMIT.
const LIMIT: f64 = 18.0;
pub(crate) const MEASURES: usize = 4;
/// Parameters of the base, and of a lobe.
const BASE: usize = 6;
const LOBE: usize = 5;

/// What lobes are fitted to: values at pairs, each with its share in two sets of pairs.
pub(crate) struct LobeProblem {
    pub(crate) pairs: Vec<DirectionPair>,
    pub(crate) values: Vec<[f64; 3]>,
    /// The values as each measure sees them.
    measured: Vec<[[f64; MEASURES]; 3]>,
    /// (1 − cosθd)⁵ of each pair.
    fifths: Vec<f64>,
    pub(crate) shares: Vec<[f64; 2]>,
    pub(crate) offsets: [f64; 3],
}

/// A state of the fit, with what measures say of it.
struct State {
    logs: Vec<f64>,
    /// For each lobe, what each pair has of a lobe that reflects everything.
    facets: Vec<Vec<f64>>,
    values: Vec<[f64; 3]>,
}

impl LobeProblem {
    /// Takes samples of uniform pairs, and of pairs around the mirror direction, which count half of the second set.
    pub(crate) fn new(uniform: &SampleSet, mirror: &SampleSet) -> Self {
        let (count, near) = (uniform.len() as f64, mirror.len() as f64);
        let second = if mirror.is_empty() { 1.0 } else { 0.5 };
        let sets = [(uniform, [1.0 / count, second / count]), (mirror, [0.0, 0.5 / near])];
        let mut made = Self {
            pairs: Vec::new(),
            values: Vec::new(),
            measured: Vec::new(),
            fifths: Vec::new(),
            shares: Vec::new(),
            offsets: [1e-5; 3],
        };
        for (samples, shares) in sets {
            made.pairs.extend(samples.pairs());
            made.values.extend((0..samples.len()).map(|index| samples.rgb(index).channels()));
            made.shares.extend(vec![shares; samples.len()]);
        }
        let sheen = GgxLobes { diffuse: Rgb::BLACK, lobes: Vec::new(), sheen: Rgb::splat(1.0) };
        made.fifths = made.pairs.iter().map(|pair| sheen.eval(pair).r).collect();
        made.offsets = std::array::from_fn(|c| {
            let mean: f64 =
                made.values.iter().zip(&made.shares).map(|(v, share)| v[c] * share[0]).sum();
            if mean > 0.0 { 1e-5 * mean } else { 1e-5 }
        });
        made.measured = (0..made.pairs.len())
            .map(|index| {
                std::array::from_fn(|c| made.at(index, c, made.values[index][c]).measures())
            })
            .collect();
        made
    }

    /// A value of a channel at one of the pairs.
    fn at(&self, index: usize, channel: usize, value: f64) -> MeasuredValue {
        let cosine = self.pairs[index].wi.z;
        MeasuredValue { value, cosine, offset: self.offsets[channel] }
    }

    /// What each measure says of a value beside the one that is wanted.
    fn residuals(&self, index: usize, channel: usize, found: f64) -> [f64; MEASURES] {
        let (found, wanted) =
            (self.at(index, channel, found).measures(), self.measured[index][channel]);
        std::array::from_fn(|m| found[m] - wanted[m])
    }

    /// The residuals, and their slopes with respect to the value.
    pub(crate) fn residuals_and_slopes(
        &self,
        index: usize,
        channel: usize,
        found: f64,
    ) -> ([f64; MEASURES], [f64; MEASURES]) {
        let shifted = self.offsets[channel] + found.max(0.0);
        let slopes = self.at(index, channel, found).slopes().map(|slope| slope / shifted);
        (self.residuals(index, channel, found), slopes)
    }

    /// Returns the best model of this many lobes.
    pub(crate) fn solve(&self, lobes: usize, job: &Job<'_>) -> Result<GgxLobes, Stopped> {
        job.begin("fitting lobes", (STARTS.len() * ROUNDS) as u64);
        let found: Vec<(f64, Vec<f64>)> = STARTS
            .par_iter()
            .map(|&alpha| self.solve_from(self.start(alpha, lobes), job))
            .collect();
        job.check()?;
        let best = found.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
        Ok(model_of(&best.map_or_else(|| self.start(STARTS[1], lobes), |(_, logs)| logs)))
    }

    /// Returns the best model near another.
    pub(crate) fn solve_near(&self, start: &GgxLobes, job: &Job<'_>) -> GgxLobes {
        model_of(&self.solve_from(logs_of(start), job).1)
    }

    /// A diffuse base of the median value, and lobes of a few percent.
    fn start(&self, alpha: f64, lobes: usize) -> Vec<f64> {
        let diffuse: [f64; 3] = std::array::from_fn(|c| {
            let mut values: Vec<f64> = self.values.iter().map(|v| v[c]).collect();
            let middle = values.len() / 2;
            let median = *values.select_nth_unstable_by(middle, f64::total_cmp).1;
            (std::f64::consts::PI * median).max(1e-4).ln()
        });
        let mut logs = diffuse.to_vec();
        logs.extend([0.01_f64.ln(); 3]);
        for lobe in 0..lobes {
            let alpha = alpha * WIDER.powi(i32::try_from(lobe).unwrap_or(0));
            logs.extend([0.05_f64.ln(), 0.05_f64.ln(), 0.05_f64.ln(), 0.5_f64.ln()]);
            logs.push(alpha.min(0.9).ln());
        }
        logs
    }

    /// What each pair has of a lobe of a roughness that reflects everything: D G₂ / (4 cosθi cosθo).
    fn facets(&self, alpha: f64) -> Vec<f64> {
        let white = GgxLobe { f0: Rgb::splat(1.0), f90: 1.0, alpha };
        let lobe = GgxLobes { diffuse: Rgb::BLACK, lobes: vec![white], sheen: Rgb::BLACK };
        self.pairs.iter().map(|pair| lobe.eval(pair).r).collect()
    }

    fn state(&self, logs: Vec<f64>) -> State {
        let model = model_of(&logs);
        let facets: Vec<Vec<f64>> =
            model.lobes.iter().map(|lobe| self.facets(lobe.alpha)).collect();
        let of = |index: usize| {
            let fifth = self.fifths[index];
            let lobes = model.lobes.iter().zip(&facets).map(|(lobe, facets)| {
                (lobe.f0 * (1.0 - fifth) + Rgb::splat(lobe.f90 * fifth)) * facets[index]
            });
            let base = model.diffuse / std::f64::consts::PI + model.sheen * fifth;
            (base + lobes.sum::<Rgb>()).channels()
        };
        let values = (0..self.pairs.len()).map(of).collect();
        State { logs, facets, values }
    }

    /// What values change with each logarithm, at one pair and channel. `rougher` are the facets of each lobe at a
    /// logarithm of α that is [`DIFFERENCE`] larger.
    fn slopes(
        &self,
        model: &GgxLobes,
        state: &State,
        rougher: &[Vec<f64>],
        [index, c]: [usize; 2],
        slopes: &mut [f64],
    ) {
        slopes.fill(0.0);
        let fifth = self.fifths[index];
        slopes[c] = model.diffuse.channels()[c] / std::f64::consts::PI;
        slopes[3 + c] = model.sheen.channels()[c] * fifth;
        let lobes = model.lobes.iter().zip(slopes[BASE..].chunks_exact_mut(LOBE));
        for (number, (lobe, slopes)) in lobes.enumerate() {
            let facets = state.facets[number][index];
            let [straight, grazing] = [lobe.f0.channels()[c] * (1.0 - fifth), lobe.f90 * fifth];
            slopes[c] = straight * facets;
            slopes[3] = grazing * facets;
            slopes[4] = (straight + grazing) * (rougher[number][index] - facets) / DIFFERENCE;
        }
    }

    /// Mean squares of the measures over both sets.
    pub(crate) fn mean_squares(&self, values: &[[f64; 3]]) -> [[f64; MEASURES]; 2] {
        let mut sums = [[1e-14; MEASURES]; 2];
        for (index, (found, shares)) in values.iter().zip(&self.shares).enumerate() {
            for (c, &found) in found.iter().enumerate() {
                let residuals = self.residuals(index, c, found);
                for (sums, share) in sums.iter_mut().zip(shares) {
                    for (sum, residual) in sums.iter_mut().zip(residuals) {
                        *sum += share * residual * residual;
                    }
                }
            }
        }
        sums
    }

    /// Calls back with each pair's index and channel, the residuals of the measures, their slopes, and shares.
    fn for_each(
        &self,
        values: &[[f64; 3]],
        mut visit: impl FnMut(usize, usize, [f64; MEASURES], [f64; MEASURES], [f64; 2]),
    ) {
        for (index, found) in values.iter().enumerate() {
            for (c, &found) in found.iter().enumerate() {
                let (residuals, slopes) = self.residuals_and_slopes(index, c, found);
                visit(index, c, residuals, slopes, self.shares[index]);
            }
        }
    }

    /// Returns the sum of logarithms of the mean squares that a start leads to, and the parameters.
    fn solve_from(&self, logs: Vec<f64>, job: &Job<'_>) -> (f64, Vec<f64>) {
        let mut state = self.state(logs);
        for _ in 0..ROUNDS {
            if job.is_stopped() {
                break;
            }
            let factors = self.mean_squares(&state.values).map(|set| set.map(|mean| 1.0 / mean));
            self.descend(&mut state, factors);
            job.advance(1);
        }
        let score: f64 =
            self.mean_squares(&state.values).as_flattened().iter().map(|mean| mean.ln()).sum();
        (score, state.logs)
    }

    /// Levenberg–Marquardt with fixed factors of the measures.
    fn descend(&self, state: &mut State, factors: [[f64; MEASURES]; 2]) {
        let mut damping = 1e-2;
        let mut sum = weighted(self.mean_squares(&state.values), factors);
        for _ in 0..STEPS {
            let (normal, gradient) = self.normal_equations(state, factors);
            let mut lowered = None;
            for _ in 0..6 {
                if let Some(next) = self.step(state, &normal, &gradient, damping) {
                    let found = weighted(self.mean_squares(&next.values), factors);
                    if found < sum {
                        lowered = Some((found, next));
                        damping *= 0.3;
                        break;
                    }
                }
                damping *= 5.0;
            }
            let Some((found, next)) = lowered else { return };
            let gain = (sum - found) / sum;
            (sum, *state) = (found, next);
            if gain < CONVERGED {
                return;
            }
        }
    }

    /// JᵀJ, a lower triangle column by column, and Jᵀr.
    fn normal_equations(
        &self,
        state: &State,
        factors: [[f64; MEASURES]; 2],
    ) -> (Vec<f64>, Vec<f64>) {
        let size = state.logs.len();
        let model = model_of(&state.logs);
        let alphas = state.logs[BASE..].chunks_exact(LOBE).map(|lobe| lobe[4] + DIFFERENCE);
        let rougher: Vec<Vec<f64>> = alphas.map(|log| self.facets(alpha_of(log))).collect();
        let (mut normal, mut gradient) = (vec![0.0; size * size], vec![0.0; size]);
        let mut slopes_of = vec![0.0; size];
        self.for_each(&state.values, |index, c, residuals, slopes, shares| {
            let (mut square, mut cross) = (0.0, 0.0);
            for m in 0..MEASURES {
                let weight = shares[0] * factors[0][m] + shares[1] * factors[1][m];
                square += weight * slopes[m] * slopes[m];
                cross += weight * slopes[m] * residuals[m];
            }
            self.slopes(&model, state, &rougher, [index, c], &mut slopes_of);
            for (j, b) in slopes_of.iter().enumerate() {
                gradient[j] += cross * b;
                let column = &mut normal[j * size + j..(j + 1) * size];
                for (sum, a) in column.iter_mut().zip(&slopes_of[j..]) {
                    *sum += square * a * b;
                }
            }
        });
        (normal, gradient)
    }

    fn step(&self, state: &State, normal: &[f64], gradient: &[f64], damping: f64) -> Option<State> {
        let size = gradient.len();
        let mut matrix = normal.to_vec();
        for i in 0..size {
            let diagonal = &mut matrix[i * size + i];
            *diagonal += damping * *diagonal + 1e-9;
        }
        let mut change: Vec<f64> = gradient.iter().map(|g| -g).collect();
        CholeskyFactor::new(matrix, size).ok()?.solve(&mut change);
        let logs: Vec<f64> = state
            .logs
            .iter()
            .zip(&change)
            .map(|(log, change)| (log + change.clamp(-2.0, 2.0)).clamp(-LIMIT, LIMIT))
            .collect();
        Some(self.state(logs))
    }
}

fn weighted(means: [[f64; MEASURES]; 2], factors: [[f64; MEASURES]; 2]) -> f64 {
    means
        .as_flattened()
        .iter()
        .zip(factors.as_flattened())
        .map(|(mean, factor)| mean * factor)
        .sum()
}

/// The logarithms that make this model.
fn logs_of(model: &GgxLobes) -> Vec<f64> {
    let base = [model.diffuse, model.sheen].map(|v| v.channels()).concat();
    let lobes = model
        .lobes
        .iter()
        .flat_map(|lobe| lobe.f0.channels().into_iter().chain([lobe.f90, lobe.alpha]));
    base.into_iter().chain(lobes).map(|v| v.ln().clamp(-LIMIT, LIMIT)).collect()
}

/// The model of these logarithms: diffuse, sheen, then f0, f90 and α of each lobe.
fn model_of(logs: &[f64]) -> GgxLobes {
    let rgb = |logs: &[f64]| Rgb::new(logs[0].exp(), logs[1].exp(), logs[2].exp());
    let lobes = logs[BASE..].chunks_exact(LOBE).map(|lobe| GgxLobe {
        f0: rgb(lobe),
        f90: lobe[3].exp(),
        alpha: alpha_of(lobe[4]),
    });
    GgxLobes { diffuse: rgb(logs), sheen: rgb(&logs[3..]), lobes: lobes.collect() }
}

fn alpha_of(log: f64) -> f64 {
    log.exp().min(1.5)
}

#[cfg(test)]
mod tests {
    use super::*;
    use brdf_model::{Channels, PairSampling};

    /// Values are those of the model, and slopes what they change by.
    #[test]
    fn slopes_are_differences_of_the_model() {
        let model = GgxLobes {
            diffuse: Rgb::new(0.3, 0.2, 0.1),
            lobes: vec![
                GgxLobe { f0: Rgb::new(0.02, 0.03, 0.04), f90: 0.4, alpha: 0.35 },
                GgxLobe { f0: Rgb::splat(0.04), f90: 0.8, alpha: 0.06 },
            ],
            sheen: Rgb::splat(0.02),
        };
        let sampling = PairSampling { count: 60, seed: 1, theta_max: 1.4 };
        let samples = SampleSet::draw(&model, &sampling, Channels::Rgb);
        let problem = LobeProblem::new(&samples, &SampleSet::new(Channels::Rgb));
        let state = problem.state(logs_of(&model));
        let rougher: Vec<Vec<f64>> = model
            .lobes
            .iter()
            .map(|lobe| problem.facets(alpha_of(lobe.alpha.ln() + DIFFERENCE)))
            .collect();
        let mut slopes = vec![0.0; state.logs.len()];
        for (index, pair) in problem.pairs.iter().enumerate() {
            let exact = model.eval(pair).channels();
            for (c, exact) in exact.into_iter().enumerate() {
                assert!((state.values[index][c] / exact - 1.0).abs() < 1e-9);
                problem.slopes(&model, &state, &rougher, [index, c], &mut slopes);
                for (i, slope) in slopes.iter().enumerate() {
                    let mut logs = state.logs.clone();
                    logs[i] += 1e-5;
                    let change = (model_of(&logs).eval(pair).channels()[c] - exact) / 1e-5;
                    let off = (slope - change).abs();
                    assert!(off < 1e-3 * (change.abs() + 0.01), "{slope} for {change} of {i}");
                }
            }
        }
    }

    #[test]
    fn lobes_that_were_planted_are_found_again() {
        let planted = GgxLobes {
            diffuse: Rgb::new(0.3, 0.2, 0.1),
            lobes: vec![
                GgxLobe { f0: Rgb::splat(0.04), f90: 0.8, alpha: 0.06 },
                GgxLobe { f0: Rgb::new(0.02, 0.03, 0.04), f90: 0.4, alpha: 0.35 },
            ],
            sheen: Rgb::splat(0.02),
        };
        let sampling = PairSampling { count: 1000, seed: 1, theta_max: 1.4 };
        let uniform = SampleSet::draw(&planted, &sampling, Channels::Rgb);
        let mut mirror = SampleSet::new(Channels::Rgb);
        for pair in sampling.highlight_pairs() {
            mirror.push_rgb(&pair, planted.eval(&pair));
        }
        let problem = LobeProblem::new(&uniform, &mirror);
        let found = problem.solve(2, &Job::new()).expect("not stopped");
        let mut alphas: Vec<f64> = found.lobes.iter().map(|lobe| lobe.alpha).collect();
        alphas.sort_by(f64::total_cmp);
        assert!((alphas[0] / 0.06 - 1.0).abs() < 0.02, "{found:?}");
        assert!((alphas[1] / 0.35 - 1.0).abs() < 0.05, "{found:?}");
        assert!((found.diffuse.r / 0.3 - 1.0).abs() < 0.02, "{found:?}");
    }
}
