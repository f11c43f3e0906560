//! Material maps by turns: maps for given products, then products for given maps.
//!
//! Products are refined by Gauss–Newton steps, one product and channel at a time: with m = c e^g and g
//! linear in the log texels, the linear residual r changes as m δg does, so that log texels follow from
//! least squares with weights m² and targets g + r / m.

use std::sync::Arc;

use brdf_factor::{ChannelTransform, Columns, NormalEquations};
use brdf_job::Job;
use faer::MatMut;
use rayon::prelude::*;

use crate::coefficient_map::{CoefficientMap, nearest, read};
use crate::layout::{Layout, Part, predicted};
use crate::least_squares::MapProblem;
use crate::{PaintError, PaintParams, PaintSamples, paper};

/// Samples that products are refined on.
const THIN: usize = 100_000;
/// Turns from every start, and more from the better one.
const FIRST_TURNS: usize = 2;
const TURNS: usize = 8;
/// Gauss–Newton sweeps over all products in a turn.
const SWEEPS: usize = 2;
/// A turn that lowers the error by less than this share of it is the last.
const LEAST_GAIN: f64 = 2e-3;
/// No log value is asked to change by more than this in a step.
const LONGEST: f64 = 2.0;

/// Products and maps.
#[derive(Clone)]
struct State {
    /// Log texels of each product, `[channel][unknown]`.
    solutions: Vec<Vec<f64>>,
    maps: Vec<Vec<f32>>,
    /// Mean squared error over all samples.
    error: f64,
}

pub(crate) fn decompose(
    layout: &Layout,
    samples: &PaintSamples,
    params: &PaintParams,
    job: &Job<'_>,
) -> Result<Vec<Part>, PaintError> {
    let [by_paper, clusters, first, second, last] = job.split([1.0, 1.0, 2.0, 2.0, 6.0]);
    let turns = Turns::new(layout, samples, params);
    let published = paper::decompose(layout, samples, params, &by_paper)?;
    let published = turns.state(
        published.iter().map(|part| part.solution.clone()).collect(),
        published.into_iter().map(|part| part.coefficients).collect(),
    );
    clusters.begin("clusters", 1);
    let clustered = turns.clustered()?;
    let mut best: Option<State> = None;
    for (start, job) in [(published, &first), (clustered, &second)] {
        let state = turns.run(start, FIRST_TURNS, job);
        if best.as_ref().is_none_or(|best| state.error < best.error) {
            best = Some(state);
        }
    }
    let Some(best) = best else { return Ok(Vec::new()) };
    let State { solutions, maps, .. } = turns.run(best, TURNS, &last);
    let parts = solutions.into_iter().zip(maps);
    Ok(parts.map(|(solution, coefficients)| Part { solution, coefficients }).collect())
}

/// What all turns share.
struct Turns<'a> {
    layout: &'a Layout,
    samples: &'a PaintSamples,
    params: &'a PaintParams,
    known: Vec<bool>,
    /// Columns of the samples that products are refined on, and the place of each among all.
    columns: Vec<Arc<Columns>>,
    places: Vec<usize>,
}

impl<'a> Turns<'a> {
    fn new(layout: &'a Layout, samples: &'a PaintSamples, params: &'a PaintParams) -> Self {
        let (thin, columns) = layout.subset(THIN);
        let places = thin.origin().to_vec();
        Self { layout, samples, params, known: layout.touched(params.map_size), columns, places }
    }

    fn state(&self, solutions: Vec<Vec<f64>>, maps: Vec<Vec<f32>>) -> State {
        let values: Vec<_> = solutions.iter().map(|x| self.layout.values(x)).collect();
        let error = self.error(&values, &maps);
        State { solutions, maps, error }
    }

    /// Mean squared error over all samples and channels.
    fn error(&self, values: &[Vec<[f32; 3]>], maps: &[Vec<f32>]) -> f64 {
        const RUN: usize = 4096;
        let taps = self.layout.taps.par_chunks(RUN).enumerate();
        let sums: Vec<f64> = taps
            .map(|(run, taps)| {
                let mut sum = 0.0;
                for (at, taps) in taps.iter().enumerate().map(|(i, taps)| (run * RUN + i, taps)) {
                    let mut left = self.samples.values[at];
                    for (value, map) in values.iter().zip(maps) {
                        let c = read(map, taps);
                        left.iter_mut().zip(value[at]).for_each(|(left, v)| *left -= c * v);
                    }
                    sum += left.iter().map(|v| f64::from(v * v)).sum::<f64>();
                }
                sum
            })
            .collect();
        let count = (3 * self.samples.len()) as f64;
        sums.iter().sum::<f64>() / count
    }

    /// The best state of some turns, fewer if the job is stopped; never worse than the first.
    fn run(&self, start: State, turns: usize, job: &Job<'_>) -> State {
        job.begin("taking turns", turns as u64);
        let (mut best, mut state) = (start.clone(), start);
        for turn in 0..turns {
            if job.is_stopped() {
                break;
            }
            job.rename(format!("turn {}, error {:.4}", turn + 1, best.error.sqrt()));
            job.advance(1);
            self.refine_products(&mut state);
            let values: Vec<_> = state.solutions.iter().map(|x| self.layout.values(x)).collect();
            let problem = MapProblem {
                taps: &self.layout.taps,
                wanted: &self.samples.values,
                products: &values,
                size: self.params.map_size,
                wraps: self.params.wraps,
            };
            problem.improve(&mut state.maps);
            for values in &mut state.maps {
                let (size, wraps) = (self.params.map_size, self.params.wraps);
                let mut map = CoefficientMap { size, wraps, values: std::mem::take(values) };
                map.fill(&self.known);
                *values = map.values;
            }
            state.error = self.error(&values, &state.maps);
            let gain = 1.0 - state.error / best.error.max(f64::MIN_POSITIVE);
            if gain > 0.0 {
                best = state.clone();
            }
            if gain < LEAST_GAIN {
                break;
            }
        }
        best
    }

    /// One product for each cluster of texels of similar colour.
    fn clustered(&self) -> Result<State, PaintError> {
        const CELLS: usize = 64;
        let cell = |place| nearest(CELLS, self.params.wraps, place);
        let cells: Vec<usize> = self.samples.places.iter().map(|place| cell(*place)).collect();
        let mut sums = vec![([0.0_f64; 3], 0.0_f64); CELLS * CELLS];
        for (cell, value) in cells.iter().zip(&self.samples.values) {
            let (sum, count) = &mut sums[*cell];
            sum.iter_mut().zip(value).for_each(|(sum, v)| *sum += f64::from(v.sqrt()));
            *count += 1.0;
        }
        let colours = sums.iter().map(|(sum, count)| (sum.map(|v| v / count.max(1.0)), *count));
        let cluster = cluster_colours(&colours.collect::<Vec<_>>(), self.params.products);
        let of_sample: Vec<usize> = cells.iter().map(|cell| cluster[*cell]).collect();
        let mut solutions = Vec::with_capacity(self.params.products);
        for product in 0..self.params.products {
            let weights: Vec<f64> = self
                .places
                .iter()
                .map(|place| if of_sample[*place] == product { 1.0 } else { 0.0 })
                .collect();
            let targets: Vec<Vec<f64>> = (0..3)
                .map(|channel| {
                    let map = &self.layout.maps[channel];
                    let value = |place: &usize| f64::from(self.samples.values[*place][channel]);
                    self.places.iter().map(|place| map.forward(value(place))).collect()
                })
                .collect();
            solutions.push(solve(&self.columns, &weights, &targets)?.concat());
        }
        let size = self.params.map_size;
        let maps = (0..self.params.products)
            .map(|product| {
                let of = |texel: usize| {
                    let (column, row) = (texel % size * CELLS / size, texel / size * CELLS / size);
                    if cluster[row * CELLS + column] == product { 1.0 } else { 0.0 }
                };
                (0..size * size).map(of).collect()
            })
            .collect();
        Ok(self.state(solutions, maps))
    }

    fn refine_products(&self, state: &mut State) {
        let unknowns = self.layout.inverted.unknowns();
        let shares: Vec<Vec<f64>> = state
            .maps
            .iter()
            .map(|map| {
                let of = |place: &usize| f64::from(read(map, &self.layout.taps[*place]));
                self.places.iter().map(of).collect()
            })
            .collect();
        let refined: Vec<Vec<Vec<f64>>> = (0..3)
            .into_par_iter()
            .map(|channel| {
                let own = |x: &Vec<f64>| x[channel * unknowns..][..unknowns].to_vec();
                let mut products: Vec<Vec<f64>> = state.solutions.iter().map(own).collect();
                let wanted =
                    self.places.iter().map(|place| f64::from(self.samples.values[*place][channel]));
                let channel = Channel {
                    columns: &self.columns,
                    map: self.layout.maps[channel],
                    shares: &shares,
                    wanted: wanted.collect(),
                };
                channel.refine(&mut products);
                products
            })
            .collect();
        for (product, solution) in state.solutions.iter_mut().enumerate() {
            *solution = refined.iter().flat_map(|channel| channel[product].clone()).collect();
        }
    }
}

/// A channel of all products on the samples that they are refined on.
struct Channel<'a> {
    columns: &'a [Arc<Columns>],
    map: ChannelTransform,
    /// Of each product, what the maps give the samples.
    shares: &'a [Vec<f64>],
    wanted: Vec<f64>,
}

impl Channel<'_> {
    fn refine(&self, products: &mut [Vec<f64>]) {
        let mut logs: Vec<Vec<f64>> = products.iter().map(|x| predicted(self.columns, x)).collect();
        let mut left = self.wanted.clone();
        for (product, logs) in logs.iter().enumerate() {
            self.take(&mut left, product, logs, -1.0);
        }
        for _ in 0..SWEEPS {
            for product in 0..products.len() {
                // Where slopes differ too much for the arithmetic, the product stays as it is.
                let Ok(step) = self.step(product, &logs[product], &left) else { continue };
                let error = |left: &[f64]| left.iter().map(|v| v * v).sum::<f64>();
                let before = error(&left);
                let old = &products[product];
                for share in [1.0, 0.5, 0.25, 0.1] {
                    let tried: Vec<f64> =
                        old.iter().zip(&step).map(|(old, new)| old + share * (new - old)).collect();
                    let tried_logs = predicted(self.columns, &tried);
                    let mut tried_left = left.clone();
                    self.take(&mut tried_left, product, &logs[product], 1.0);
                    self.take(&mut tried_left, product, &tried_logs, -1.0);
                    if error(&tried_left) < before {
                        (products[product], logs[product], left) = (tried, tried_logs, tried_left);
                        break;
                    }
                }
            }
        }
    }

    /// Adds a multiple of a product to values.
    fn take(&self, values: &mut [f64], product: usize, logs: &[f64], sign: f64) {
        for ((value, share), log) in values.iter_mut().zip(&self.shares[product]).zip(logs) {
            *value += sign * share * self.map.inverse(*log).max(0.0);
        }
    }

    /// Log texels of a product by a Gauss–Newton step.
    fn step(&self, product: usize, logs: &[f64], left: &[f64]) -> Result<Vec<f64>, PaintError> {
        let slopes = self.shares[product].iter().zip(logs);
        let slopes = slopes.map(|(share, log)| share * self.map.slope(*log));
        let (weights, targets): (Vec<f64>, Vec<f64>) = slopes
            .zip(logs)
            .zip(left)
            .map(|((slope, log), left)| {
                let change = if slope == 0.0 { 0.0 } else { left / slope };
                (slope * slope, log + change.clamp(-LONGEST, LONGEST))
            })
            .unzip();
        let mut solved = solve(self.columns, &weights, &[targets])?;
        Ok(solved.swap_remove(0))
    }
}

/// Weighted least squares, smoothed as the columns are.
fn solve(
    columns: &[Arc<Columns>],
    weights: &[f64],
    targets: &[Vec<f64>],
) -> Result<Vec<Vec<f64>>, PaintError> {
    let equations = NormalEquations::new(columns.to_vec(), weights);
    let factor = equations.factorize(Vec::new())?;
    let unknowns = equations.unknowns();
    let sides = targets.iter().map(|targets| {
        let weighted: Vec<f64> = targets.iter().zip(weights).map(|(t, w)| t * w).collect();
        let (mut side, mut start) = (vec![0.0; unknowns], 0);
        for columns in columns {
            columns.add_transposed(&weighted, &mut side[start..][..columns.unknowns()]);
            start += columns.unknowns();
        }
        factor.solve_in_place(MatMut::from_column_major_slice_mut(&mut side, unknowns, 1));
        side
    });
    Ok(sides.collect())
}

/// A cluster for each colour with its weight: seeds far from each other, then Lloyd's iteration.
fn cluster_colours(colours: &[([f64; 3], f64)], count: usize) -> Vec<usize> {
    let distance = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum();
    let heaviest = colours.iter().max_by(|a, b| a.1.total_cmp(&b.1));
    let mut centres: Vec<[f64; 3]> = heaviest.map(|(colour, _)| *colour).into_iter().collect();
    while centres.len() < count && !centres.is_empty() {
        let apart = |colour: &[f64; 3]| -> f64 {
            centres.iter().map(|centre| distance(colour, centre)).fold(f64::INFINITY, f64::min)
        };
        let badly = |(colour, weight): &([f64; 3], f64)| weight.sqrt() * apart(colour);
        let worst = colours.iter().max_by(|a, b| badly(a).total_cmp(&badly(b)));
        centres.extend(worst.map(|(colour, _)| *colour));
    }
    let nearest = |centres: &[[f64; 3]], colour: &[f64; 3]| -> usize {
        let all = centres.iter().map(|centre| -> f64 { distance(colour, centre) }).enumerate();
        all.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(at, _)| at)
    };
    for _ in 0..20 {
        let mut sums = vec![([0.0; 3], 0.0); centres.len()];
        for (colour, weight) in colours {
            let (sum, total) = &mut sums[nearest(&centres, colour)];
            sum.iter_mut().zip(colour).for_each(|(sum, v)| *sum += weight * v);
            *total += weight;
        }
        for (centre, (sum, total)) in centres.iter_mut().zip(sums) {
            if total > 0.0 {
                *centre = sum.map(|v| v / total);
            }
        }
    }
    colours.iter().map(|(colour, _)| nearest(&centres, colour)).collect()
}
