//! Variable projection: the error as a function of the projections alone, its derivatives, and
//! Levenberg–Marquardt steps.
//!
//! For given projections the textures are a linear least-squares problem, so the error is a
//! function of the projections, and ∂E/∂P = 2 rᵀ (∂B/∂P) y at the solved textures y: bilinear
//! weights are piecewise differentiable. Steps use Kaufman's form of the Gauss–Newton matrix,
//! derivatives of the prediction with what textures can absorb projected out.
//!
//! Source: G. H. Golub and V. Pereyra, "The differentiation of pseudo-inverses and nonlinear least
//! squares problems whose variables separate", SIAM J. Numerical Analysis 10, 1973; L. Kaufman, "A
//! variable projection method for solving separable nonlinear least squares problems", BIT 15, 1975.

use std::sync::{Arc, Mutex};

use brdf_factor::{
    CholeskyFactor, Columns, Coordinate, FactorDescription, FactorError, NormalEquations, Problem,
};
use brdf_param::{Projection, Space};
use faer::{Mat, MatRef, Par};
use glam::DVec4;
use rayon::prelude::*;

use crate::Family;
use crate::monitor::Monitor;
use crate::tangent::{DIRECTIONS, Tangent, extent_gradient};

/// Samples and texture size at which sets of projections are compared, and the factors that stand
/// beside the searched ones.
#[derive(Debug)]
pub(crate) struct Level<'a> {
    problem: &'a Problem,
    size: usize,
    family: &'a Family,
    fixed: NormalEquations,
    /// Weighted fitted values of each channel.
    weighted_targets: Vec<Vec<f64>>,
    weight_roots: Vec<f64>,
    /// Σ w y² over samples and channels.
    target_energy: f64,
    buffers: Buffers,
    /// Number by which sums over samples and channels become means.
    scale: f64,
}

/// Memory of Cholesky factors that are done with: fresh pages would cost as much as filling them.
#[derive(Debug, Default)]
struct Buffers(Mutex<Vec<Vec<f64>>>);

impl Buffers {
    fn take(&self) -> Vec<f64> {
        self.0.lock().ok().and_then(|mut free| free.pop()).unwrap_or_default()
    }

    fn put_back(&self, factor: CholeskyFactor) {
        if let Ok(mut free) = self.0.lock() {
            free.push(factor.into_buffer());
        }
    }
}

/// A set of projections with its textures solved for.
#[derive(Clone, Debug)]
pub(crate) struct Solved {
    pub(crate) projections: Vec<Projection>,
    equations: NormalEquations,
    factor: CholeskyFactor,
    /// One solution per channel.
    textures: Vec<Vec<f64>>,
    /// Weighted mean square log residual, plus the smoothing terms.
    pub(crate) energy: f64,
}

/// A set of projections on its way to a minimum, without the matrices that found it.
#[derive(Clone, Debug)]
pub(crate) struct Candidate {
    pub(crate) projections: Vec<Projection>,
    /// As [`Solved::energy`]; infinite before the first solution.
    pub(crate) energy: f64,
    damping: f64,
    /// Nothing more is to be gained.
    converged: bool,
}

impl Candidate {
    pub(crate) fn new(projections: Vec<Projection>) -> Self {
        let converged = projections.is_empty();
        Self { projections, energy: f64::INFINITY, damping: FIRST_DAMPING, converged }
    }
}

/// When steps end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Limits {
    /// Most steps.
    pub(crate) steps: usize,
    /// A step that lowers the error by less than this share is the last.
    pub(crate) tolerance: f64,
}

/// No step turns a plane further than this, radians: derivatives hold within a few texels.
const LONGEST_STEP: f64 = 0.5;
/// Damping of the first step, relative to the diagonal.
const FIRST_DAMPING: f64 = 1e-2;
/// Damping after a step that lowered the error, never below the least, and after one that did not.
const RELAX: f64 = 0.2;
const LEAST_DAMPING: f64 = 1e-7;
const TIGHTEN: f64 = 8.0;
/// Steps that raise the error before giving up.
const REJECTIONS: usize = 5;

impl<'a> Level<'a> {
    pub(crate) fn new(
        problem: &'a Problem,
        size: usize,
        family: &'a Family,
    ) -> Result<Self, FactorError> {
        let columns: Result<Vec<Arc<Columns>>, FactorError> = family
            .fixed
            .iter()
            .map(|spec| Ok(Arc::new(problem.columns(&problem.empty_factor(spec, size)?))))
            .collect();
        let weights = problem.weights();
        let weighted = |targets: &Vec<f64>| -> Vec<f64> {
            targets.iter().zip(weights).map(|(y, w)| y * w).collect()
        };
        let weighted_targets: Vec<Vec<f64>> = problem.targets().iter().map(weighted).collect();
        let energy = |(y, wy): (&Vec<f64>, &Vec<f64>)| dot(y, wy);
        let channels = problem.targets().len() as f64;
        Ok(Self {
            problem,
            size,
            family,
            fixed: NormalEquations::new(columns?, weights),
            target_energy: problem.targets().iter().zip(&weighted_targets).map(energy).sum(),
            weighted_targets,
            weight_roots: weights.iter().map(|w| w.sqrt()).collect(),
            buffers: Buffers::default(),
            scale: 1.0 / (problem.total_weight() * channels),
        })
    }

    /// Takes back the memory of a set that is done with.
    fn recycle(&self, set: Solved) {
        self.buffers.put_back(set.factor);
    }

    /// Solves for the textures of a set of projections.
    pub(crate) fn solve(
        &self,
        projections: &[Projection],
        monitor: &Monitor<'_>,
    ) -> Result<Solved, FactorError> {
        let columns: Result<Vec<Arc<Columns>>, FactorError> =
            projections.par_iter().map(|&projection| self.columns(projection)).collect();
        let equations = self.fixed.clone().with(columns?, self.problem.weights());
        let factor = equations.factorize(self.buffers.take())?;
        monitor.evaluated();
        Ok(self.solve_factored(projections.to_vec(), equations, factor))
    }

    /// Solves for all textures after the projections from `held` on are replaced; what the others
    /// share is taken from `known`.
    pub(crate) fn solve_after(
        &self,
        known: &Solved,
        held: usize,
        moved: &[Projection],
        monitor: &Monitor<'_>,
    ) -> Result<Solved, FactorError> {
        let kept = self.fixed.columns().len() + held;
        let columns: Result<Vec<Arc<Columns>>, FactorError> =
            moved.par_iter().map(|&projection| self.columns(projection)).collect();
        let equations = known.equations.leading(kept).with(columns?, self.problem.weights());
        let factor = equations.factorize_after(&known.factor, kept, self.buffers.take())?;
        let projections = [&known.projections[..held], moved].concat();
        monitor.evaluated();
        Ok(self.solve_factored(projections, equations, factor))
    }

    /// What the first `factors` of a solved set give for every sample of each channel.
    pub(crate) fn explained_by(&self, set: &Solved, factors: usize) -> Vec<Vec<f64>> {
        let starts = set.equations.starts();
        set.textures
            .iter()
            .map(|texture| {
                let mut values = vec![0.0; self.problem.len()];
                for (index, columns) in set.equations.columns()[..factors].iter().enumerate() {
                    columns.add_values(&texture[starts[index]..starts[index + 1]], &mut values);
                }
                values
            })
            .collect()
    }

    fn columns(&self, projection: Projection) -> Result<Arc<Columns>, FactorError> {
        let factor = self.problem.empty_factor(&self.family.spec(projection), self.size)?;
        Ok(Arc::new(self.problem.columns(&factor)))
    }

    fn solve_factored(
        &self,
        projections: Vec<Projection>,
        equations: NormalEquations,
        factor: CholeskyFactor,
    ) -> Solved {
        let channels = self.weighted_targets.len();
        let mut sides = Mat::<f64>::zeros(equations.unknowns(), channels);
        for (channel, targets) in self.weighted_targets.iter().enumerate() {
            if let Some(side) = sides.col_mut(channel).try_as_col_major_mut() {
                let mut rest = side.as_slice_mut();
                for columns in equations.columns() {
                    let (own, others) = rest.split_at_mut(columns.unknowns());
                    columns.add_transposed(targets, own);
                    rest = others;
                }
            }
        }
        let mut solution = sides.clone();
        factor.solve_in_place(solution.as_mut());
        // At the minimum xᵀ(AᵀA)x = xᵀAᵀy, so that no pass over the samples is needed.
        let explained: f64 = (0..channels)
            .map(|c| {
                sides.col(c).iter().zip(solution.col(c).iter()).map(|(a, b)| a * b).sum::<f64>()
            })
            .sum();
        let energy = ((self.target_energy - explained) * self.scale).max(0.0);
        let textures = (0..channels).map(|c| solution.col(c).iter().copied().collect()).collect();
        Solved { projections, equations, factor, textures, energy }
    }

    /// Takes Levenberg–Marquardt steps of all projections together.
    pub(crate) fn improve(
        &self,
        candidate: &Candidate,
        limits: Limits,
        monitor: &Monitor<'_>,
    ) -> Result<Candidate, FactorError> {
        if candidate.converged && candidate.energy.is_finite() {
            return Ok(candidate.clone());
        }
        let set = self.solve(&candidate.projections, monitor)?;
        self.descend(set, 0, candidate.damping, limits, monitor)
    }

    /// Takes steps of one more projection alone.
    pub(crate) fn improve_last(
        &self,
        known: &Solved,
        next: Projection,
        limits: Limits,
        monitor: &Monitor<'_>,
    ) -> Result<Candidate, FactorError> {
        let held = known.projections.len();
        let set = self.solve_after(known, held, &[next], monitor)?;
        // What comes next moves all projections, from a fresh start.
        let found = self.descend(set, held, FIRST_DAMPING, limits, monitor)?;
        Ok(Candidate { energy: found.energy, ..Candidate::new(found.projections) })
    }

    /// The error with one more projection.
    pub(crate) fn energy_with(
        &self,
        known: &Solved,
        next: Projection,
        monitor: &Monitor<'_>,
    ) -> Result<f64, FactorError> {
        let set = self.solve_after(known, known.projections.len(), &[next], monitor)?;
        let energy = set.energy;
        self.recycle(set);
        Ok(energy)
    }

    /// Steps of all projections but the first `held`, each damped more and more until it lowers the
    /// error; at a minimum none does.
    fn descend(
        &self,
        mut set: Solved,
        held: usize,
        mut damping: f64,
        limits: Limits,
        monitor: &Monitor<'_>,
    ) -> Result<Candidate, FactorError> {
        let mut converged = set.projections.len() <= held;
        for _ in 0..limits.steps {
            if converged || monitor.stopped() {
                break;
            }
            let local = self.linearize(&set, held);
            converged = true;
            for _ in 0..REJECTIONS {
                let moved = local.step(&set.projections[held..], damping);
                let trial = self.solve_after(&set, held, &moved, monitor)?;
                if trial.energy < set.energy {
                    converged = set.energy - trial.energy <= limits.tolerance * set.energy;
                    damping = (RELAX * damping).max(LEAST_DAMPING);
                    self.recycle(std::mem::replace(&mut set, trial));
                    break;
                }
                self.recycle(trial);
                damping *= TIGHTEN;
            }
        }
        let (projections, energy) = (set.projections.clone(), set.energy);
        self.recycle(set);
        Ok(Candidate { projections, energy, damping, converged })
    }

    /// Derivatives at a solved set with respect to all projections but the first `held`.
    pub(crate) fn linearize(&self, set: &Solved, held: usize) -> Linearized {
        let tangents: Vec<Tangent> = set.projections[held..].iter().map(Tangent::at).collect();
        let width = DIRECTIONS * tangents.len();
        let mut matrix = Mat::<f64>::zeros(width, width);
        let mut gradient = vec![0.0; width];
        let mut diagonal = vec![0.0; width];
        for (channel, texture) in set.textures.iter().enumerate() {
            let residuals = self.weighted_residuals(set, channel);
            let jacobian = self.jacobian(set, held, texture, &tangents);
            let rows = self.problem.len();
            let j = MatRef::from_row_major_slice(&jacobian, rows, width);
            add_product(&mut matrix, j, j, 1.0);
            for (at, diagonal) in diagonal.iter_mut().enumerate() {
                *diagonal = matrix[(at, at)];
            }
            for (row, residual) in jacobian.chunks_exact(width).zip(&residuals) {
                for (g, entry) in gradient.iter_mut().zip(row) {
                    *g += entry * residual;
                }
            }
            self.remove_absorbed(set, &jacobian, &mut matrix);
        }
        Linearized { tangents, matrix, diagonal, gradient }
    }

    /// Subtracts what textures can absorb: JᵀA (AᵀA)⁻¹ AᵀJ.
    fn remove_absorbed(&self, set: &Solved, jacobian: &[f64], matrix: &mut Mat<f64>) {
        let width = matrix.ncols();
        let unknowns = set.equations.unknowns();
        let mut products = vec![0.0; unknowns * width];
        let mut rest = &mut products[..];
        let mut parts = Vec::new();
        for columns in set.equations.columns() {
            let (own, others) = rest.split_at_mut(columns.unknowns() * width);
            parts.push((columns, own));
            rest = others;
        }
        parts.into_par_iter().for_each(|(columns, own)| {
            columns.add_transposed_rows(&self.weight_roots, jacobian, width, own);
        });
        let products = MatRef::from_row_major_slice(&products, unknowns, width);
        let mut absorbed = products.to_owned();
        set.factor.solve_in_place(absorbed.as_mut());
        add_product(matrix, products, absorbed.as_ref(), -1.0);
    }

    /// √w (prediction − target).
    fn weighted_residuals(&self, set: &Solved, channel: usize) -> Vec<f64> {
        let starts = set.equations.starts();
        let mut values = vec![0.0; self.problem.len()];
        for (index, columns) in set.equations.columns().iter().enumerate() {
            let own = &set.textures[channel][starts[index]..starts[index + 1]];
            columns.add_values(own, &mut values);
        }
        let targets = &self.problem.targets()[channel];
        let rows = values.iter().zip(targets).zip(&self.weight_roots);
        rows.map(|((value, target), root)| root * (value - target)).collect()
    }

    /// √w ∂(prediction)/∂(step along every tangent direction), row by row.
    fn jacobian(
        &self,
        set: &Solved,
        held: usize,
        texture: &[f64],
        tangents: &[Tangent],
    ) -> Vec<f64> {
        let width = DIRECTIONS * tangents.len();
        let mut jacobian = vec![0.0; self.problem.len() * width];
        let fixed = self.fixed.columns().len() + held;
        let starts = set.equations.starts();
        for (index, tangent) in tangents.iter().enumerate() {
            let columns = &set.equations.columns()[fixed + index];
            let own = &texture[starts[fixed + index]..starts[fixed + index + 1]];
            for (coordinate, directions) in self.moved_coordinates(columns, tangent) {
                let slopes = columns.slopes(coordinate, own);
                let points = self.problem.points(self.family.space);
                let rows = jacobian.chunks_exact_mut(width).zip(&self.weight_roots);
                for (((row, root), slope), point) in rows.zip(slopes).zip(points) {
                    let slope = slope.map(|s| root * s);
                    let target = &mut row[DIRECTIONS * index..][..DIRECTIONS];
                    for (entry, [du, dv]) in target.iter_mut().zip(&directions) {
                        *entry += slope[0] * dot4(du, point) + slope[1] * dot4(dv, point);
                    }
                }
            }
        }
        jacobian
    }

    /// For each coordinate of a searched factor, how its two scaled rows change along each tangent
    /// direction: a texture coordinate is row · point / extent, and the extent moves too.
    fn moved_coordinates(
        &self,
        columns: &Columns,
        tangent: &Tangent,
    ) -> Vec<(usize, [[[f64; 4]; 2]; DIRECTIONS])> {
        let Some(description) = columns.description() else { return Vec::new() };
        let FactorDescription { coordinates, bound, radii, extent, .. } = description;
        let extent = extent.to_array();
        let planes: Vec<[DVec4; 2]> = coordinates
            .iter()
            .filter_map(|coordinate| match coordinate {
                Coordinate::Projected { projection, .. } => Some(projection.rows()),
                _ => None,
            })
            .collect();
        // The first coordinate is the projection, the second its conjugate; the conjugate's rows are
        // the projection's with columns exchanged or negated.
        let as_seen = |coordinate: usize, row: DVec4| match (coordinate, self.family.space) {
            (0, _) => row,
            (_, Space::Standard) => DVec4::new(row.z, row.w, row.x, row.y),
            (_, Space::HalfDifference) => DVec4::new(row.x, row.y, -row.z, -row.w),
        };
        // The extent is that of the coordinate which reaches furthest.
        let gradients: [DVec4; 2] = std::array::from_fn(|axis| {
            let widest = planes.iter().enumerate().map(|(coordinate, rows)| {
                let gradient = extent_gradient(rows[axis], *bound, *radii);
                (gradient.dot(rows[axis]), as_seen(coordinate, gradient))
            });
            widest.fold((f64::MIN, DVec4::ZERO), |a, b| if b.0 > a.0 { b } else { a }).1
        });
        planes
            .iter()
            .enumerate()
            .map(|(coordinate, rows)| {
                let directions = tangent.rows().map(|moved| {
                    std::array::from_fn(|axis| {
                        let own = as_seen(coordinate, moved[axis]);
                        let grown = gradients[axis].dot(moved[axis]) / extent[axis];
                        ((own - grown * rows[axis]) / extent[axis]).to_array()
                    })
                });
                (coordinate, directions)
            })
            .collect()
    }
}

/// The error around a set of projections, to second order.
#[derive(Debug)]
pub(crate) struct Linearized {
    tangents: Vec<Tangent>,
    /// Kaufman's matrix, lower triangle and all.
    matrix: Mat<f64>,
    /// Diagonal before textures absorbed their part.
    diagonal: Vec<f64>,
    /// Jᵀr.
    gradient: Vec<f64>,
}

impl Linearized {
    /// Projections after a damped step.
    pub(crate) fn step(&self, projections: &[Projection], damping: f64) -> Vec<Projection> {
        let width = self.gradient.len();
        let floor = 1e-12 * self.diagonal.iter().copied().fold(0.0, f64::max) + f64::MIN_POSITIVE;
        let mut damped = Vec::with_capacity(width * width);
        for column in 0..width {
            damped.extend(self.matrix.col(column).iter());
            damped[column * width + column] += damping * self.diagonal[column] + floor;
        }
        let mut side = Mat::from_fn(width, 1, |row, _| -self.gradient[row]);
        // Without a positive definite matrix the gradient alone shows the way down.
        match CholeskyFactor::new(damped, width) {
            Ok(factor) => factor.solve_in_place(side.as_mut()),
            Err(_) => {
                for (row, diagonal) in self.diagonal.iter().enumerate() {
                    side[(row, 0)] /= (1.0 + damping) * diagonal + floor;
                }
            }
        }
        let lengths: Vec<f64> = side.col(0).iter().copied().collect();
        let each = projections.iter().zip(&self.tangents).zip(lengths.chunks_exact(DIRECTIONS));
        each.map(|((projection, tangent), lengths)| {
            let length = lengths.iter().map(|l| l * l).sum::<f64>().sqrt();
            let shorten = if length > LONGEST_STEP { LONGEST_STEP / length } else { 1.0 };
            let lengths: Vec<f64> = lengths.iter().map(|l| shorten * l).collect();
            tangent.step(projection, &lengths)
        })
        .collect()
    }
}

/// matrix += factor · aᵀ b.
fn add_product(matrix: &mut Mat<f64>, a: MatRef<'_, f64>, b: MatRef<'_, f64>, factor: f64) {
    let accum = faer::Accum::Add;
    faer::linalg::matmul::matmul(matrix.as_mut(), accum, a.transpose(), b, factor, Par::Seq);
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn dot4(a: &[f64; 4], b: &[f64; 4]) -> f64 {
    (a[0] * b[0] + a[1] * b[1]) + (a[2] * b[2] + a[3] * b[3])
}

#[cfg(test)]
mod tests {
    use brdf_factor::{FactorParams, FactorSpec};
    use brdf_model::{Channels, PairSampling, Preset, SampleSet};
    use brdf_param::Bound;

    use super::*;
    use crate::random::StartRng;

    /// The oracle moves each projection a little and solves again. Derivatives are those of one piece:
    /// a step that carries a sample over the edge of a texel sees a kink, so most directions must
    /// agree closely and all roughly.
    #[test]
    fn derivatives_agree_with_finite_differences() {
        let sampling = PairSampling { count: 3_000, seed: 1, theta_max: 1.3 };
        let job = brdf_job::Job::new();
        let monitor = Monitor::new(&job, Vec::new());
        let mut rng = StartRng::new(1, 0, 0);
        for (preset, channels) in [(0, Channels::Luminance), (3, Channels::Rgb)] {
            let samples = SampleSet::draw(&Preset::ALL[preset].brdf(), &sampling, channels);
            for space in [Space::Standard, Space::HalfDifference] {
                for (bound, reciprocal) in
                    [(Bound::Disc, true), (Bound::Cube, true), (Bound::Disc, false)]
                {
                    let params = FactorParams { bound, ..FactorParams::default() };
                    let problem = Problem::new(&samples, &params).unwrap();
                    let fixed = FactorSpec::radial(reciprocal);
                    let family = Family { fixed, ..Family::new(space, reciprocal) };
                    let level = Level::new(&problem, 5, &family).unwrap();
                    let planes = [rng.projection(), rng.projection()];
                    let set = level.solve(&planes, &monitor).unwrap();
                    let local = level.linearize(&set, 0);
                    let mut close = 0;
                    for direction in 0..2 * DIRECTIONS {
                        let at = |length: f64| {
                            let mut lengths = [0.0; 2 * DIRECTIONS];
                            lengths[direction] = length;
                            let moved: Vec<Projection> = planes
                                .iter()
                                .zip(&local.tangents)
                                .zip(lengths.chunks_exact(DIRECTIONS))
                                .map(|((plane, tangent), lengths)| tangent.step(plane, lengths))
                                .collect();
                            level.solve(&moved, &monitor).unwrap().energy
                        };
                        let step = 1e-5;
                        let difference = (at(step) - at(-step)) / (2.0 * step);
                        let derivative = 2.0 * level.scale * local.gradient[direction];
                        let off = (difference - derivative).abs();
                        close += usize::from(off <= 1e-3 * derivative.abs() + 1e-6);
                        assert!(
                            off <= 0.05 * derivative.abs() + 2e-3,
                            "{space:?} {bound:?} {reciprocal} {direction}: {difference} {derivative}"
                        );
                    }
                    assert!(close >= 6, "{space:?} {bound:?} {reciprocal}: {close} of 10");
                }
            }
        }
    }

    #[test]
    fn a_projection_moved_alone_is_solved_as_if_from_scratch() {
        let sampling = PairSampling { count: 2_000, seed: 1, theta_max: 1.3 };
        let samples = SampleSet::draw(&Preset::ALL[0].brdf(), &sampling, Channels::Rgb);
        let problem = Problem::new(&samples, &FactorParams::default()).unwrap();
        let family = Family::new(Space::HalfDifference, true);
        let level = Level::new(&problem, 8, &family).unwrap();
        let job = brdf_job::Job::new();
        let monitor = Monitor::new(&job, Vec::new());
        let mut rng = StartRng::new(2, 0, 0);
        let [a, b, c] = [rng.projection(), rng.projection(), rng.projection()];
        let known = level.solve(&[a, b], &monitor).unwrap();
        let moved = level.solve_after(&known, 1, &[c], &monitor).unwrap().energy;
        let fresh = level.solve(&[a, c], &monitor).unwrap().energy;
        assert!((moved - fresh).abs() < 1e-12, "{moved} {fresh}");
    }
}
