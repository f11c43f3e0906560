//! Training of neural BRDFs: the rival that stores a small network.
//!
//! Source: A. Sztrajman, G. Rainer, T. Ritschel and T. Weyrich, "Neural BRDF Representation and Importance Sampling",
//! 2021: the network of [`Nbrdf`], the mean of |ln(1 + f̂ cosθi) − ln(1 + f cosθi)|, and Adam (D. Kingma and J. Ba, 2015).
//! Half of the pairs here are around the mirror direction, and the rate falls to 0 along a cosine.

use std::f64::consts::PI;

use brdf_job::{Job, Stopped};
use brdf_model::elementary::{exp, ln};
use brdf_model::{Brdf, Channels, Nbrdf, NbrdfDomain, PairSampling, SampleSet};
use rand_core::{Rng as _, SeedableRng as _};
use rand_xoshiro::SplitMix64;
use rayon::prelude::*;

use crate::error::FitError;
use crate::material::Material;

const INPUTS: usize = 6;
const HIDDEN: usize = 21;
const OUTPUTS: usize = 3;
/// Where the weights and biases of each layer begin.
const FIRST: [usize; 2] = [0, INPUTS * HIDDEN];
const SECOND: [usize; 2] = [FIRST[1] + HIDDEN, FIRST[1] + HIDDEN + HIDDEN * HIDDEN];
const LAST: [usize; 2] = [SECOND[1] + HIDDEN, SECOND[1] + HIDDEN + HIDDEN * OUTPUTS];

/// Samples that go through the network together: their activations stay in the first cache.
const TILE: usize = 64;
/// Tiles whose gradients are added up by one thread. Each sum has a fixed order, so that the number of threads does not
/// matter.
const SHARE: usize = 4;
/// Sums that run side by side, as wide as vectors are.
const LANES: usize = 16;
/// Steps between two questions whether to stop.
const CHECKED: usize = 64;

/// Pairs that tell whether a material is reciprocal, and how far values may differ there beside their sum: formulas and
/// tables of MERL's layout keep a millionth, RGL files differ by percents.
const PROBED: usize = 500;
const RECIPROCAL: f64 = 1e-4;

/// How a neural BRDF is trained.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NetworkSettings {
    /// Steps of Adam.
    pub steps: usize,
    /// Samples of a step, rounded up to whole tiles of 64.
    pub batch: usize,
    /// Rate of the first steps.
    pub rate: f64,
    /// Uniform pairs, and as many around the mirror direction.
    pub pairs: u32,
    /// Largest angle to the normal of those pairs, radians.
    pub theta_max: f64,
    /// Which scramble of the sample sequence, and which weights to start with.
    pub seed: u64,
}

impl Default for NetworkSettings {
    fn default() -> Self {
        Self {
            steps: 60_000,
            batch: 1024,
            rate: 1e-2,
            pairs: 65_536,
            theta_max: 80_f64.to_radians(),
            seed: 1,
        }
    }
}

/// Returns the network that is trained on a material: on pairs that are drawn from it, or on scattered rows.
///
/// Rows are taken to be reciprocal, as the published networks are. A function that is not has a network over
/// the whole circle.
///
/// ```
/// use brdf_fit::{Material, NetworkSettings, train_network};
/// use brdf_job::Job;
/// use brdf_model::{FidelityPairs, Preset};
///
/// let clay = Preset::find("lafortune-clay").expect("a preset").brdf();
/// let settings = NetworkSettings { steps: 500, pairs: 2_000, ..NetworkSettings::default() };
/// let network = train_network(&Material::new("clay", &clay), &settings, &Job::new())?;
/// let pairs = FidelityPairs::new(9, settings.theta_max);
/// assert!(pairs.measure(&clay, &network).uniform.log_cosine < 0.02);
/// # Ok::<(), brdf_fit::FitError>(())
/// ```
///
/// # Errors
///
/// [`FitError::NothingToCompare`] without a sample; [`FitError::Stopped`].
pub fn train_network(
    material: &Material<'_>,
    settings: &NetworkSettings,
    job: &Job<'_>,
) -> Result<Nbrdf, FitError> {
    let samples = training_samples(material, settings);
    if samples.is_empty() {
        return Err(FitError::NothingToCompare {
            name: material.name().to_owned(),
            dropped: samples.dropped().to_string(),
        });
    }
    let mut rng = SplitMix64::seed_from_u64(settings.seed);
    let is_reciprocal = material.samples().is_some() || is_reciprocal(material.brdf(), &samples);
    let domain = if is_reciprocal { NbrdfDomain::HalfCircle } else { NbrdfDomain::WholeCircle };
    let tiles = Tile::of(&samples, domain, &mut rng);
    let weights = train(&tiles, settings, &mut rng, job)?;
    Ok(Nbrdf::new(&weights)?.over(domain))
}

/// Whether exchanging the directions changes no value by more than rounding, at the first pairs.
fn is_reciprocal(brdf: &dyn Brdf, samples: &SampleSet) -> bool {
    samples.pairs().take(PROBED).all(|pair| {
        let [a, b] = [brdf.eval(&pair), brdf.eval(&pair.swapped())].map(|value| value.channels());
        a.iter().zip(b).all(|(a, b)| (a - b).abs() <= RECIPROCAL * (a + b))
    })
}

/// Uniform pairs and pairs around the mirror direction, or rows.
fn training_samples(material: &Material<'_>, settings: &NetworkSettings) -> SampleSet {
    if let Some(rows) = material.samples() {
        return rows.within(settings.theta_max);
    }
    let (count, seed, theta_max) = (settings.pairs, settings.seed, settings.theta_max);
    let sampling = PairSampling { count, seed, theta_max };
    let reference = material.channels().of(material.brdf());
    let mut samples = SampleSet::draw(&*reference, &sampling, Channels::Rgb);
    for pair in sampling.highlight_pairs().filter(|pair| reference.has_data(pair)) {
        samples.push_clamped(&pair, reference.eval_unclamped(&pair));
    }
    samples
}

/// Samples beside each other: inputs, cosines and wanted values ln(1 + f cosθi), one array for each.
struct Tile {
    inputs: [[f32; TILE]; INPUTS],
    cosines: [f32; TILE],
    wanted: [[f32; TILE]; OUTPUTS],
}

impl Tile {
    /// Tiles of samples in random order; the last one is filled up from the first samples.
    #[expect(clippy::cast_possible_truncation, reason = "networks are trained in f32")]
    fn of(samples: &SampleSet, domain: NbrdfDomain, rng: &mut SplitMix64) -> Vec<Self> {
        let samples = samples.shuffled(rng.next_u64());
        let tile = |index: usize| {
            let mut tile = Self {
                inputs: [[0.0; TILE]; INPUTS],
                cosines: [0.0; TILE],
                wanted: [[0.0; TILE]; OUTPUTS],
            };
            for lane in 0..TILE {
                let sample = (index * TILE + lane) % samples.len();
                let pair = samples.pair(sample);
                for (input, value) in tile.inputs.iter_mut().zip(domain.input(&pair)) {
                    input[lane] = value;
                }
                tile.cosines[lane] = pair.wi.z as f32;
                let values = samples.rgb(sample).channels();
                for (wanted, value) in tile.wanted.iter_mut().zip(values) {
                    wanted[lane] = (value * pair.wi.z).ln_1p() as f32;
                }
            }
            tile
        };
        (0..samples.len().div_ceil(TILE)).map(tile).collect()
    }
}

/// Steps of Adam over tiles in random order.
fn train(
    tiles: &[Tile],
    settings: &NetworkSettings,
    rng: &mut SplitMix64,
    job: &Job<'_>,
) -> Result<Vec<f32>, Stopped> {
    job.begin("training", settings.steps as u64);
    let mut weights = first_weights(rng);
    let mut adam = Adam::new();
    let size = settings.batch.div_ceil(TILE).clamp(1, tiles.len());
    let mut order: Vec<usize> = Vec::new();
    for step in 0..settings.steps {
        if step % CHECKED == 0 {
            job.check()?;
            job.advance(CHECKED as u64);
        }
        if order.len() < size {
            order = (0..tiles.len()).collect();
            shuffle(&mut order, rng);
        }
        let batch = order.split_off(order.len() - size);
        let parts: Vec<Box<Gradient>> = batch
            .par_chunks(SHARE)
            .map(|share| {
                let mut gradient = Box::new(Gradient { values: [0.0; Nbrdf::WEIGHTS] });
                let work =
                    Backpropagate { weights: &weights, tiles, share, gradient: &mut gradient };
                pulp::Arch::new().dispatch(work);
                gradient
            })
            .collect();
        let mut sum = [0.0; Nbrdf::WEIGHTS];
        for part in &parts {
            for (sum, value) in sum.iter_mut().zip(&part.values) {
                *sum += value;
            }
        }
        let done = step as f64 / settings.steps as f64;
        let rate = 0.5 * settings.rate * (1.0 + (PI * done).cos());
        let terms = (size * TILE * OUTPUTS) as f64;
        adam.step(&mut weights, &sum, rate, terms);
    }
    Ok(weights.to_vec())
}

fn shuffle(order: &mut [usize], rng: &mut SplitMix64) {
    for last in (1..order.len()).rev() {
        #[expect(clippy::cast_possible_truncation, reason = "a remainder of a count")]
        order.swap(last, (rng.next_u64() % (last as u64 + 1)) as usize);
    }
}

/// Uniform weights within √(6 / (inputs + outputs)) (X. Glorot and Y. Bengio, 2010), biases of 0.
fn first_weights(rng: &mut SplitMix64) -> [f32; Nbrdf::WEIGHTS] {
    let mut weights = [0.0; Nbrdf::WEIGHTS];
    let layers = [(FIRST, INPUTS + HIDDEN), (SECOND, 2 * HIDDEN), (LAST, HIDDEN + OUTPUTS)];
    for ([begin, end], sides) in layers {
        let limit = (6.0 / sides as f64).sqrt();
        for weight in &mut weights[begin..end] {
            let unit = (rng.next_u64() >> 11) as f64 / 9_007_199_254_740_992.0;
            #[expect(clippy::cast_possible_truncation, reason = "networks are trained in f32")]
            let value = (limit * (2.0 * unit - 1.0)) as f32;
            *weight = value;
        }
    }
    weights
}

/// Running means of gradients and of their squares.
struct Adam {
    first: [f64; Nbrdf::WEIGHTS],
    second: [f64; Nbrdf::WEIGHTS],
    powers: [f64; 2],
}

impl Adam {
    /// How much of the running means stays, the usual values.
    const DECAYS: [f64; 2] = [0.9, 0.999];

    fn new() -> Self {
        Self { first: [0.0; Nbrdf::WEIGHTS], second: [0.0; Nbrdf::WEIGHTS], powers: [1.0; 2] }
    }

    /// Moves weights against a gradient that is the sum over so many terms. A gradient that is not finite is left out.
    fn step(
        &mut self,
        weights: &mut [f32; Nbrdf::WEIGHTS],
        sum: &[f32; Nbrdf::WEIGHTS],
        rate: f64,
        terms: f64,
    ) {
        if sum.iter().any(|value| !value.is_finite()) {
            return;
        }
        let [a, b] = Self::DECAYS;
        self.powers = [self.powers[0] * a, self.powers[1] * b];
        let [first_scale, second_scale] = self.powers.map(|power| 1.0 / (1.0 - power));
        let means = self.first.iter_mut().zip(&mut self.second);
        for ((weight, sum), (first, second)) in weights.iter_mut().zip(sum).zip(means) {
            let slope = f64::from(*sum) / terms;
            *first = a * *first + (1.0 - a) * slope;
            *second = b * *second + (1.0 - b) * slope * slope;
            let step = rate * first_scale * *first / ((second_scale * *second).sqrt() + 1e-8);
            #[expect(clippy::cast_possible_truncation, reason = "networks are trained in f32")]
            let moved = (f64::from(*weight) - step) as f32;
            *weight = moved;
        }
    }
}

/// Sums of slopes of the loss with respect to each weight.
struct Gradient {
    values: [f32; Nbrdf::WEIGHTS],
}

/// Adds the gradient of some tiles, compiled once for each instruction set.
struct Backpropagate<'a> {
    weights: &'a [f32; Nbrdf::WEIGHTS],
    tiles: &'a [Tile],
    share: &'a [usize],
    gradient: &'a mut Gradient,
}

impl pulp::NullaryFnOnce for Backpropagate<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { weights, tiles, share, gradient } = self;
        for &index in share {
            let tile = &tiles[index];
            let mut one = [[0.0; TILE]; HIDDEN];
            let mut two = [[0.0; TILE]; HIDDEN];
            let mut out = [[0.0; TILE]; OUTPUTS];
            forward(weights, FIRST, &tile.inputs, &mut one);
            rectify(&mut one);
            forward(weights, SECOND, &one, &mut two);
            rectify(&mut two);
            forward(weights, LAST, &two, &mut out);
            slopes_of_loss(tile, &mut out);

            let mut behind_two = [[0.0; TILE]; HIDDEN];
            let mut behind_one = [[0.0; TILE]; HIDDEN];
            add_products(&mut gradient.values, LAST, &two, &out);
            backward(weights, LAST, &out, &two, &mut behind_two);
            add_products(&mut gradient.values, SECOND, &one, &behind_two);
            backward(weights, SECOND, &behind_two, &one, &mut behind_one);
            add_products(&mut gradient.values, FIRST, &tile.inputs, &behind_one);
        }
    }
}

/// Biases plus weights times inputs.
#[inline(always)]
fn forward<const IN: usize, const OUT: usize>(
    weights: &[f32; Nbrdf::WEIGHTS],
    [begin, biases]: [usize; 2],
    inputs: &[[f32; TILE]; IN],
    out: &mut [[f32; TILE]; OUT],
) {
    for (j, sums) in out.iter_mut().enumerate() {
        let mut total = [weights[biases + j]; TILE];
        for (i, input) in inputs.iter().enumerate() {
            let weight = weights[begin + i * OUT + j];
            for lane in 0..TILE {
                total[lane] += weight * input[lane];
            }
        }
        *sums = total;
    }
}

#[inline(always)]
fn rectify(layer: &mut [[f32; TILE]; HIDDEN]) {
    for value in layer.as_flattened_mut() {
        *value = value.max(0.0);
    }
}

/// Replaces outputs z by the slopes of |ln(1 + (e^z − 1) cosθi) − wanted| with respect to them.
#[inline(always)]
fn slopes_of_loss(tile: &Tile, out: &mut [[f32; TILE]; OUTPUTS]) {
    for (outputs, wanted) in out.iter_mut().zip(&tile.wanted) {
        for lane in 0..TILE {
            let (power, cosine) = (exp(outputs[lane]), tile.cosines[lane]);
            let shifted = 1.0 + (power - 1.0) * cosine;
            let sign = if ln(shifted) > wanted[lane] { 1.0 } else { -1.0 };
            outputs[lane] = sign * power * cosine / shifted;
        }
    }
}

/// Slopes with respect to a layer's inputs, 0 where an input was rectified.
#[inline(always)]
fn backward<const IN: usize, const OUT: usize>(
    weights: &[f32; Nbrdf::WEIGHTS],
    [begin, _]: [usize; 2],
    slopes: &[[f32; TILE]; OUT],
    inputs: &[[f32; TILE]; IN],
    behind: &mut [[f32; TILE]; IN],
) {
    for (i, (sums, input)) in behind.iter_mut().zip(inputs).enumerate() {
        let mut total = [0.0; TILE];
        for (j, slope) in slopes.iter().enumerate() {
            let weight = weights[begin + i * OUT + j];
            for lane in 0..TILE {
                total[lane] += weight * slope[lane];
            }
        }
        for lane in 0..TILE {
            sums[lane] = if input[lane] > 0.0 { total[lane] } else { 0.0 };
        }
    }
}

/// Adds what a layer's weights and biases gain from inputs and slopes.
#[inline(always)]
fn add_products<const IN: usize, const OUT: usize>(
    gradient: &mut [f32; Nbrdf::WEIGHTS],
    [begin, biases]: [usize; 2],
    inputs: &[[f32; TILE]; IN],
    slopes: &[[f32; TILE]; OUT],
) {
    for (i, input) in inputs.iter().enumerate() {
        for (j, slope) in slopes.iter().enumerate() {
            gradient[begin + i * OUT + j] += dot(input, slope);
        }
    }
    let ones = [1.0; TILE];
    for (j, slope) in slopes.iter().enumerate() {
        gradient[biases + j] += dot(&ones, slope);
    }
}

/// A sum of products in [`LANES`] parts, so that all instruction sets add in the same order.
#[inline(always)]
fn dot(a: &[f32; TILE], b: &[f32; TILE]) -> f32 {
    let mut sums = [0.0; LANES];
    for (a, b) in a.as_chunks::<LANES>().0.iter().zip(b.as_chunks::<LANES>().0) {
        for lane in 0..LANES {
            sums[lane] += a[lane] * b[lane];
        }
    }
    let mut width = LANES;
    while width > 1 {
        width /= 2;
        for lane in 0..width {
            sums[lane] += sums[lane + width];
        }
    }
    sums[0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use brdf_job::Cancel;
    use brdf_model::{FidelityPairs, Preset};

    fn few() -> NetworkSettings {
        NetworkSettings { steps: 300, batch: 512, pairs: 2_000, ..NetworkSettings::default() }
    }

    /// Oracle: slopes by differences of the loss, in which a forward pass is all there is.
    #[test]
    fn slopes_are_those_of_the_loss() {
        let clay = Preset::find("lafortune-clay").expect("a preset").brdf();
        let settings = NetworkSettings { pairs: 40, ..few() };
        let samples = training_samples(&Material::new("clay", &clay), &settings);
        let mut rng = SplitMix64::seed_from_u64(3);
        let tiles = Tile::of(&samples, NbrdfDomain::WholeCircle, &mut rng);
        let weights = first_weights(&mut rng);
        let mut gradient = Gradient { values: [0.0; Nbrdf::WEIGHTS] };
        let share = [0];
        pulp::Arch::new().dispatch(Backpropagate {
            weights: &weights,
            tiles: &tiles,
            share: &share,
            gradient: &mut gradient,
        });
        let loss = |weights: &[f32; Nbrdf::WEIGHTS]| {
            let (mut one, mut two) = ([[0.0; TILE]; HIDDEN], [[0.0; TILE]; HIDDEN]);
            let mut out = [[0.0; TILE]; OUTPUTS];
            forward(weights, FIRST, &tiles[0].inputs, &mut one);
            rectify(&mut one);
            forward(weights, SECOND, &one, &mut two);
            rectify(&mut two);
            forward(weights, LAST, &two, &mut out);
            let terms = out.iter().zip(&tiles[0].wanted).flat_map(|(out, wanted)| {
                (0..TILE).map(|lane| {
                    let value = f64::from(out[lane]).exp_m1() * f64::from(tiles[0].cosines[lane]);
                    (value.ln_1p() - f64::from(wanted[lane])).abs()
                })
            });
            terms.sum::<f64>()
        };
        for index in
            [0, 40, FIRST[1] + 3, SECOND[0] + 100, SECOND[1] + 5, LAST[0] + 10, LAST[1] + 2]
        {
            let moved = |by: f32| {
                let mut weights = weights;
                weights[index] += by;
                loss(&weights)
            };
            let slope = (moved(1e-3) - moved(-1e-3)) / 2e-3;
            let found = f64::from(gradient.values[index]);
            assert!((found - slope).abs() < 0.03 * slope.abs() + 0.05, "{index}: {found}, {slope}");
        }
    }

    #[test]
    fn any_number_of_threads_makes_the_same_network() {
        let clay = Preset::find("lafortune-clay").expect("a preset").brdf();
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.expect("threads").install(|| {
                train_network(&Material::new("clay", &clay), &few(), &Job::new())
                    .expect("a network")
            })
        };
        assert_eq!(on(1), on(3));
    }

    #[test]
    fn training_finds_gloss_and_keeps_what_is_not_reciprocal() {
        struct Uneven;
        impl Brdf for Uneven {
            fn eval(&self, pair: &brdf_param::DirectionPair) -> brdf_model::Rgb {
                brdf_model::Rgb::splat(0.1 + 0.3 * pair.wi.z)
            }
        }
        let settings = NetworkSettings { steps: 1500, ..few() };
        let judge = FidelityPairs::new(9, settings.theta_max);
        let uneven = train_network(&Material::new("uneven", &Uneven), &settings, &Job::new());
        let errors = judge.measure(&Uneven, &uneven.expect("a network"));
        assert!(errors.uniform.cosine_relative < 0.05, "{errors:?}");
        let plastic = Preset::find("red-plastic").expect("a preset").brdf();
        let network = train_network(&Material::new("plastic", &plastic), &settings, &Job::new());
        let errors = judge.measure(&plastic, &network.expect("a network"));
        assert!(errors.highlight.log_cosine < 0.05, "{errors:?}");
    }

    #[test]
    fn a_cancelled_training_says_so() {
        let clay = Preset::find("lafortune-clay").expect("a preset").brdf();
        let cancel = Cancel::new();
        cancel.cancel();
        let job = Job::new().with_cancel(&cancel);
        let found = train_network(&Material::new("clay", &clay), &few(), &job);
        assert!(matches!(found, Err(FitError::Stopped(_))));
    }

    #[test]
    fn nothing_makes_no_network() {
        let nothing = SampleSet::new(Channels::Rgb);
        let material = Material::from_samples("nothing", &nothing);
        let found = train_network(&material, &few(), &Job::new());
        assert!(matches!(found, Err(FitError::NothingToCompare { .. })));
    }
}
