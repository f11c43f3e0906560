//! The non-parametric factor model: a diffuse base and one product of functions of one angle each.
//!
//! f = ρ + D(θh) F(θd) G(θi) G(θo) for each channel, where D, F and G are tables. It is what remains of a microfacet model if
//! nothing is said of its functions, and the usual rival of models that store tables.
//!
//! Source of the form: M. M. Bagher, J. Snyder and D. Nowrouzezahrai, "A Non-Parametric Factor Microfacet Model for
//! Isotropic BRDFs", ACM Transactions on Graphics 35(5), 2016. The fit is our own: Levenberg–Marquardt in the
//! logarithms of all numbers, with the weights that GGX lobes are fitted by.

use std::f64::consts::FRAC_PI_2;

use brdf_factor::CholeskyFactor;
use brdf_job::{Job, Stopped};
use brdf_model::{Brdf, Channels, PairSampling, Rgb, SampleSet};
use brdf_param::{DirectionPair, polar_angle};
use rayon::prelude::*;

use crate::lobes::{LobeProblem, MEASURES};
use crate::material::Material;

/// Times that measures are brought to their present mean.
const ROUNDS: usize = 8;
/// Steps of a round.
const STEPS: usize = 10;
/// A step that lowers the sum by less than this part of it ends a round.
const CONVERGED: f64 = 1e-4;
/// Logarithms stay within ±LIMIT.
const LIMIT: f64 = 18.0;
/// Weight of squared second differences of tables beside a sum of squares of about 8: enough to fill nodes that no
/// pair reads, and too little to be seen elsewhere.
const SMOOTHING: f64 = 1e-3;
/// Shares of the values that lie below the diffuse base, at each start.
const STARTS: [f64; 2] = [0.1, 0.5];
/// Scattered rows that are fitted at most.
const MOST_ROWS: usize = 12_000;
/// Tables of a channel: D, F and G.
const TABLES: usize = 3;
/// Reads of a pair: D, F, and G twice.
const READS: usize = 4;

/// How a factor model is fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FactorModelSettings {
    /// Nodes of each table, at least 2. 90 make 3,252 bytes of three channels.
    pub nodes: usize,
    /// Uniform pairs that are fitted, and as many around the mirror direction.
    pub pairs: u32,
    /// Largest angle to the normal of those pairs, radians.
    pub theta_max: f64,
    /// Which scramble of the sample sequence.
    pub seed: u64,
}

impl Default for FactorModelSettings {
    fn default() -> Self {
        Self { nodes: 90, pairs: 8_000, theta_max: 80_f64.to_radians(), seed: 1 }
    }
}

/// A factor model; isotropic and reciprocal.
#[derive(Clone, Debug, PartialEq)]
pub struct FactorModel {
    /// One, or red, green and blue.
    channels: Vec<FactorChannel>,
}

/// One channel of a factor model: natural logarithms, of nodes between which logarithms are interpolated.
#[derive(Clone, Debug, PartialEq)]
pub struct FactorChannel {
    /// Of ρ, sr⁻¹.
    pub base: f64,
    /// Of D, at θh = 90° (i / (n − 1))²: nodes crowd at the mirror direction.
    pub distribution: Vec<f64>,
    /// Of F, at even θd up to 90°.
    pub fresnel: Vec<f64>,
    /// Of G, at even angles to the normal up to 90°.
    pub shadowing: Vec<f64>,
}

impl FactorModel {
    /// Returns the model of one channel, which is grey, or of red, green and blue; `None` of other numbers of channels,
    /// or where a table has fewer than two nodes.
    pub fn new(channels: Vec<FactorChannel>) -> Option<Self> {
        let is_table = |table: &Vec<f64>| table.len() >= 2;
        let is_whole = |c: &FactorChannel| {
            [&c.distribution, &c.fresnel, &c.shadowing].into_iter().all(is_table)
        };
        (matches!(channels.len(), 1 | 3) && channels.iter().all(is_whole))
            .then_some(Self { channels })
    }

    /// Returns the channels: one, or red, green and blue.
    pub fn channels(&self) -> &[FactorChannel] {
        &self.channels
    }

    /// Returns the bytes of all numbers as f32, which is what they are rounded to.
    pub fn bytes(&self) -> usize {
        let numbers =
            |c: &FactorChannel| 1 + c.distribution.len() + c.fresnel.len() + c.shadowing.len();
        4 * self.channels.iter().map(numbers).sum::<usize>()
    }
}

impl Brdf for FactorModel {
    fn eval(&self, pair: &DirectionPair) -> Rgb {
        if pair.wi.z <= 0.0 || pair.wo.z <= 0.0 {
            return Rgb::BLACK;
        }
        let places = places(pair);
        let value = |c: &FactorChannel| c.base.exp() + c.log_product(places).exp();
        match &self.channels[..] {
            [grey] => Rgb::splat(value(grey)),
            [r, g, b] => Rgb::new(value(r), value(g), value(b)),
            _ => Rgb::BLACK,
        }
    }
}

impl FactorChannel {
    fn log_product(&self, places: [f64; READS]) -> f64 {
        let tables = [&self.distribution, &self.fresnel, &self.shadowing, &self.shadowing];
        let read = |(table, place): (&Vec<f64>, f64)| {
            let (low, share) = between(place, table.len());
            table[low] + share * (table[low + 1] - table[low])
        };
        tables.into_iter().zip(places).map(read).sum()
    }
}

/// Where a pair reads D, F, G and G, each in [0, 1].
fn places(pair: &DirectionPair) -> [f64; READS] {
    let half = pair.half();
    let difference = half.dot(pair.wi).clamp(-1.0, 1.0).acos();
    let [h, d, i, o] = [polar_angle(half), difference, polar_angle(pair.wi), polar_angle(pair.wo)]
        .map(|angle| (angle / FRAC_PI_2).clamp(0.0, 1.0));
    [h.sqrt(), d, i, o]
}

/// The node below a place, and the share of the way to the next one.
fn between(place: f64, nodes: usize) -> (usize, f64) {
    let along = place * (nodes - 1) as f64;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a place within a table"
    )]
    let low = (along as usize).min(nodes - 2);
    (low, along - low as f64)
}

/// Returns the factor model of a material: of pairs that are drawn from it, or of scattered rows.
///
/// ```
/// use brdf_fit::{FactorModelSettings, Material, fit_factor_model};
/// use brdf_job::Job;
/// use brdf_model::{FidelityPairs, Preset};
///
/// let paint = Preset::find("red-plastic").expect("a preset").brdf();
/// let settings = FactorModelSettings { nodes: 24, pairs: 1_000, ..FactorModelSettings::default() };
/// let model = fit_factor_model(&Material::new("plastic", &paint), &settings, &Job::new())?;
/// let pairs = FidelityPairs::new(9, settings.theta_max);
/// assert!(pairs.measure(&paint, &model).score() < 0.05 && model.bytes() == 876);
/// # Ok::<(), brdf_job::Stopped>(())
/// ```
///
/// # Errors
///
/// [`Stopped`].
pub fn fit_factor_model(
    material: &Material<'_>,
    settings: &FactorModelSettings,
    job: &Job<'_>,
) -> Result<FactorModel, Stopped> {
    let channels = material.channels();
    let problem = match material.samples() {
        Some(rows) => {
            let rows = rows.within(settings.theta_max).subset(MOST_ROWS);
            LobeProblem::new(&rows, &SampleSet::new(rows.channels()))
        }
        None => {
            let (count, seed, theta_max) = (settings.pairs, settings.seed, settings.theta_max);
            let sampling = PairSampling { count, seed, theta_max };
            let reference = channels.of(material.brdf());
            let uniform = SampleSet::draw(&*reference, &sampling, Channels::Rgb);
            let mut mirror = SampleSet::new(Channels::Rgb);
            for pair in sampling.highlight_pairs().filter(|pair| reference.has_data(pair)) {
                mirror.push_clamped(&pair, reference.eval_unclamped(&pair));
            }
            LobeProblem::new(&uniform, &mirror)
        }
    };
    let nodes = settings.nodes.max(2);
    let tables = Tables::new(&problem, nodes, channels.count());
    job.begin("fitting a factor model", (STARTS.len() * ROUNDS) as u64);
    let mut best: Option<(f64, Vec<Vec<f64>>)> = None;
    for share in STARTS {
        let (score, logs) = tables.solve(tables.start(share), job)?;
        if best.as_ref().is_none_or(|(least, _)| score < *least) {
            best = Some((score, logs));
        }
    }
    let logs = best.map_or_else(|| tables.start(STARTS[0]), |(_, logs)| logs);
    Ok(FactorModel { channels: logs.iter().map(|logs| channel_of(logs, nodes)).collect() })
}

/// The channel of these unknowns, rounded to f32.
fn channel_of(logs: &[f64], nodes: usize) -> FactorChannel {
    #[expect(clippy::cast_possible_truncation, reason = "tables are stored in f32")]
    let rounded: Vec<f64> = logs.iter().map(|&log| f64::from(log as f32)).collect();
    let table = |index: usize| rounded[1 + index * nodes..1 + (index + 1) * nodes].to_vec();
    FactorChannel {
        base: rounded[0],
        distribution: table(0),
        fresnel: table(1),
        shadowing: table(2),
    }
}

/// The fit of all tables of all channels. Unknowns of a channel are logarithms: of the base, then D, F and G.
struct Tables<'a> {
    problem: &'a LobeProblem,
    nodes: usize,
    channels: usize,
    /// Unknowns below and shares of the way to the next ones, of each pair.
    reads: Vec<[(usize, f64); READS]>,
}

impl<'a> Tables<'a> {
    fn new(problem: &'a LobeProblem, nodes: usize, channels: usize) -> Self {
        let reads = problem.pairs.iter().map(|pair| {
            let places = places(pair);
            std::array::from_fn(|read| {
                let (low, share) = between(places[read], nodes);
                (1 + read.min(TABLES - 1) * nodes + low, share)
            })
        });
        Self { problem, nodes, channels, reads: reads.collect() }
    }

    fn unknowns(&self) -> usize {
        1 + TABLES * self.nodes
    }

    /// A base below which lies a share of all values, D that is the mean of what is above it, F and G of 1.
    fn start(&self, share: f64) -> Vec<Vec<f64>> {
        let of_channel = |c: usize| {
            let mut values: Vec<f64> = self.problem.values.iter().map(|v| v[c]).collect();
            values.sort_by(f64::total_cmp);
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a share of a count"
            )]
            let base = values.get((share * values.len() as f64) as usize).copied();
            let base = base.unwrap_or(0.0).max(1e-6);
            let mut sums = vec![[1e-9, 1e-6]; self.nodes];
            for (reads, value) in self.reads.iter().zip(&self.problem.values) {
                let (low, share) = reads[0];
                let near = if share < 0.5 { low - 1 } else { low };
                sums[near][0] += (value[c] - base).max(1e-3 * base);
                sums[near][1] += 1.0;
            }
            let mut logs = vec![0.0; self.unknowns()];
            logs[0] = base.ln();
            for (log, [sum, count]) in logs[1..].iter_mut().zip(sums) {
                *log = (sum / count).ln().clamp(-LIMIT, LIMIT);
            }
            logs
        };
        (0..self.channels).map(of_channel).collect()
    }

    /// Values of a channel, and of its product alone.
    fn evaluate(&self, logs: &[f64]) -> Vec<[f64; 2]> {
        let base = logs[0].exp();
        let value = |reads: &[(usize, f64); READS]| {
            let log: f64 =
                reads.iter().map(|&(low, t)| logs[low] + t * (logs[low + 1] - logs[low])).sum();
            let product = log.min(2.0 * LIMIT).exp();
            [base + product, product]
        };
        self.reads.iter().map(value).collect()
    }

    /// Returns the sum of logarithms of the mean squares that a start leads to, and the unknowns of each channel.
    fn solve(
        &self,
        mut logs: Vec<Vec<f64>>,
        job: &Job<'_>,
    ) -> Result<(f64, Vec<Vec<f64>>), Stopped> {
        for _ in 0..ROUNDS {
            job.check()?;
            let factors = self.mean_squares(&logs).map(|set| set.map(|mean| 1.0 / mean));
            logs = logs
                .into_par_iter()
                .enumerate()
                .map(|(c, logs)| self.descend(c, logs, factors, job))
                .collect();
            job.advance(1);
        }
        job.check()?;
        let means = self.mean_squares(&logs);
        Ok((means.as_flattened().iter().map(|mean| mean.ln()).sum(), logs))
    }

    /// Mean squares of the measures, over channels.
    fn mean_squares(&self, logs: &[Vec<f64>]) -> [[f64; MEASURES]; 2] {
        let found: Vec<Vec<[f64; 2]>> = logs.iter().map(|logs| self.evaluate(logs)).collect();
        let values: Vec<[f64; 3]> = (0..self.reads.len())
            .map(|index| std::array::from_fn(|c| found[c.min(found.len() - 1)][index][0]))
            .collect();
        self.problem.mean_squares(&values)
    }

    /// Levenberg–Marquardt for one channel, with fixed factors of the measures.
    fn descend(
        &self,
        c: usize,
        mut logs: Vec<f64>,
        factors: [[f64; MEASURES]; 2],
        job: &Job<'_>,
    ) -> Vec<f64> {
        let mut damping = 1e-3;
        let mut values = self.evaluate(&logs);
        let mut sum = self.sum(c, &logs, &values, factors);
        for _ in 0..STEPS {
            if job.is_stopped() {
                return logs;
            }
            let (normal, gradient) = self.normal_equations(c, &logs, &values, factors);
            let mut lowered = None;
            for _ in 0..6 {
                if let Some(next) = step(&logs, &normal, &gradient, damping) {
                    let found = self.evaluate(&next);
                    let next_sum = self.sum(c, &next, &found, factors);
                    if next_sum < sum {
                        lowered = Some((next_sum, next, found));
                        damping *= 0.3;
                        break;
                    }
                }
                damping *= 5.0;
            }
            let Some((next_sum, next, found)) = lowered else { return logs };
            let gain = (sum - next_sum) / sum;
            (sum, logs, values) = (next_sum, next, found);
            if gain < CONVERGED {
                return logs;
            }
        }
        logs
    }

    /// The weighted sum of squares of a channel, and how rough its tables are.
    fn sum(
        &self,
        c: usize,
        logs: &[f64],
        values: &[[f64; 2]],
        factors: [[f64; MEASURES]; 2],
    ) -> f64 {
        let mut sum = 0.0;
        self.for_each(c, values, factors, |_, weights, residuals, _| {
            sum += weights.iter().zip(residuals).map(|(w, r)| w * r * r).sum::<f64>();
        });
        let rough: f64 =
            self.bends().map(|at| (logs[at - 1] - 2.0 * logs[at] + logs[at + 1]).powi(2)).sum();
        sum + SMOOTHING * rough
    }

    /// Unknowns that have a neighbour in their table on both sides.
    fn bends(&self) -> impl Iterator<Item = usize> + use<> {
        let nodes = self.nodes;
        (0..TABLES).flat_map(move |table| 1 + table * nodes + 1..(table + 1) * nodes)
    }

    /// Calls back with each pair's index, the weights of its measures, their residuals and slopes.
    fn for_each(
        &self,
        c: usize,
        values: &[[f64; 2]],
        factors: [[f64; MEASURES]; 2],
        mut visit: impl FnMut(usize, [f64; MEASURES], [f64; MEASURES], [f64; MEASURES]),
    ) {
        let problem = self.problem;
        for (index, (found, shares)) in values.iter().zip(&problem.shares).enumerate() {
            let weights =
                std::array::from_fn(|m| shares[0] * factors[0][m] + shares[1] * factors[1][m]);
            let (residuals, slopes) = problem.residuals_and_slopes(index, c, found[0]);
            visit(index, weights, residuals, slopes);
        }
    }

    /// JᵀJ, a lower triangle column by column, and Jᵀr.
    fn normal_equations(
        &self,
        c: usize,
        logs: &[f64],
        values: &[[f64; 2]],
        factors: [[f64; MEASURES]; 2],
    ) -> (Vec<f64>, Vec<f64>) {
        let size = self.unknowns();
        let (mut normal, mut gradient) = (vec![0.0; size * size], vec![0.0; size]);
        let base = logs[0].exp();
        self.for_each(c, values, factors, |index, weights, residuals, slopes| {
            let (mut square, mut cross) = (0.0, 0.0);
            for m in 0..MEASURES {
                square += weights[m] * slopes[m] * slopes[m];
                cross += weights[m] * slopes[m] * residuals[m];
            }
            let product = values[index][1];
            let mut row = [(0, base); 1 + 2 * READS];
            for (read, (low, share)) in self.reads[index].into_iter().enumerate() {
                row[1 + 2 * read] = (low, product * (1.0 - share));
                row[2 + 2 * read] = (low + 1, product * share);
            }
            for (j, b) in row {
                gradient[j] += cross * b;
                for (i, a) in row {
                    if i >= j {
                        normal[j * size + i] += square * a * b;
                    }
                }
            }
        });
        for at in self.bends() {
            let bend = [(at - 1, 1.0), (at, -2.0), (at + 1, 1.0)];
            let value: f64 = bend.iter().map(|&(i, factor)| factor * logs[i]).sum();
            for (j, b) in bend {
                gradient[j] += SMOOTHING * value * b;
                for (i, a) in bend {
                    if i >= j {
                        normal[j * size + i] += SMOOTHING * a * b;
                    }
                }
            }
        }
        (normal, gradient)
    }
}

/// The unknowns after a step, none where the equations have no solution.
fn step(logs: &[f64], normal: &[f64], gradient: &[f64], damping: f64) -> Option<Vec<f64>> {
    let size = logs.len();
    let mut matrix = normal.to_vec();
    for i in 0..size {
        let diagonal = &mut matrix[i * size + i];
        *diagonal += damping * *diagonal + 1e-9;
    }
    let mut change: Vec<f64> = gradient.iter().map(|g| -g).collect();
    CholeskyFactor::new(matrix, size).ok()?.solve(&mut change);
    let moved = logs.iter().zip(&change);
    Some(moved.map(|(log, change)| (log + change.clamp(-2.0, 2.0)).clamp(-LIMIT, LIMIT)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use brdf_job::Cancel;

    /// A channel whose tables are smooth functions of their angle.
    fn channel(base: f64, alpha: f64, nodes: usize) -> FactorChannel {
        let shares = || (0..nodes).map(|i| i as f64 / (nodes - 1) as f64);
        FactorChannel {
            base: base.ln(),
            distribution: shares()
                .map(|u| 2.0 - 2.0 * (FRAC_PI_2 * u * u / alpha).powi(2).ln_1p())
                .collect(),
            fresnel: shares().map(|u| 2.0 * u * u * u).collect(),
            shadowing: shares().map(|u| -u * u).collect(),
        }
    }

    fn planted() -> FactorModel {
        let channels = [(0.2, 0.1), (0.1, 0.15), (0.05, 0.3)];
        FactorModel::new(channels.map(|(base, alpha)| channel(base, alpha, 30)).to_vec())
            .expect("three channels")
    }

    #[test]
    fn a_planted_model_is_found_again() {
        let planted = planted();
        let material = Material::new("planted", &planted);
        let settings =
            FactorModelSettings { nodes: 30, pairs: 2_000, ..FactorModelSettings::default() };
        let found = fit_factor_model(&material, &settings, &Job::new()).expect("not stopped");
        let errors =
            brdf_model::FidelityPairs::new(9, settings.theta_max).measure(&planted, &found);
        assert!(errors.score() < 1e-3, "{errors:?}");
        assert!((found.channels()[0].base.exp() / 0.2 - 1.0).abs() < 0.01, "{found:?}");
        assert_eq!(found.bytes(), 4 * 3 * 91);
    }

    #[test]
    fn models_are_isotropic_and_reciprocal() {
        let model = planted();
        for pair in (PairSampling { count: 200, seed: 1, theta_max: 1.5 }).pairs() {
            let value = model.eval(&pair).g;
            for other in [pair.swapped(), pair.rotated_about_normal(1.0)] {
                assert!((model.eval(&other).g / value - 1.0).abs() < 1e-6, "{pair:?}");
            }
        }
    }

    #[test]
    fn rows_of_one_channel_make_a_grey_model() {
        let rows = SampleSet::draw(
            &planted(),
            &PairSampling { count: 500, seed: 1, theta_max: 1.2 },
            Channels::Luminance,
        );
        let material = Material::from_samples("rows", &rows);
        let settings = FactorModelSettings { nodes: 12, ..FactorModelSettings::default() };
        let model = fit_factor_model(&material, &settings, &Job::new()).expect("not stopped");
        let value = model.eval(&rows.pair(3));
        assert!(model.channels().len() == 1 && value.r.to_bits() == value.b.to_bits());
        assert!((value.g / rows.rgb(3).g - 1.0).abs() < 0.1, "{value:?}");
    }

    #[test]
    fn a_cancelled_fit_says_so() {
        let (planted, cancel) = (planted(), Cancel::new());
        cancel.cancel();
        let job = Job::new().with_cancel(&cancel);
        let settings =
            FactorModelSettings { nodes: 8, pairs: 100, ..FactorModelSettings::default() };
        assert!(fit_factor_model(&Material::new("planted", &planted), &settings, &job).is_err());
    }

    #[test]
    fn tables_of_one_node_are_no_model() {
        assert!(FactorModel::new(vec![channel(0.1, 0.2, 1)]).is_none());
        assert!(FactorModel::new(vec![channel(0.1, 0.2, 4); 2]).is_none());
    }
}
