//! Alternating least squares: the splines over θh, then the coefficients over θd and φd, and again.
//!
//! Both halves of a step see the nodes through sums over the other angle, which are matrix products: a step costs
//! `nodes × terms²` once, however often its equations are swept. Terms are solved one after another
//! (Gauss–Seidel): solved together they fit a little better and cancel each other, which costs bits.

use faer::linalg::matmul::matmul;
use faer::linalg::solvers::{Llt, SolveCore as _};
use faer::{Accum, Conj, Mat, MatMut, MatRef, Par, Side};
use rayon::prelude::*;

use crate::basis::{CubicBasis, Taps};
use crate::nodes::Nodes;
use crate::products::{DifferenceRow, Products, Shape};
use crate::weights::Weights;

/// Times that terms take their turn in each half of a step.
const SWEEPS: usize = 3;
/// Weight of second differences, relative to the mean of the diagonal, where nodes fill the domain.
pub(crate) const ROUGHNESS: f64 = 1e-6;
/// Weight of harmonics of order m: this times m⁴, relative to that of second differences.
const HARMONIC_ROUGHNESS: f64 = 0.1;
/// Columns of a matrix product that are made together: fixed, so that results do not depend on the number of
/// threads.
const COLUMNS: usize = 64;

/// A fit under way.
pub(crate) struct Alternating<'a> {
    nodes: &'a Nodes,
    roughness: f64,
    offsets: [f64; 3],
    pub(crate) products: Products,
    taps: Vec<Taps>,
    rows: Vec<DifferenceRow>,
    /// ln(a + f) of each node.
    targets: Vec<[f64; 3]>,
    weighing: Weights,
    weights: Vec<f64>,
    /// g of each half vector and term.
    half: Vec<f64>,
    /// The other side of each difference vector and term.
    difference: Vec<[f64; 3]>,
}

/// Sums over one side's points, for each point of the other side: of weights times products of two terms, and of
/// weights times terms times what is to be fitted.
struct Sums {
    terms: usize,
    /// The lower triangle of pairs of terms, row by row, for each point.
    products: Vec<f64>,
    /// For each point and term; where terms have channels, those of the target.
    targets: Vec<[f64; 3]>,
}

/// Where the product of two terms stands in a lower triangle.
fn pair_at(a: usize, b: usize) -> usize {
    let (low, high) = (a.min(b), a.max(b));
    high * (high + 1) / 2 + low
}

impl Sums {
    fn pairs(&self) -> usize {
        self.terms * (self.terms + 1) / 2
    }

    /// The sum for two terms at a point.
    fn product(&self, point: usize, a: usize, b: usize) -> f64 {
        self.products[point * self.pairs() + pair_at(a, b)]
    }

    fn target(&self, point: usize, term: usize) -> [f64; 3] {
        self.targets[point * self.terms + term]
    }
}

impl<'a> Alternating<'a> {
    /// Starts with cosines over the axis of θh.
    pub(crate) fn new(nodes: &'a Nodes, shape: Shape, offsets: [f64; 3], roughness: f64) -> Self {
        let harmonics = shape.harmonics();
        let taps = nodes.halves.iter().map(|&theta| shape.half_taps(theta)).collect();
        let rows: Vec<DifferenceRow> = nodes
            .differences
            .par_iter()
            .map(|d| shape.difference_row(&harmonics, d.theta, d.phi))
            .collect();
        let targets = nodes.nodes.iter().map(|node| {
            std::array::from_fn(|c| {
                if c < nodes.channels { (offsets[c] + node.value[c]).ln() } else { 0.0 }
            })
        });
        let half = (0..shape.terms).flat_map(|term| {
            let turns = std::f64::consts::PI * term as f64;
            (0..shape.half.count).map(move |index| (turns * shape.half.place(index)).cos())
        });
        let half = half.collect();
        let difference = vec![[0.0; 3]; shape.terms * shape.difference_len()];
        let weighing = Weights::new(nodes, offsets);
        let mut made = Self {
            nodes,
            roughness,
            offsets,
            targets: targets.collect(),
            weights: weighing.first(nodes),
            weighing,
            half: Vec::new(),
            difference: vec![[0.0; 3]; rows.len() * shape.terms],
            taps,
            rows,
            products: Products { shape, half, difference },
        };
        made.read_half();
        made
    }

    /// Solves for both sides once; `reweigh` weighs nodes by the present errors in between.
    pub(crate) fn step(&mut self, reweigh: bool) {
        self.orthonormalize();
        self.solve_difference();
        if reweigh {
            self.reweigh();
            self.orthonormalize();
            self.solve_difference();
        }
        self.solve_half();
    }

    /// Goes back to these products.
    pub(crate) fn reset(&mut self, products: &Products) {
        self.products = products.clone();
        self.read_half();
        self.read_difference();
    }

    fn terms(&self) -> usize {
        self.products.shape.terms
    }

    fn read_half(&mut self) {
        let terms = self.terms();
        let products = &self.products;
        let read = |taps: &Taps| (0..terms).map(|term| taps.read(products.half_of(term))).collect();
        let rows: Vec<Vec<f64>> = self.taps.iter().map(read).collect();
        self.half = rows.concat();
    }

    fn read_difference(&mut self) {
        let terms = self.terms();
        let products = &self.products;
        let values: Vec<Vec<[f64; 3]>> = self
            .rows
            .par_iter()
            .map(|row| (0..terms).map(|term| row.read(products.difference_of(term))).collect())
            .collect();
        self.difference = values.concat();
    }

    /// Present y of every node.
    fn predictions(&self) -> Vec<[f64; 3]> {
        let terms = self.terms();
        let halves = self.nodes.halves.len();
        let y = |half: usize, difference: usize| {
            let half = &self.half[half * terms..(half + 1) * terms];
            let other = &self.difference[difference * terms..(difference + 1) * terms];
            half.iter().zip(other).fold([0.0; 3], |sum, (half, other)| {
                std::array::from_fn(|c| sum[c] + half * other[c])
            })
        };
        let of = |node: usize| {
            if self.nodes.is_grid { y(node % halves, node / halves) } else { y(node, node) }
        };
        (0..self.nodes.nodes.len()).into_par_iter().map(of).collect()
    }

    /// Sum of the weights of each half vector, or of each difference vector.
    fn totals(&self, of_halves: bool) -> Vec<f64> {
        let halves = self.nodes.halves.len();
        match (self.nodes.is_grid, of_halves) {
            (false, _) => self.weights.clone(),
            (true, false) => self.weights.chunks_exact(halves).map(|w| w.iter().sum()).collect(),
            (true, true) => {
                self.weights.chunks_exact(halves).fold(vec![0.0; halves], |mut sum, w| {
                    sum.iter_mut().zip(w).for_each(|(sum, w)| *sum += w);
                    sum
                })
            }
        }
    }

    /// Weights times the target of a channel, of each node.
    fn weighted_targets(&self, channel: usize) -> Vec<f64> {
        self.weights.iter().zip(&self.targets).map(|(w, y)| w * y[channel]).collect()
    }

    /// Returns, for each point of one side, what nodes add up to: columns of `functions` (one for each point of the
    /// other side) times the nodes' weights.
    fn sum_over_nodes(&self, functions: &[f64], weights: &[f64], over_halves: bool) -> Vec<f64> {
        let (halves, differences) = (self.nodes.halves.len(), self.nodes.differences.len());
        if !self.nodes.is_grid {
            let rows = functions.len() / weights.len();
            let columns = functions.chunks_exact(rows).zip(weights);
            return columns.flat_map(|(column, w)| column.iter().map(move |f| f * w)).collect();
        }
        let weights = MatRef::from_column_major_slice(weights, halves, differences);
        let weights = if over_halves { weights } else { weights.transpose() };
        let rows = functions.len() / weights.nrows();
        let functions = MatRef::from_column_major_slice(functions, rows, weights.nrows());
        let mut sums = vec![0.0; rows * weights.ncols()];
        sums.par_chunks_mut(rows * COLUMNS).enumerate().for_each(|(block, sums)| {
            let columns = sums.len() / rows;
            matmul(
                MatMut::from_column_major_slice_mut(sums, rows, columns),
                Accum::Replace,
                functions,
                weights.subcols(block * COLUMNS, columns),
                1.0,
                Par::Seq,
            );
        });
        sums
    }

    /// Weighs nodes by the present errors.
    ///
    /// Where a channel is 0 and the model is below, it is right: values end at 0.
    fn reweigh(&mut self) {
        let predicted = self.predictions();
        self.weights = self.weighing.next(self.nodes, &predicted);
        for ((target, node), y) in self.targets.iter_mut().zip(&self.nodes.nodes).zip(&predicted) {
            for c in 0..self.nodes.channels {
                if node.value[c] <= 0.0 {
                    target[c] = y[c].min(self.offsets[c].ln());
                }
            }
        }
    }

    /// Makes the splines over θh orthonormal under the weights of the nodes, so that terms have one scale.
    fn orthonormalize(&mut self) {
        let terms = self.terms();
        let totals = self.totals(true);
        let gram = Mat::from_fn(terms, terms, |i, j| {
            let halves = self.half.chunks_exact(terms).zip(&totals);
            let sum: f64 = halves.map(|(half, weight)| weight * half[i] * half[j]).sum();
            if i == j { sum * (1.0 + 1e-10) + 1e-300 } else { sum }
        });
        let Ok(cholesky) = gram.llt(Side::Lower) else { return };
        // g ← L⁻¹ g and C ← Lᵀ C leave Σ g C as it is.
        let lower = cholesky.L();
        let count = self.products.shape.half.count;
        for at in 0..count {
            for i in 0..terms {
                let known: f64 =
                    (0..i).map(|j| lower[(i, j)] * self.products.half[j * count + at]).sum();
                let value = &mut self.products.half[i * count + at];
                *value = (*value - known) / lower[(i, i)];
            }
        }
        let length = self.products.shape.difference_len();
        let before = self.products.difference.clone();
        for j in 0..terms {
            for at in 0..length {
                self.products.difference[j * length + at] = (j..terms).fold([0.0; 3], |sum, i| {
                    let other = before[i * length + at];
                    std::array::from_fn(|c| sum[c] + lower[(i, j)] * other[c])
                });
            }
        }
        self.read_half();
        self.read_difference();
    }

    /// Turns the terms among themselves so that they are ordered by energy and share none.
    pub(crate) fn order_terms(&mut self) {
        self.orthonormalize();
        let terms = self.terms();
        let weights = self.totals(false);
        let energy = Mat::from_fn(terms, terms, |i, j| {
            let points = self.difference.chunks_exact(terms).zip(&weights);
            points
                .map(|(point, weight)| {
                    weight * (0..3).map(|c| point[i][c] * point[j][c]).sum::<f64>()
                })
                .sum::<f64>()
        });
        let Ok(eigen) = energy.self_adjoint_eigen(Side::Lower) else { return };
        // Eigenvalues come in rising order.
        let turn = |new: usize, old: usize| eigen.U()[(old, terms - 1 - new)];
        let count = self.products.shape.half.count;
        let before = self.products.half.clone();
        for new in 0..terms {
            for at in 0..count {
                self.products.half[new * count + at] =
                    (0..terms).map(|old| turn(new, old) * before[old * count + at]).sum();
            }
        }
        let length = self.products.shape.difference_len();
        let before = self.products.difference.clone();
        for new in 0..terms {
            for at in 0..length {
                self.products.difference[new * length + at] =
                    (0..terms).fold([0.0; 3], |sum, old| {
                        let other = before[old * length + at];
                        std::array::from_fn(|c| sum[c] + turn(new, old) * other[c])
                    });
            }
        }
        self.read_half();
        self.read_difference();
    }

    /// Solves for the coefficients over θd and φd.
    pub(crate) fn solve_difference(&mut self) {
        let equations = self.difference_equations();
        for _ in 0..SWEEPS {
            for term in 0..self.terms() {
                self.solve_term(&equations, term);
            }
        }
    }

    /// Returns the equations for the coefficients over θd and φd, given the splines over θh.
    pub(crate) fn difference_equations(&self) -> DifferenceEquations {
        let (terms, shape) = (self.terms(), &self.products.shape);
        let (length, harmonics) = (shape.difference_len(), shape.harmonics());
        let squares: Vec<f64> = self
            .half
            .chunks_exact(terms)
            .flat_map(|g| (0..terms).flat_map(move |a| (0..=a).map(move |b| g[a] * g[b])))
            .collect();
        let products = self.sum_over_nodes(&squares, &self.weights, true);
        let mut targets = vec![[0.0; 3]; self.rows.len() * terms];
        for channel in 0..self.nodes.channels {
            let sums = self.sum_over_nodes(&self.half, &self.weighted_targets(channel), true);
            targets.iter_mut().zip(sums).for_each(|(target, sum)| target[channel] = sum);
        }
        let sums = Sums { terms, products, targets };
        let count = harmonics.len();
        let systems = (0..terms)
            .into_par_iter()
            .map(|term| {
                let mut gram = Mat::<f64>::zeros(length, length);
                add_squares(&mut gram, &self.rows, |point| sums.product(point, term, term));
                let mean = (0..length).map(|i| gram[(i, i)]).sum::<f64>() / length as f64;
                let ridge = self.roughness * mean + f64::MIN_POSITIVE;
                for (harmonic, function) in harmonics.iter().enumerate() {
                    smooth(&mut gram, shape.difference, ridge, |j| j * count + harmonic);
                    let order = function.order as f64;
                    for j in 0..shape.difference.count {
                        let at = j * count + harmonic;
                        gram[(at, at)] += ridge * (HARMONIC_ROUGHNESS * order.powi(4) + 1e-6);
                    }
                }
                gram.llt(Side::Lower).ok()
            })
            .collect();
        DifferenceEquations { sums, systems }
    }

    /// Solves for the coefficients of one term over θd and φd, the others staying as they are.
    fn solve_term(&mut self, equations: &DifferenceEquations, term: usize) {
        if let Some(own) = self.term_solution(equations, term) {
            self.set_difference(term, own);
        }
    }

    fn term_solution(&self, equations: &DifferenceEquations, term: usize) -> Option<Vec<[f64; 3]>> {
        let terms = self.terms();
        let length = self.products.shape.difference_len();
        let system = equations.systems[term].as_ref()?;
        let mut side = vec![[0.0; 3]; length];
        let sums = &equations.sums;
        let rest_at = |point: usize| {
            let others = &self.difference[point * terms..(point + 1) * terms];
            let mut rest = sums.target(point, term);
            for (other, value) in others.iter().enumerate().filter(|(other, _)| *other != term) {
                let product = sums.product(point, term, other);
                for (rest, value) in rest.iter_mut().zip(value) {
                    *rest -= product * value;
                }
            }
            rest
        };
        let points = (0..self.rows.len()).into_par_iter().with_min_len(COLUMNS * 4);
        let rests: Vec<[f64; 3]> = points.map(rest_at).collect();
        for (row, rest) in self.rows.iter().zip(rests) {
            row.add_to(rest, &mut side);
        }
        let channels = self.nodes.channels;
        let mut solution = Mat::from_fn(length, channels, |i, c| side[i][c]);
        system.solve_in_place_with_conj(Conj::No, solution.as_mut());
        let of = |i| std::array::from_fn(|c| if c < channels { solution[(i, c)] } else { 0.0 });
        Some((0..length).map(of).collect())
    }

    fn set_difference(&mut self, term: usize, coefficients: Vec<[f64; 3]>) {
        let (terms, length) = (self.terms(), coefficients.len());
        let own = &mut self.products.difference[term * length..(term + 1) * length];
        own.copy_from_slice(&coefficients);
        for (index, row) in self.rows.iter().enumerate() {
            self.difference[index * terms + term] = row.read(&coefficients);
        }
    }

    /// Returns the integers that coefficients over θd and φd become, in steps of each, and holds those.
    ///
    /// Terms are rounded one after another, so that later ones make up for what rounding did to earlier ones;
    /// within a term, each coefficient likewise for those after it (nearest plane).
    pub(crate) fn round_difference(
        &mut self,
        equations: &DifferenceEquations,
        steps: &[f64],
    ) -> Vec<[i32; 3]> {
        let length = steps.len();
        let mut rounded = vec![[0; 3]; self.terms() * length];
        for term in 0..self.terms() {
            let Some(solution) = self.term_solution(equations, term) else { continue };
            let Some(system) = &equations.systems[term] else { continue };
            let wanted: Vec<[f64; 3]> =
                solution.into_iter().map(|v| to_opponent(v, self.nodes.channels)).collect();
            let own = &mut rounded[term * length..(term + 1) * length];
            for colour in 0..self.nodes.channels {
                let wanted: Vec<f64> = wanted.iter().map(|v| v[colour]).collect();
                let found = nearest_plane(system, &wanted, |i| steps[i]);
                own.iter_mut().zip(found).for_each(|(own, found)| own[colour] = found);
            }
            let held = own.iter().zip(steps).map(|(own, step)| {
                from_opponent(own.map(|v| f64::from(v) * step), self.nodes.channels)
            });
            let held = held.collect();
            self.set_difference(term, held);
        }
        rounded
    }

    /// Solves for the splines over θh.
    pub(crate) fn solve_half(&mut self) {
        let equations = self.half_equations();
        for _ in 0..SWEEPS {
            for term in 0..self.terms() {
                if let Some(own) = self.half_solution(&equations, term) {
                    self.set_half_of(term, &own);
                }
            }
        }
    }

    /// Returns the equations for the splines over θh, given the other side.
    pub(crate) fn half_equations(&self) -> HalfEquations {
        let terms = self.terms();
        let basis = self.products.shape.half;
        let squares: Vec<f64> = self
            .difference
            .chunks_exact(terms)
            .flat_map(|p| {
                let product = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
                (0..terms).flat_map(move |a| (0..=a).map(move |b| product(p[a], p[b])))
            })
            .collect();
        let products = self.sum_over_nodes(&squares, &self.weights, false);
        let mut targets = vec![[0.0; 3]; self.taps.len() * terms];
        for channel in 0..self.nodes.channels {
            let own: Vec<f64> = self.difference.iter().map(|p| p[channel]).collect();
            let sums = self.sum_over_nodes(&own, &self.weighted_targets(channel), false);
            targets.iter_mut().zip(sums).for_each(|(target, sum)| target[0] += sum);
        }
        let sums = Sums { terms, products, targets };
        let systems = (0..terms)
            .into_par_iter()
            .map(|term| {
                let mut gram = Mat::<f64>::zeros(basis.count, basis.count);
                for (point, taps) in self.taps.iter().enumerate() {
                    let weight = sums.product(point, term, term);
                    for (&i, a) in taps.at.iter().zip(taps.weights) {
                        for (&j, b) in taps.at.iter().zip(taps.weights) {
                            gram[(i, j)] += weight * a * b;
                        }
                    }
                }
                let mean = (0..basis.count).map(|i| gram[(i, i)]).sum::<f64>() / basis.count as f64;
                let ridge = self.roughness * mean + f64::MIN_POSITIVE;
                smooth(&mut gram, basis, ridge, |j| j);
                for i in 0..basis.count {
                    gram[(i, i)] += 1e-6 * ridge;
                }
                gram.llt(Side::Lower).ok()
            })
            .collect();
        HalfEquations { sums, systems }
    }

    fn half_solution(&self, equations: &HalfEquations, term: usize) -> Option<Vec<f64>> {
        let (terms, count) = (self.terms(), self.products.shape.half.count);
        let system = equations.systems[term].as_ref()?;
        let mut side = Mat::<f64>::zeros(count, 1);
        let sums = &equations.sums;
        for (point, taps) in self.taps.iter().enumerate() {
            let half = &self.half[point * terms..(point + 1) * terms];
            let others = half.iter().enumerate().filter(|(other, _)| *other != term);
            let known: f64 =
                others.map(|(other, value)| sums.product(point, term, other) * value).sum();
            let rest = sums.target(point, term)[0] - known;
            for (&at, weight) in taps.at.iter().zip(taps.weights) {
                side[(at, 0)] += weight * rest;
            }
        }
        system.solve_in_place_with_conj(Conj::No, side.as_mut());
        Some((0..count).map(|i| side[(i, 0)]).collect())
    }

    fn set_half_of(&mut self, term: usize, coefficients: &[f64]) {
        let (terms, count) = (self.terms(), coefficients.len());
        self.products.half[term * count..(term + 1) * count].copy_from_slice(coefficients);
        for (index, taps) in self.taps.iter().enumerate() {
            self.half[index * terms + term] = taps.read(coefficients);
        }
    }

    /// Returns the integers that the splines over θh become, in a step for each term, and holds those.
    pub(crate) fn round_half(&mut self, equations: &HalfEquations, steps: &[f64]) -> Vec<i32> {
        let mut rounded = Vec::new();
        for (term, &step) in steps.iter().enumerate() {
            let Some(wanted) = self.half_solution(equations, term) else {
                rounded.extend(vec![0; self.products.shape.half.count]);
                continue;
            };
            let Some(system) = &equations.systems[term] else { continue };
            let found = nearest_plane(system, &wanted, |_| step);
            let held: Vec<f64> = found.iter().map(|&v| f64::from(v) * step).collect();
            self.set_half_of(term, &held);
            rounded.extend(found);
        }
        rounded
    }

    /// Root mean square of each term's other side, under the weights.
    pub(crate) fn term_sizes(&self) -> Vec<f64> {
        let terms = self.terms();
        let mut sums = vec![0.0; terms];
        for (point, weight) in self.difference.chunks_exact(terms).zip(self.totals(false)) {
            for (sum, v) in sums.iter_mut().zip(point) {
                *sum += weight * v.iter().map(|v| v * v).sum::<f64>();
            }
        }
        let total: f64 = self.weights.iter().sum();
        sums.into_iter().map(|sum| (sum / total).sqrt()).collect()
    }
}

/// Sums over nodes and factored matrices for the coefficients over θd and φd.
pub(crate) struct DifferenceEquations {
    sums: Sums,
    systems: Vec<Option<Llt<f64>>>,
}

/// Sums over nodes and factored matrices for the splines over θh.
pub(crate) struct HalfEquations {
    sums: Sums,
    systems: Vec<Option<Llt<f64>>>,
}

/// Returns multiples of steps near `wanted` in the norm of the factored matrix: from the last to the first, each
/// makes up for what rounding did to those after it.
fn nearest_plane(system: &Llt<f64>, wanted: &[f64], step: impl Fn(usize) -> f64) -> Vec<i32> {
    let lower = system.L();
    let mut rounded = vec![0; wanted.len()];
    let mut off = vec![0.0; wanted.len()];
    for i in (0..wanted.len()).rev() {
        let column = lower.col(i);
        let owed: f64 = (i + 1..wanted.len()).map(|j| column[j] * off[j]).sum();
        let aim = wanted[i] + owed / column[i];
        let count = (aim / step(i)).round().clamp(-4e6, 4e6);
        #[expect(clippy::cast_possible_truncation, reason = "within the range of an i32")]
        {
            rounded[i] = count as i32;
        }
        off[i] = wanted[i] - count * step(i);
    }
    rounded
}

/// A colour as its mean and two differences, orthonormal; a single channel as it is.
pub(crate) fn to_opponent([r, g, b]: [f64; 3], channels: usize) -> [f64; 3] {
    if channels == 1 {
        return [r, 0.0, 0.0];
    }
    [(r + g + b) / 3_f64.sqrt(), (r - b) / 2_f64.sqrt(), (r - 2.0 * g + b) / 6_f64.sqrt()]
}

/// The colour of [`to_opponent`].
pub(crate) fn from_opponent([mean, warm, magenta]: [f64; 3], channels: usize) -> [f64; 3] {
    if channels == 1 {
        return [mean, 0.0, 0.0];
    }
    let (a, b, c) = (mean / 3_f64.sqrt(), warm / 2_f64.sqrt(), magenta / 6_f64.sqrt());
    [a + b + c, a - 2.0 * c, a - b + c]
}

/// Adds weights times the squares of rows to the lower triangle.
///
/// Rows with the same splines over θd, which follow each other on a grid, are first added up over φd.
fn add_squares(gram: &mut Mat<f64>, rows: &[DifferenceRow], weight: impl Fn(usize) -> f64) {
    let count = rows.first().map_or(0, |row| row.harmonics.len());
    let mut angular = vec![0.0; count * count];
    let mut point = 0;
    for group in rows.chunk_by(|a, b| a.taps == b.taps) {
        angular.fill(0.0);
        for row in group {
            let weight = weight(point);
            for (line, a) in angular.chunks_exact_mut(count).zip(&row.harmonics) {
                for (sum, b) in line.iter_mut().zip(&row.harmonics) {
                    *sum += weight * a * b;
                }
            }
            point += 1;
        }
        let taps = &group[0].taps;
        for (&j, b) in taps.at.iter().zip(taps.weights) {
            for (m, line) in angular.chunks_exact(count).enumerate() {
                let column = gram.col_as_slice_mut(j * count + m);
                for (&i, a) in taps.at.iter().zip(taps.weights).filter(|(i, _)| **i >= j) {
                    let own = &mut column[i * count..(i + 1) * count];
                    own.iter_mut().zip(line).for_each(|(sum, value)| *sum += a * b * value);
                }
            }
        }
    }
}

/// Adds the squares of second differences along a basis to a matrix.
fn smooth(gram: &mut Mat<f64>, basis: CubicBasis, weight: f64, at: impl Fn(usize) -> usize) {
    for middle in 1..basis.count - 1 {
        let stencil = [(middle - 1, 1.0), (middle, -2.0), (middle + 1, 1.0)];
        for (i, a) in stencil {
            for (j, b) in stencil {
                gram[(at(i), at(j))] += weight * a * b;
            }
        }
    }
}
