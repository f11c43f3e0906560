//! Matrices of BRDFs sampled on two grids.

use brdf_model::{Brdf, Channels, Rgb};
use brdf_param::{DirectionPair, azimuth, polar_angle, spherical_direction};
use faer::Mat;
use glam::DVec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::hemisphere_grid::Node;
use crate::{Layout, SeparableBrdf, SeparableError, ValueTransform};

/// The value of cells without data: pairs below the horizon or beyond the grazing limit, and holes of a
/// measurement.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Fill {
    /// The value of the nearest pair with data. It is found by pulling directions back to the grazing limit,
    /// and then both points towards the pole. A zero beside a highlight would need more terms.
    #[default]
    Edge,
    /// The value f = 0.
    Zero,
}

/// The options of sampling a matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MatrixParams {
    /// Channels that are sampled.
    pub channels: Channels,
    /// Grazing limit in radians, up to π/2: cells with a direction beyond it have no data.
    pub theta_max: f64,
    /// Value of cells without data.
    pub fill: Fill,
    /// Value map of each channel; the maps of channels that are not sampled are not used.
    pub maps: [ValueTransform; 3],
    /// Exponent p of the weights W M W, W = diag(cosᵖθ), besides the quadrature weights of the grids.
    pub weight_power: f64,
    /// Largest number of bytes for the matrix and the work on it.
    pub memory_limit: usize,
}

impl Default for MatrixParams {
    fn default() -> Self {
        Self {
            channels: Channels::Rgb,
            theta_max: std::f64::consts::FRAC_PI_2,
            fill: Fill::Edge,
            maps: [ValueTransform::Linear; 3],
            weight_power: 0.0,
            memory_limit: 4 << 30,
        }
    }
}

/// The numbers of cells of a matrix, by the origin of their values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CellCounts {
    /// Number of cells in all.
    pub cells: usize,
    /// Number of cells with data of their own.
    pub valid: usize,
    /// Number of cells that took the value of the nearest pair with data.
    pub filled: usize,
    /// Number of cells of value 0, because nothing near has data or because [`Fill::Zero`] was asked for.
    pub zero: usize,
    /// Number of rows and columns without a cell that has data of its own.
    pub unknown_lines: usize,
    /// Number of cells where the material gave a negative channel, which was set to 0.
    pub clamped: usize,
}

/// A BRDF sampled on the nodes of two grids, as one matrix for each channel.
///
/// Rows are nodes of the first grid, columns those of the second.
///
/// ```
/// use brdf_model::Preset;
/// use brdf_param::{HemisphereMap, Parametrization};
/// use brdf_separable::{BrdfMatrix, HemisphereGrid, Layout, MatrixParams};
///
/// let plastic = Preset::find("plastic").expect("a preset").brdf();
/// let grid = HemisphereGrid::Plane { map: HemisphereMap::OrthographicDisc, resolution: 8 };
/// let layout = Layout::new(Parametrization::Standard, grid, grid);
/// let matrix = BrdfMatrix::sample(&plastic, &layout, &MatrixParams::default())?;
/// assert_eq!(matrix.channel(0).nrows(), matrix.rows().len());
/// assert!(matrix.asymmetry().is_some_and(|ratio| ratio < 1e-6), "plastic is reciprocal");
/// # Ok::<(), brdf_separable::SeparableError>(())
/// ```
#[derive(Clone, Debug)]
pub struct BrdfMatrix {
    layout: Layout,
    rows: Vec<Node>,
    columns: Vec<Node>,
    /// Mapped values of each channel, column-major; f32 since they are many.
    channels: Vec<Vec<f32>>,
    maps: Vec<ValueTransform>,
    /// Whether a cell has data of its own, column-major.
    valid: Vec<bool>,
    /// Square roots of the weights of rows and columns.
    scales: [Vec<f64>; 2],
    counts: CellCounts,
}

/// The errors of a model of a given rank over the cells of its matrix.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RankError {
    /// Number of terms.
    pub rank: usize,
    /// Relative residual ‖M − M̂‖ / ‖M‖ of the mapped and weighted matrix, over all cells.
    pub relative_residual: f64,
    /// Root of the mean of (ln(1 + f cosθi) − ln(1 + max(f̂, 0) cosθi))², unweighted, over cells with data.
    pub log_cosine_rms: f64,
}

/// How far the search for a pair with data goes, in steps of the polar angle.
const PULL_STEPS: u32 = 16;

impl BrdfMatrix {
    /// Returns the matrix of a BRDF sampled on a layout.
    ///
    /// # Errors
    ///
    /// [`SeparableError::Layout`] and [`SeparableError::Resolution`] for layouts that make no
    /// matrix; [`SeparableError::Memory`] where more than the limit is needed;
    /// [`SeparableError::NoData`] where no cell has data.
    pub fn sample(
        brdf: &dyn Brdf,
        layout: &Layout,
        params: &MatrixParams,
    ) -> Result<Self, SeparableError> {
        layout.check()?;
        let (rows, columns) = (layout.first.nodes(), layout.second.nodes());
        let count = params.channels.count();
        let cells = rows.len() * columns.len();
        // The values, a scaled copy of them in f64 and one more side by side, and the cells' states.
        let needed = cells.saturating_mul(20 * count + 3);
        if needed > params.memory_limit {
            return Err(SeparableError::Memory {
                rows: rows.len(),
                columns: columns.len(),
                channels: count,
                needed,
                limit: params.memory_limit,
            });
        }
        let limit = cosine_limit(params.theta_max);
        let mut channels = vec![vec![0.0_f32; cells]; count];
        let mut state = vec![CellState::default(); cells];
        {
            let mut parts: Vec<_> = channels.iter_mut().map(|c| c.chunks_mut(rows.len())).collect();
            let lines: Vec<Vec<&mut [f32]>> = columns
                .iter()
                .map(|_| parts.iter_mut().filter_map(Iterator::next).collect())
                .collect();
            lines.into_par_iter().zip(state.par_chunks_mut(rows.len())).zip(&columns).for_each(
                |((mut values, state), column)| {
                    for (index, row) in rows.iter().enumerate() {
                        let points = [row.direction, column.direction];
                        let cell = Cell { layout, params, limit, points };
                        let (value, cos_theta_i, found) = cell.sample(brdf);
                        state[index] = found;
                        let split = match params.channels {
                            Channels::Rgb => value.channels(),
                            Channels::Luminance => [value.luminance(); 3],
                        };
                        for (channel, line) in values.iter_mut().enumerate() {
                            let mapped = params.maps[channel].forward(split[channel], cos_theta_i);
                            line[index] = narrow(mapped);
                        }
                    }
                },
            );
        }
        let valid: Vec<bool> = state.iter().map(|s| s.origin == Origin::Own).collect();
        let counts = count_cells(&state, &valid, rows.len());
        if counts.valid == 0 {
            return Err(SeparableError::NoData { rows: rows.len(), columns: columns.len() });
        }
        let scales = [&rows, &columns].map(|nodes| {
            let scale = |n: &Node| n.weight.sqrt() * n.direction.z.powf(params.weight_power);
            nodes.iter().map(scale).collect()
        });
        Ok(Self {
            layout: *layout,
            rows,
            columns,
            channels,
            maps: params.maps[..count].to_vec(),
            valid,
            scales,
            counts,
        })
    }

    /// Returns the layout: the two sides.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Returns the nodes of the first grid.
    pub fn rows(&self) -> &[Node] {
        &self.rows
    }

    /// Returns the nodes of the second grid.
    pub fn columns(&self) -> &[Node] {
        &self.columns
    }

    /// Returns the mapped values of a channel, without weights.
    pub fn channel(&self, channel: usize) -> Mat<f64> {
        self.weighted(channel, |_, _| 1.0)
    }

    /// S_r M S_c of a channel, with the square roots of the weights of rows and columns.
    pub(crate) fn scaled(&self, channel: usize) -> Mat<f64> {
        let [rows, columns] = &self.scales;
        self.weighted(channel, |row, column| rows[row] * columns[column])
    }

    fn weighted(&self, channel: usize, weight: impl Fn(usize, usize) -> f64) -> Mat<f64> {
        let (size, values) = (self.rows.len(), &self.channels[channel]);
        Mat::from_fn(size, self.columns.len(), |row, column| {
            weight(row, column) * f64::from(values[row + column * size])
        })
    }

    /// Returns the value map of each channel.
    pub fn maps(&self) -> &[ValueTransform] {
        &self.maps
    }

    /// Returns the numbers of cells by the origin of their values.
    pub fn counts(&self) -> CellCounts {
        self.counts
    }

    /// Returns ‖M − Mᵀ‖ / ‖M‖, the largest over channels, or `None` where the two sides differ.
    pub fn asymmetry(&self) -> Option<f64> {
        let size = self.rows.len();
        let of = |values: &Vec<f32>| {
            let mut off = 0.0;
            for_transposed(size, |a, b| off += 2.0 * f64::from(values[a] - values[b]).powi(2));
            ratio(off, values.iter().map(|v| f64::from(*v).powi(2)).sum())
        };
        self.layout.is_symmetric().then(|| self.channels.iter().map(of).fold(0.0, f64::max))
    }

    /// Square roots of the weights of rows and columns.
    pub(crate) fn scales(&self) -> &[Vec<f64>; 2] {
        &self.scales
    }

    /// Returns the symmetric matrix (M + Mᵀ)/2, which belongs to a reciprocal material.
    ///
    /// # Errors
    ///
    /// [`SeparableError::NotSymmetric`] where the two sides differ.
    pub fn symmetrized(mut self) -> Result<Self, SeparableError> {
        if !self.layout.is_symmetric() {
            return Err(SeparableError::NotSymmetric {
                found: "the two sides of this layout differ",
                expected: "the standard parametrization and the same chart for light and view",
            });
        }
        let size = self.rows.len();
        for values in &mut self.channels {
            for_transposed(size, |a, b| {
                let mean = 0.5 * (values[a] + values[b]);
                (values[a], values[b]) = (mean, mean);
            });
        }
        Ok(self)
    }

    /// Returns the errors of a model of this matrix, cut to each of the ranks given; the largest must be last.
    pub fn rank_errors(&self, model: &SeparableBrdf, ranks: &[usize]) -> Vec<RankError> {
        let most = ranks.iter().copied().max().unwrap_or(0);
        let sums: Vec<Sums> = (0..self.columns.len())
            .into_par_iter()
            .map(|column| self.column_sums(model, column, most))
            .collect();
        // Summed in the order of the columns, whatever the number of threads.
        let total = sums.into_iter().fold(Sums::new(most), Sums::plus);
        ranks
            .iter()
            .map(|&rank| RankError {
                rank,
                relative_residual: ratio(total.residual[rank], total.energy),
                log_cosine_rms: ratio(total.log_cosine[rank], total.valid),
            })
            .collect()
    }

    fn column_sums(&self, model: &SeparableBrdf, column: usize, most: usize) -> Sums {
        let mut sums = Sums::new(most);
        let second = &self.columns[column];
        for (row, first) in self.rows.iter().enumerate() {
            let cell = row + column * self.rows.len();
            let weight = (self.scales[0][row] * self.scales[1][column]).powi(2);
            let pair = self.valid[cell]
                .then(|| self.layout.pair([first.direction, second.direction]))
                .flatten();
            for (channel, map) in self.maps.iter().enumerate() {
                let exact = f64::from(self.channels[channel][cell]);
                sums.energy += weight * exact * exact;
                let mut sum = 0.0;
                let cos_theta_i = pair.map(|p| p.wi.z);
                let shown = |value: f64, c: f64| (map.inverse(value, c).max(0.0) * c).ln_1p();
                let target = cos_theta_i.map(|c| shown(exact, c));
                for rank in 0..=most {
                    if rank > 0 {
                        sum += model.term_at(rank - 1, channel, first.texel, second.texel);
                    }
                    sums.residual[rank] += weight * (exact - sum).powi(2);
                    if let (Some(c), Some(target)) = (cos_theta_i, target) {
                        sums.log_cosine[rank] += (target - shown(sum, c)).powi(2);
                    }
                }
                sums.valid += f64::from(u8::from(pair.is_some()));
            }
        }
        sums
    }
}

/// Every entry below the diagonal of a column-major matrix and its mirror image, tile by tile: whole
/// columns against whole rows would miss the cache at every step.
fn for_transposed(size: usize, mut visit: impl FnMut(usize, usize)) {
    const TILE: usize = 32;
    for tile in (0..size).step_by(TILE) {
        for across in (0..=tile).step_by(TILE) {
            for row in tile..(tile + TILE).min(size) {
                for column in across..(across + TILE).min(row) {
                    visit(row + column * size, column + row * size);
                }
            }
        }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "the narrowing that tables are stored with")]
fn narrow(value: f64) -> f32 {
    value as f32
}

/// √(part / whole), 0 of nothing.
fn ratio(part: f64, whole: f64) -> f64 {
    if whole > 0.0 { (part / whole).sqrt() } else { 0.0 }
}

/// Sums over cells, for every rank from 0 on.
struct Sums {
    energy: f64,
    residual: Vec<f64>,
    log_cosine: Vec<f64>,
    valid: f64,
}

impl Sums {
    fn new(most: usize) -> Self {
        Self {
            energy: 0.0,
            residual: vec![0.0; most + 1],
            log_cosine: vec![0.0; most + 1],
            valid: 0.0,
        }
    }

    fn plus(mut self, other: Self) -> Self {
        let add = |a: &mut [f64], b: &[f64]| a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
        self.energy += other.energy;
        self.valid += other.valid;
        add(&mut self.residual, &other.residual);
        add(&mut self.log_cosine, &other.log_cosine);
        self
    }
}

/// Where the value of a cell came from.
#[derive(Clone, Copy, Default, PartialEq)]
enum Origin {
    Own,
    Nearest,
    #[default]
    Nothing,
}

#[derive(Clone, Copy, Default)]
struct CellState {
    origin: Origin,
    /// The material gave a negative channel.
    clamped: bool,
}

/// One cell before it is sampled.
struct Cell<'a> {
    layout: &'a Layout,
    params: &'a MatrixParams,
    /// The cosine that both directions exceed.
    limit: f64,
    points: [DVec3; 2],
}

impl Cell<'_> {
    /// The value, the cosine of the light it belongs to, and where it came from.
    fn sample(&self, brdf: &dyn Brdf) -> (Rgb, f64, CellState) {
        let own = self.layout.pair(self.points);
        let (pair, origin) = match own {
            Some(pair) if pair.wi.z.min(pair.wo.z) > self.limit && brdf.has_data(&pair) => {
                (Some(pair), Origin::Own)
            }
            _ if self.params.fill == Fill::Edge => (self.nearest_with_data(brdf), Origin::Nearest),
            _ => (None, Origin::Nothing),
        };
        let Some(pair) = pair else {
            return (Rgb::BLACK, own.map_or(0.0, |pair| pair.wi.z), CellState::default());
        };
        let value = brdf.eval_unclamped(&pair);
        let clamped = value.channels().iter().any(|v| *v < 0.0);
        (value.map(|v| v.max(0.0)), pair.wi.z, CellState { origin, clamped })
    }

    /// Pulls the second point, then both, towards the pole until there is data.
    fn nearest_with_data(&self, brdf: &dyn Brdf) -> Option<DirectionPair> {
        let [first, second] = self.points;
        let steps = || (0..=PULL_STEPS).map(|step| 1.0 - f64::from(step) / f64::from(PULL_STEPS));
        let second_alone = steps().map(|t| [first, lowered(second, t)]);
        let both = steps().map(|t| [lowered(first, t), lowered(second, t)]);
        second_alone
            .chain(both)
            .filter_map(|points| self.layout.pair(points))
            .map(|pair| pulled_back(&pair, self.params.theta_max))
            .find(|pair| brdf.has_data(pair))
    }
}

/// The cosine of the grazing limit; that of a right angle is 6e-17.
fn cosine_limit(theta_max: f64) -> f64 {
    let cosine = theta_max.cos();
    if cosine < 1e-12 { 0.0 } else { cosine }
}

/// The direction at a share of its polar angle.
fn lowered(direction: DVec3, share: f64) -> DVec3 {
    spherical_direction(share * polar_angle(direction), azimuth(direction))
}

/// Both directions within the limit, by a hair, so that nothing falls on the horizon.
fn pulled_back(pair: &DirectionPair, theta_max: f64) -> DirectionPair {
    let limit = theta_max - 1e-3;
    let pull = |w: DVec3| {
        if polar_angle(w) > limit { spherical_direction(limit, azimuth(w)) } else { w }
    };
    DirectionPair::new(pull(pair.wi), pull(pair.wo))
}

fn count_cells(state: &[CellState], valid: &[bool], rows: usize) -> CellCounts {
    let of = |origin| state.iter().filter(|s| s.origin == origin).count();
    let known_rows = (0..rows).filter(|&r| valid.iter().skip(r).step_by(rows).any(|v| *v)).count();
    let known_columns = valid.chunks(rows).filter(|line| line.contains(&true)).count();
    CellCounts {
        cells: state.len(),
        valid: of(Origin::Own),
        filled: of(Origin::Nearest),
        zero: of(Origin::Nothing),
        unknown_lines: (rows - known_rows) + (valid.len() / rows - known_columns),
        clamped: state.iter().filter(|s| s.clamped).count(),
    }
}
