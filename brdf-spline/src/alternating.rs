//! Alternating least squares: the splines over θh, then the coefficients over θd and φd, and again.
//!
//! Both halves of a step see the nodes through sums over the other angle, which are matrix products: a step costs
//! `nodes × terms²` once, however often its equations are swept. Terms are solved one after another
//! (Gauss–Seidel): solved together they fit a little better and cancel each other, which costs bits. Colours are a mean
//! and two differences throughout: under weights that all share, least squares for one do not see the others.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, MatRef, Par, Side};
use pulp::Arch;
use rayon::prelude::*;

use crate::banded::dot;
use crate::equations::{Equations, Sums};
use crate::nodes::Nodes;
use crate::opponent::{from_opponent, to_opponent};
use crate::places::{DifferencePlaces, HalfPlaces, smooth};
use crate::products::{Products, Shape};
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
    shape: Shape,
    roughness: f64,
    offsets: [f64; 3],
    half_places: HalfPlaces,
    difference_places: DifferencePlaces,
    weighing: Weights,
    /// ln(a + f) of each node and channel, or ln((a + f) / (a + g)) over a base g.
    logarithms: Vec<[f64; 3]>,
    weights: Vec<f64>,
    /// Weights times what is to be fitted, node by node, for each colour.
    weighted: Vec<Vec<f64>>,
    sides: Sides,
}

/// The coefficients of both sides, and what they are at the places of the nodes.
#[derive(Clone)]
pub(crate) struct Sides {
    half: Values,
    /// For each colour.
    difference: Vec<Values>,
}

/// Functions of one side, a term after the other.
#[derive(Clone)]
struct Values {
    /// Coefficients, those of a term together.
    coefficients: Vec<f64>,
    /// Values, those of a place together.
    at: Vec<f64>,
}

impl<'a> Alternating<'a> {
    /// Starts with cosines over the axis of θh.
    pub(crate) fn new(nodes: &'a Nodes, shape: Shape, offsets: [f64; 3], roughness: f64) -> Self {
        let channels = nodes.channels;
        let logarithms = nodes.nodes.iter().enumerate().map(|(index, node)| {
            let base = nodes.base_logarithms(index, offsets);
            std::array::from_fn(|c| {
                if c < channels { (offsets[c] + node.value[c]).ln() - base[c] } else { 0.0 }
            })
        });
        let half = (0..shape.terms).flat_map(|term| {
            let turns = std::f64::consts::PI * term as f64;
            (0..shape.half.count).map(move |index| (turns * shape.half.place(index)).cos())
        });
        let half = Values { coefficients: half.collect(), at: Vec::new() };
        let difference = Values {
            coefficients: vec![0.0; shape.terms * shape.difference_len()],
            at: vec![0.0; nodes.differences.len() * shape.terms],
        };
        let weighing = Weights::new(nodes, offsets);
        let mut made = Self {
            nodes,
            roughness,
            offsets,
            half_places: HalfPlaces::new(&shape, &nodes.halves),
            difference_places: DifferencePlaces::new(&shape, &nodes.differences),
            logarithms: logarithms.collect(),
            weights: weighing.first(nodes),
            weighing,
            weighted: Vec::new(),
            sides: Sides { half, difference: vec![difference; channels] },
            shape,
        };
        made.weigh_targets();
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

    pub(crate) fn shape(&self) -> &Shape {
        &self.shape
    }

    /// Returns the coefficients as they are.
    pub(crate) fn sides(&self) -> Sides {
        self.sides.clone()
    }

    /// Goes back to earlier coefficients.
    pub(crate) fn reset(&mut self, sides: &Sides) {
        self.sides.clone_from(sides);
    }

    /// Returns the model so far.
    pub(crate) fn products(&self) -> Products {
        let colours = &self.sides.difference;
        let at = |index: usize| {
            let colour = |c: usize| colours.get(c).map_or(0.0, |own| own.coefficients[index]);
            from_opponent(std::array::from_fn(colour), colours.len())
        };
        Products {
            shape: self.shape.clone(),
            half: self.sides.half.coefficients.clone(),
            difference: (0..self.shape.terms * self.shape.difference_len()).map(at).collect(),
        }
    }

    fn read_half(&mut self) {
        let (terms, count) = (self.shape.terms, self.shape.half.count);
        let Values { coefficients, at } = &mut self.sides.half;
        at.resize(terms * self.nodes.halves.len(), 0.0);
        for (term, own) in coefficients.chunks_exact(count).enumerate() {
            let values = self.half_places.read(own);
            at[term..].iter_mut().step_by(terms).zip(values).for_each(|(at, value)| *at = value);
        }
    }

    fn read_difference(&mut self) {
        let (terms, places) = (self.shape.terms, &self.difference_places);
        let length = self.shape.difference_len();
        self.sides.difference.par_iter_mut().for_each(|Values { coefficients, at }| {
            Arch::new().dispatch(|| {
                for (term, own) in coefficients.chunks_exact(length).enumerate() {
                    places.read(own, &mut at[term..], terms);
                }
            });
        });
    }

    /// Present y of every node and channel.
    fn predictions(&self) -> Vec<[f64; 3]> {
        let terms = self.shape.terms;
        let (halves, colours) = (self.nodes.halves.len(), &self.sides.difference);
        let of = |node: usize| {
            let (half, difference) =
                if self.nodes.is_grid { (node % halves, node / halves) } else { (node, node) };
            let half = &self.sides.half.at[half * terms..(half + 1) * terms];
            let colour = |c: usize| {
                colours.get(c).map_or(0.0, |own| {
                    dot(half, &own.at[difference * terms..(difference + 1) * terms])
                })
            };
            from_opponent(std::array::from_fn(colour), colours.len())
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

    fn weigh_targets(&mut self) {
        let channels = self.nodes.channels;
        let of = |colour: usize| {
            let nodes = self.weights.par_iter().zip(&self.logarithms);
            nodes.map(|(weight, y)| weight * to_opponent(*y, channels)[colour]).collect()
        };
        self.weighted = (0..channels).map(of).collect();
    }

    /// Returns, for each place of one side, what nodes add up to: columns of `functions` (one for each place of the
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

    /// Returns the sums over nodes of weights times products of terms, from what the products of pairs (the lower
    /// triangle) are at each place.
    fn sum_products(&self, pairs: &[f64], over_halves: bool) -> Vec<f64> {
        let terms = self.shape.terms;
        let sums = self.sum_over_nodes(pairs, &self.weights, over_halves);
        let triangle = terms * (terms + 1) / 2;
        let mut products = vec![0.0; sums.len() / triangle * terms * terms];
        let squares = products.par_chunks_exact_mut(terms * terms);
        squares.zip(sums.par_chunks_exact(triangle)).for_each(|(square, triangle)| {
            let mut triangle = triangle.iter();
            for a in 0..terms {
                for (b, &sum) in (0..=a).zip(&mut triangle) {
                    square[a * terms + b] = sum;
                    square[b * terms + a] = sum;
                }
            }
        });
        products
    }

    /// Weighs nodes by the present errors.
    ///
    /// Where a channel is 0 and the model is below, it is right: values end at 0.
    fn reweigh(&mut self) {
        let nodes = self.nodes;
        let bases: Vec<[f64; 3]> =
            (0..nodes.nodes.len()).map(|node| nodes.base_logarithms(node, self.offsets)).collect();
        let mut predicted = self.predictions();
        for (y, base) in predicted.iter_mut().zip(&bases) {
            y.iter_mut().zip(base).for_each(|(y, base)| *y += base);
        }
        self.weights = self.weighing.next(self.nodes, &predicted);
        let channels = nodes.channels;
        let nodes = self.logarithms.iter_mut().zip(&nodes.nodes).zip(&bases);
        for (((wanted, node), base), y) in nodes.zip(&predicted) {
            for c in 0..channels {
                if node.value[c] <= 0.0 {
                    wanted[c] = y[c].min(self.offsets[c].ln()) - base[c];
                }
            }
        }
        self.weigh_targets();
    }

    /// Makes the splines over θh orthonormal under the weights of the nodes, so that terms have one scale.
    fn orthonormalize(&mut self) {
        let terms = self.shape.terms;
        let totals = self.totals(true);
        let half = &self.sides.half.at;
        let gram = Mat::from_fn(terms, terms, |i, j| {
            let halves = half.chunks_exact(terms).zip(&totals);
            let sum: f64 = halves.map(|(half, weight)| weight * half[i] * half[j]).sum();
            if i == j { sum * (1.0 + 1e-10) + 1e-300 } else { sum }
        });
        let Ok(cholesky) = gram.llt(Side::Lower) else { return };
        // g ← L⁻¹ g and C ← Lᵀ C leave Σ g C as it is.
        let lower = cholesky.L();
        let count = self.shape.half.count;
        let half = &mut self.sides.half.coefficients;
        for at in 0..count {
            for i in 0..terms {
                let known: f64 = (0..i).map(|j| lower[(i, j)] * half[j * count + at]).sum();
                let value = &mut half[i * count + at];
                *value = (*value - known) / lower[(i, i)];
            }
        }
        self.turn_difference(|new, old| if old >= new { lower[(old, new)] } else { 0.0 });
        self.read_half();
        self.read_difference();
    }

    /// Turns the terms among themselves so that they are ordered by energy and share none.
    pub(crate) fn order_terms(&mut self) {
        self.orthonormalize();
        let terms = self.shape.terms;
        let weights = self.totals(false);
        let colours = &self.sides.difference;
        let energy = Mat::from_fn(terms, terms, |i, j| {
            let of = |colour: &Values| {
                let places = colour.at.chunks_exact(terms).zip(&weights);
                places.map(|(place, weight)| weight * place[i] * place[j]).sum::<f64>()
            };
            colours.iter().map(of).sum::<f64>()
        });
        let Ok(eigen) = energy.self_adjoint_eigen(Side::Lower) else { return };
        // Eigenvalues come in rising order.
        let turn = |new: usize, old: usize| eigen.U()[(old, terms - 1 - new)];
        turn_terms(&mut self.sides.half.coefficients, terms, turn);
        self.turn_difference(turn);
        self.read_half();
        self.read_difference();
    }

    fn turn_difference(&mut self, turn: impl Fn(usize, usize) -> f64) {
        for colour in &mut self.sides.difference {
            turn_terms(&mut colour.coefficients, self.shape.terms, &turn);
        }
    }

    /// Returns the equations for the coefficients over θd and φd, given the splines over θh.
    pub(crate) fn difference_equations(&self) -> Equations {
        let (terms, shape) = (self.shape.terms, &self.shape);
        let half = &self.sides.half.at;
        let pairs: Vec<f64> = half
            .chunks_exact(terms)
            .flat_map(|g| (0..terms).flat_map(move |a| (0..=a).map(move |b| g[a] * g[b])))
            .collect();
        let products = self.sum_products(&pairs, true);
        let of = |weighted: &Vec<f64>| self.sum_over_nodes(half, weighted, true);
        let sums = Sums { terms, products, targets: self.weighted.iter().map(of).collect() };
        let harmonics = shape.harmonics();
        let count = harmonics.len();
        let system = |term: usize| {
            let weight = |place: usize| sums.product(place, term, term);
            let mut gram = Arch::new().dispatch(|| self.difference_places.squares(weight));
            let ridge = self.roughness * gram.mean_diagonal() + f64::MIN_POSITIVE;
            for (harmonic, function) in harmonics.iter().enumerate() {
                smooth(&mut gram, shape.difference, ridge, |j| j * count + harmonic);
                let order = function.order as f64;
                let own = ridge * (HARMONIC_ROUGHNESS * order.powi(4) + 1e-6);
                for j in 0..shape.difference.count {
                    let at = j * count + harmonic;
                    gram.add(at, at, own);
                }
            }
            gram.cholesky()
        };
        let systems = (0..terms).into_par_iter().map(system).collect();
        Equations { sums, systems }
    }

    /// Solves for the coefficients over θd and φd.
    pub(crate) fn solve_difference(&mut self) {
        let equations = self.difference_equations();
        let places = &self.difference_places;
        let colours = self.sides.difference.par_iter_mut().zip(&equations.sums.targets);
        colours.for_each(|(own, targets)| {
            Arch::new().dispatch(|| {
                for term in (0..SWEEPS).flat_map(|_| 0..equations.sums.terms) {
                    if let Some(solution) = equations.difference_of(places, targets, term, &own.at)
                    {
                        own.hold(places, term, equations.sums.terms, &solution);
                    }
                }
            });
        });
    }

    /// Returns the integers that coefficients over θd and φd become, in steps of each, and holds those: for each colour,
    /// those of a term together.
    ///
    /// Terms are rounded one after another, so that later ones make up for what rounding did to earlier ones;
    /// within a term, each coefficient likewise for those after it.
    pub(crate) fn round_difference(
        &mut self,
        equations: &Equations,
        steps: &[f64],
    ) -> Vec<Vec<i32>> {
        let places = &self.difference_places;
        let colours = self.sides.difference.par_iter_mut().zip(&equations.sums.targets);
        let round = |(own, targets): (&mut Values, &Vec<f64>)| {
            let terms = equations.sums.terms;
            let mut rounded = Vec::with_capacity(terms * steps.len());
            Arch::new().dispatch(|| {
                for (term, system) in equations.systems.iter().enumerate() {
                    let wanted = equations.difference_of(places, targets, term, &own.at);
                    let found = match (system, wanted) {
                        (Some(system), Some(wanted)) => system.nearest_plane(&wanted, steps),
                        _ => vec![0; steps.len()],
                    };
                    let pairs = found.iter().zip(steps);
                    let held: Vec<f64> = pairs.map(|(&v, step)| f64::from(v) * step).collect();
                    own.hold(places, term, terms, &held);
                    rounded.extend(found);
                }
            });
            rounded
        };
        colours.map(round).collect()
    }

    /// Returns the equations for the splines over θh, given the other side.
    pub(crate) fn half_equations(&self) -> Equations {
        let (terms, basis) = (self.shape.terms, self.shape.half);
        let colours = &self.sides.difference;
        let mut pairs = vec![0.0; self.difference_places.len() * terms * (terms + 1) / 2];
        for colour in colours {
            let places = colour.at.chunks_exact(terms);
            let products = places
                .flat_map(|p| (0..terms).flat_map(move |a| (0..=a).map(move |b| p[a] * p[b])));
            pairs.iter_mut().zip(products).for_each(|(sum, product)| *sum += product);
        }
        let products = self.sum_products(&pairs, false);
        let mut targets = vec![0.0; self.nodes.halves.len() * terms];
        for (colour, weighted) in colours.iter().zip(&self.weighted) {
            let sums = self.sum_over_nodes(&colour.at, weighted, false);
            targets.iter_mut().zip(sums).for_each(|(target, sum)| *target += sum);
        }
        let sums = Sums { terms, products, targets: vec![targets] };
        let system = |term: usize| {
            let mut gram = self.half_places.squares(|place| sums.product(place, term, term));
            let ridge = self.roughness * gram.mean_diagonal() + f64::MIN_POSITIVE;
            smooth(&mut gram, basis, ridge, |j| j);
            for i in 0..basis.count {
                gram.add(i, i, 1e-6 * ridge);
            }
            gram.cholesky()
        };
        let systems = (0..terms).map(system).collect();
        Equations { sums, systems }
    }

    /// Solves for the splines over θh.
    pub(crate) fn solve_half(&mut self) {
        let (equations, terms) = (self.half_equations(), self.shape.terms);
        for term in (0..SWEEPS).flat_map(|_| 0..terms) {
            if let Some(solution) = equations.half_of(&self.half_places, term, &self.sides.half.at)
            {
                self.hold_half(term, &solution);
            }
        }
    }

    fn hold_half(&mut self, term: usize, coefficients: &[f64]) {
        let (terms, count) = (self.shape.terms, coefficients.len());
        let half = &mut self.sides.half;
        half.coefficients[term * count..(term + 1) * count].copy_from_slice(coefficients);
        let values = self.half_places.read(coefficients);
        half.at[term..].iter_mut().step_by(terms).zip(values).for_each(|(at, value)| *at = value);
    }

    /// Returns the integers that the splines over θh become, in a step for each term, and holds those.
    pub(crate) fn round_half(&mut self, equations: &Equations, steps: &[f64]) -> Vec<i32> {
        let count = self.shape.half.count;
        let mut rounded = Vec::with_capacity(steps.len() * count);
        for (term, (&step, system)) in steps.iter().zip(&equations.systems).enumerate() {
            let wanted = equations.half_of(&self.half_places, term, &self.sides.half.at);
            let found = match (system, wanted) {
                (Some(system), Some(wanted)) => system.nearest_plane(&wanted, &vec![step; count]),
                _ => vec![0; count],
            };
            let held: Vec<f64> = found.iter().map(|&v| f64::from(v) * step).collect();
            self.hold_half(term, &held);
            rounded.extend(found);
        }
        rounded
    }

    /// Root mean square of each term's other side, under the weights.
    pub(crate) fn term_sizes(&self) -> Vec<f64> {
        let terms = self.shape.terms;
        let mut sums = vec![0.0; terms];
        let weights = self.totals(false);
        for colour in &self.sides.difference {
            for (place, weight) in colour.at.chunks_exact(terms).zip(&weights) {
                sums.iter_mut().zip(place).for_each(|(sum, v)| *sum += weight * v * v);
            }
        }
        let total: f64 = self.weights.iter().sum();
        sums.into_iter().map(|sum| (sum / total).sqrt()).collect()
    }
}

impl Values {
    /// Takes these coefficients of a term over θd and φd.
    #[inline(always)]
    fn hold(&mut self, places: &DifferencePlaces, term: usize, terms: usize, coefficients: &[f64]) {
        let length = coefficients.len();
        self.coefficients[term * length..(term + 1) * length].copy_from_slice(coefficients);
        places.read(coefficients, &mut self.at[term..], terms);
    }
}

/// Replaces terms by sums of the terms that there were: new ← Σ turn(new, old) old.
fn turn_terms(coefficients: &mut [f64], terms: usize, turn: impl Fn(usize, usize) -> f64) {
    let length = coefficients.len() / terms;
    let before = coefficients.to_vec();
    for (new, own) in coefficients.chunks_exact_mut(length).enumerate() {
        own.fill(0.0);
        for (old, before) in before.chunks_exact(length).enumerate() {
            let factor = turn(new, old);
            own.iter_mut().zip(before).for_each(|(own, before)| *own += factor * before);
        }
    }
}
