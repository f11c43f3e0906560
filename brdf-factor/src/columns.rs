//! The columns of the design matrix that belong to one factor: the places at which the samples read its
//! texture, and the smoothing of the texture.

use glam::DVec2;

use crate::coordinate::{PairPlace, Reading, locate_angles};
use crate::grid::cell;
use crate::{Coordinate, Factor, FactorDescription, Grid, Problem};

/// Every texel is also pulled towards zero, with this share of the mean weight per texel: enough
/// to settle what the samples leave open (constants moving between factors), too little to show.
const RIDGE: f64 = 1e-7;
/// Texels that stand for one place are pulled together with this many times the mean weight per texel. What is
/// left between them is taken away when they are stored.
const JOIN: f64 = 1e2;

/// Where a sample reads a texture: two texels of one row, two of the next, and the way between.
///
/// Unknowns are numbered row by row and an image is convex, so each pair of texels is a pair of
/// consecutive unknowns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Tap {
    /// Unknown of the nearer texel of the lower row; its neighbour follows.
    low: u32,
    /// The same in the upper row; in one dimension the lower one again.
    high: u32,
    /// Way from texel to texel along a row, [0, 1].
    u: f64,
    /// Way from row to row, [0, 1]; 0 in one dimension.
    v: f64,
}

impl Tap {
    /// First unknowns of the two pairs.
    pub(crate) fn pairs(&self) -> [usize; 2] {
        [self.low as usize, self.high as usize]
    }

    /// Weights of the two pairs.
    pub(crate) fn weights(&self) -> [[f64; 2]; 2] {
        let (u, v) = (self.u, self.v);
        [[(1.0 - u) * (1.0 - v), u * (1.0 - v)], [(1.0 - u) * v, u * v]]
    }

    fn corners(&self, x: &[f64]) -> [[f64; 2]; 2] {
        self.pairs().map(|first| [x[first], x[first + 1]])
    }

    fn read(&self, x: &[f64]) -> f64 {
        let [[a, b], [c, d]] = self.corners(x);
        let (low, high) = (a + self.u * (b - a), c + self.u * (d - c));
        low + self.v * (high - low)
    }

    /// Slope along and across rows, per texel.
    fn slope(&self, x: &[f64]) -> [f64; 2] {
        let [[a, b], [c, d]] = self.corners(x);
        let across = [c - a, d - b];
        [(b - a) + self.v * ((d - c) - (b - a)), across[0] + self.u * (across[1] - across[0])]
    }
}

/// The columns of the design matrix A that belong to one factor.
#[derive(Clone, Debug)]
pub struct Columns {
    /// None for a texture of a surface.
    description: Option<FactorDescription>,
    /// For each texel, its unknown.
    unknown_of: Vec<Option<u32>>,
    /// For each unknown, the unknowns of its texel's neighbours.
    neighbours: Vec<Neighbours>,
    /// Unknowns that are to be equal.
    joined: Vec<[u32; 2]>,
    /// For each coordinate, one entry per sample.
    taps: Vec<Vec<Tap>>,
    /// Weight of a texel's Laplacian, of the texel itself, and of the difference of joined ones.
    smoothing: f64,
    ridge: f64,
    join: f64,
    /// Texels per unit of texture coordinates, along rows and across them.
    texels_per_unit: [f64; 2],
}

/// Up to four unknowns.
#[derive(Clone, Copy, Debug, Default)]
struct Neighbours {
    unknowns: [u32; 4],
    count: usize,
}

impl Neighbours {
    fn iter(&self) -> impl Iterator<Item = usize> + '_ {
        self.unknowns[..self.count].iter().map(|&unknown| unknown as usize)
    }
}

impl Problem {
    /// Returns the columns of the design matrix that belong to a factor.
    pub fn columns(&self, factor: &Factor) -> Columns {
        Columns::new(self, factor)
    }

    /// Returns the columns of a texture of `size`² texels over a surface.
    ///
    /// The samples have these texture coordinates in [0, 1]², in the order in which they were given. The
    /// first and the last column of the texture are neighbours where u `wraps`.
    ///
    /// # Panics
    ///
    /// If there are fewer places than samples were given, or the size is below 2.
    pub fn surface_columns(&self, size: usize, places: &[DVec2], wraps: bool) -> Columns {
        let sorted: Vec<DVec2> = self.origin().iter().map(|at| places[*at]).collect();
        Columns::of_surface(self, size, &sorted, wraps)
    }
}

impl Columns {
    pub(crate) fn new(problem: &Problem, factor: &Factor) -> Self {
        let unknown_of = numbered(factor.mask());
        let taps = factor
            .coordinates()
            .iter()
            .map(|coordinate| taps(problem, factor, coordinate, &unknown_of))
            .collect();
        let description = Some(factor.description().clone());
        Self::assemble(problem, description, factor.grid(), unknown_of, taps)
    }

    /// Those of a texture over a surface, one place of [0, 1]² for each sample of the problem, in the
    /// order of [`Problem::pairs`]. The first and the last column are one place where u `wraps`.
    pub(crate) fn of_surface(
        problem: &Problem,
        size: usize,
        places: &[DVec2],
        wraps: bool,
    ) -> Self {
        let grid = Grid::square(size);
        let unknown_of = numbered(vec![true; grid.texels()]);
        let taps = places
            .iter()
            .map(|place| {
                let ([column, row], [u, v]) = grid.place(*place);
                let corner = row * size + column;
                let [low, high] = [corner, corner + size].map(|texel| unknown_of[texel]);
                Tap { low: low.unwrap_or_default(), high: high.unwrap_or_default(), u, v }
            })
            .collect();
        let mut columns = Self::assemble(problem, None, grid, unknown_of, vec![taps]);
        if wraps {
            columns.join_first_and_last(size);
        }
        columns
    }

    /// Makes neighbours of the ends of every row.
    fn join_first_and_last(&mut self, size: usize) {
        for row in 0..size {
            let ends = [row * size, row * size + size - 1];
            for (own, other) in [(ends[0], ends[1]), (ends[1], ends[0])] {
                let around = &mut self.neighbours[own];
                if let (Some(free), Ok(other)) =
                    (around.unknowns.get_mut(around.count), u32::try_from(other))
                {
                    *free = other;
                    around.count += 1;
                }
            }
        }
    }

    fn assemble(
        problem: &Problem,
        description: Option<FactorDescription>,
        grid: Grid,
        unknown_of: Vec<Option<u32>>,
        taps: Vec<Vec<Tap>>,
    ) -> Self {
        let neighbours = (0..grid.texels())
            .filter(|&texel| unknown_of[texel].is_some())
            .map(|texel| {
                let mut found = Neighbours::default();
                for unknown in grid.neighbours(texel).filter_map(|n| unknown_of[n]) {
                    found.unknowns[found.count] = unknown;
                    found.count += 1;
                }
                found
            })
            .collect();
        let per_texel = problem.total_weight() / grid.texels() as f64;
        let last = [grid.columns, grid.rows].map(|side| (side - 1) as f64);
        let groups = description.iter().flat_map(FactorDescription::joined_texels);
        let joined = groups
            .flat_map(|group| {
                let unknown = |texel: usize| unknown_of[texel];
                let pairs =
                    group.windows(2).filter_map(|two| Some([unknown(two[0])?, unknown(two[1])?]));
                pairs.collect::<Vec<_>>()
            })
            .collect();
        Self {
            description,
            unknown_of,
            neighbours,
            joined,
            taps,
            smoothing: problem.params().smoothing * per_texel,
            ridge: RIDGE * per_texel,
            join: JOIN * per_texel,
            texels_per_unit: if grid.dimensions() == 1 { last } else { last.map(|l| 0.5 * l) },
        }
    }

    /// Returns the coordinates that read the texture and their scale; `None` for a texture of a surface.
    pub fn description(&self) -> Option<&FactorDescription> {
        self.description.as_ref()
    }

    /// Returns the number of samples.
    pub fn samples(&self) -> usize {
        self.taps.first().map_or(0, Vec::len)
    }

    /// Returns the number of texels that are solved for.
    pub fn unknowns(&self) -> usize {
        self.neighbours.len()
    }

    /// Returns the texels of a solution; texels outside the mask are `None`.
    pub fn texels<'a>(&'a self, solution: &'a [f64]) -> impl Iterator<Item = Option<f64>> + 'a {
        self.unknown_of.iter().map(|unknown| unknown.map(|u| solution[u as usize]))
    }

    /// Returns one channel of a factor's texels in the form of a solution: masked texels alone.
    pub fn texels_of(&self, factor: &Factor, channel: usize) -> Vec<f64> {
        let masked = factor.texels().iter().zip(&self.unknown_of).filter(|(_, u)| u.is_some());
        masked.map(|(texel, _)| f64::from(texel[channel])).collect()
    }

    /// Returns the indices of texels that no sample of positive weight touches.
    pub fn untouched_texels(&self, weights: &[f64]) -> Vec<usize> {
        let mut touched = vec![false; self.unknowns()];
        for taps in &self.taps {
            for (tap, _) in taps.iter().zip(weights).filter(|&(_, &weight)| weight > 0.0) {
                for (first, pair) in tap.pairs().into_iter().zip(tap.weights()) {
                    touched[first] |= pair[0] > 0.0;
                    touched[first + 1] |= pair[1] > 0.0;
                }
            }
        }
        let is_free = |unknown: &Option<u32>| unknown.is_some_and(|u| !touched[u as usize]);
        (0..self.unknown_of.len()).filter(|&texel| is_free(&self.unknown_of[texel])).collect()
    }

    /// For each coordinate, where every sample reads.
    pub(crate) fn taps(&self) -> &[Vec<Tap>] {
        &self.taps
    }

    /// Adds the log value that these texels give for every sample to `values`: A x.
    pub fn add_values(&self, texels: &[f64], values: &mut [f64]) {
        for taps in &self.taps {
            for (value, tap) in values.iter_mut().zip(taps) {
                *value += tap.read(texels);
            }
        }
    }

    /// Adds Aᵀ y to `out`, for one number y for each sample.
    pub fn add_transposed(&self, y: &[f64], out: &mut [f64]) {
        for taps in &self.taps {
            for (tap, &value) in taps.iter().zip(y) {
                for (first, pair) in tap.pairs().into_iter().zip(tap.weights()) {
                    out[first] += pair[0] * value;
                    out[first + 1] += pair[1] * value;
                }
            }
        }
    }

    /// Returns the slopes of the texture at every sample, as one coordinate reads it, per unit of texture
    /// coordinates.
    pub fn slopes<'a>(
        &'a self,
        coordinate: usize,
        texels: &'a [f64],
    ) -> impl ExactSizeIterator<Item = [f64; 2]> + 'a {
        let [x, y] = self.texels_per_unit;
        self.taps[coordinate].iter().map(move |tap| {
            let [along, across] = tap.slope(texels);
            [x * along, y * across]
        })
    }

    /// Adds Aᵀ W Y to `out`, for a matrix Y of `width` columns, stored row by row.
    ///
    /// A row of Y holds several values of one sample.
    pub fn add_transposed_rows(&self, weights: &[f64], y: &[f64], width: usize, out: &mut [f64]) {
        for taps in &self.taps {
            pulp::Arch::new().dispatch(AddRows { taps, weights, y, width, out });
        }
    }

    /// The number of rows of A below the samples.
    pub(crate) fn regularizer_rows(&self) -> usize {
        2 * self.unknowns() + self.joined.len()
    }

    /// Laplacian, ridge and joining rows applied to texels: the part of A below the samples.
    pub(crate) fn regularized(&self, texels: &[f64]) -> Vec<f64> {
        let (smoothing, ridge, join) = (self.smoothing.sqrt(), self.ridge.sqrt(), self.join.sqrt());
        let joined = self.joined.iter().map(|two| {
            let [a, b] = two.map(|unknown| texels[unknown as usize]);
            join * (a - b)
        });
        let laplacian =
            self.neighbours.iter().zip(texels).map(|(around, own)| {
                smoothing * around.iter().map(|n| texels[n] - own).sum::<f64>()
            });
        laplacian.chain(texels.iter().map(|x| ridge * x)).chain(joined).collect()
    }

    /// Adds the transpose of [`Columns::regularized`].
    pub(crate) fn add_regularized_transposed(&self, y: &[f64], out: &mut [f64]) {
        let (smoothing, ridge, join) = (self.smoothing.sqrt(), self.ridge.sqrt(), self.join.sqrt());
        let (laplacian, rest) = y.split_at(self.unknowns());
        let (own, joined) = rest.split_at(self.unknowns());
        for (unknown, (around, value)) in self.neighbours.iter().zip(laplacian).enumerate() {
            for neighbour in around.iter() {
                out[neighbour] += smoothing * value;
                out[unknown] -= smoothing * value;
            }
        }
        for (out, value) in out.iter_mut().zip(own) {
            *out += ridge * value;
        }
        for (&[a, b], value) in self.joined.iter().zip(joined) {
            out[a as usize] += join * value;
            out[b as usize] -= join * value;
        }
    }

    /// Calls `entry` with every non-zero entry (row, column, value) of LᵀL, ridge and joining.
    pub(crate) fn for_each_regularizer(&self, mut entry: impl FnMut(usize, usize, f64)) {
        for (unknown, around) in self.neighbours.iter().enumerate() {
            let degree: f64 = around.iter().map(|_| 1.0).sum();
            entry(unknown, unknown, self.smoothing * degree * degree + self.ridge);
            for a in around.iter() {
                entry(a, unknown, -self.smoothing * degree);
                entry(unknown, a, -self.smoothing * degree);
                for b in around.iter() {
                    entry(a, b, self.smoothing);
                }
            }
        }
        for two in &self.joined {
            let [a, b] = two.map(|unknown| unknown as usize);
            entry(a, a, self.join);
            entry(b, b, self.join);
            entry(a, b, -self.join);
            entry(b, a, -self.join);
        }
    }

    /// Squared length of every column, of the samples and of what stands below them.
    pub(crate) fn norms_sq(&self, weights: &[f64]) -> Vec<f64> {
        let mut norms = vec![0.0; self.unknowns()];
        self.for_each_regularizer(|row, column, value| {
            if row == column {
                norms[row] += value;
            }
        });
        // A texel that two coordinates of a sample read counts with the square of its sum.
        let mut sums: Vec<f64> = vec![0.0; self.unknowns()];
        for (sample, &weight) in weights.iter().enumerate() {
            let each = || self.taps.iter().map(|taps| &taps[sample]);
            let entries = || {
                each().flat_map(|tap| {
                    let pairs = tap.pairs().into_iter().zip(tap.weights());
                    pairs.flat_map(|(first, pair)| [(first, pair[0]), (first + 1, pair[1])])
                })
            };
            entries().for_each(|(unknown, value)| sums[unknown] += value);
            for (unknown, _) in entries() {
                let sum = std::mem::take(&mut sums[unknown]);
                norms[unknown] += weight * sum * sum;
            }
        }
        norms
    }
}

/// Numbers of the unknowns of masked texels.
fn numbered(mask: Vec<bool>) -> Vec<Option<u32>> {
    let mut unknowns = 0;
    let mut number = || {
        unknowns += 1;
        unknowns - 1
    };
    mask.into_iter().map(|masked| masked.then(&mut number)).collect()
}

/// The loop of [`Columns::add_transposed_rows`], compiled once for each instruction set.
struct AddRows<'a> {
    taps: &'a [Tap],
    weights: &'a [f64],
    y: &'a [f64],
    width: usize,
    out: &'a mut [f64],
}

impl pulp::NullaryFnOnce for AddRows<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { taps, weights, y, width, out } = self;
        for ((tap, row), &weight) in taps.iter().zip(y.chunks_exact(width)).zip(weights) {
            for (first, pair) in tap.pairs().into_iter().zip(tap.weights()) {
                let target = &mut out[first * width..][..2 * width];
                let (near, far) = target.split_at_mut(width);
                let (a, b) = (weight * pair[0], weight * pair[1]);
                for ((near, far), &value) in near.iter_mut().zip(far).zip(row) {
                    *near += a * value;
                    *far += b * value;
                }
            }
        }
    }
}

/// Where each sample reads a factor by one of its coordinates.
fn taps(
    problem: &Problem,
    factor: &Factor,
    coordinate: &Coordinate,
    unknown_of: &[Option<u32>],
) -> Vec<Tap> {
    let grid = factor.grid();
    let columns = grid.columns;
    // The mask holds every texel around a point of the image, so all are found.
    let unknown = |texel: usize| unknown_of[texel].unwrap_or_default();
    let planar = |([column, row], [u, v]): ([usize; 2], [f64; 2])| {
        let corner = row * columns + column;
        Tap { low: unknown(corner), high: unknown(corner + columns), u, v }
    };
    match coordinate.reading() {
        Reading::Planar(plane) => {
            let middle = 0.5 * DVec2::new((columns - 1) as f64, (grid.rows - 1) as f64);
            let [a, b] = plane.projection.scaled_by(factor.extent()).rows();
            let (a, b) = ((middle.x * a).to_array(), (middle.y * b).to_array());
            let dot = |r: &[f64; 4], p: &[f64; 4]| {
                (r[0] * p[0] + r[1] * p[1]) + (r[2] * p[2] + r[3] * p[3])
            };
            problem
                .points(plane.space)
                .iter()
                .map(|point| {
                    let (column, u) = cell(middle.x + dot(&a, point), columns);
                    let (row, v) = cell(middle.y + dot(&b, point), grid.rows);
                    planar(([column, row], [u, v]))
                })
                .collect()
        }
        Reading::Isotropic { axes, swapped } => {
            let angles = problem.angles().iter();
            angles
                .map(|&angles| {
                    let place = locate_angles(&axes, swapped, angles, factor.extent());
                    planar(grid.place(0.5 * (place + 1.0)))
                })
                .collect()
        }
        Reading::Radial(_) => problem
            .pairs()
            .map(|pair| {
                let place = coordinate.locate(&PairPlace::new(&pair), factor.extent()).x;
                let (low, u) = cell(place * (columns - 1) as f64, columns);
                Tap { low: unknown(low), high: unknown(low), u, v: 0.0 }
            })
            .collect(),
    }
}
