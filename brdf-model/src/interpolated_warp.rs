//! Two-dimensional tables that depend on up to two parameters: bilinear lookup, and the warp under
//! which the density of such a table becomes uniform.
//!
//! Source: Dupuy and Jakob 2018, "An Adaptive Parameterization for Efficient Material Acquisition
//! and Rendering", supplemental material on bilinear warps.

use glam::DVec2;

use crate::ModelError;

/// The sizes and parameter nodes of an [`InterpolatedWarp`].
#[derive(Clone, Debug, PartialEq)]
pub struct WarpShape {
    /// Columns of each slice, ≥ 2.
    pub width: usize,
    /// Rows of each slice, ≥ 2.
    pub height: usize,
    /// Nodes of the slower parameter, ascending; one node means no dependence.
    pub phi: Vec<f32>,
    /// Nodes of the faster parameter, ascending; one node means no dependence.
    pub theta: Vec<f32>,
}

/// A table over the unit square that depends on up to two parameters, linear between its nodes.
///
/// It holds a slice of `height` × `width` values for each pair of parameter nodes, stored row by row.
///
/// ```
/// use brdf_model::{InterpolatedWarp, WarpShape};
/// use glam::DVec2;
///
/// let shape = WarpShape { width: 2, height: 2, phi: vec![0.0], theta: vec![0.0] };
/// let table = InterpolatedWarp::lookup("ramp", shape, vec![0.0, 2.0, 0.0, 2.0])?;
/// assert!((table.eval(DVec2::new(0.25, 0.7), 0.0, 0.0) - 0.5).abs() < 1e-6);
/// # Ok::<(), brdf_model::ModelError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct InterpolatedWarp {
    shape: WarpShape,
    /// Shape `[phi, theta, height, width]`.
    values: Vec<f32>,
    cumulative: Option<Cumulative>,
}

/// Running integrals in units of whole patches.
#[derive(Clone, Debug, PartialEq)]
struct Cumulative {
    /// Along each row, shape `[phi, theta, height, width]`.
    rows: Vec<f32>,
    /// Over rows, shape `[phi, theta, height]`.
    columns: Vec<f32>,
}

impl InterpolatedWarp {
    /// Returns a table for lookup only; `table` is its name in errors.
    ///
    /// # Errors
    ///
    /// [`ModelError::TableShape`] unless each slice is at least 2 × 2 and each parameter has
    /// ascending nodes; [`ModelError::TableSize`] unless the values fill the shape;
    /// [`ModelError::TableValue`] unless they are finite.
    pub fn lookup(
        table: &'static str,
        shape: WarpShape,
        values: Vec<f32>,
    ) -> Result<Self, ModelError> {
        let slice = [shape.width, shape.height];
        if slice.iter().any(|&side| side < 2) {
            return Err(ModelError::TableShape {
                table,
                shape: slice.to_vec(),
                expected: "at least two nodes a side",
            });
        }
        for nodes in [&shape.phi, &shape.theta] {
            // Written so that NaN nodes are refused.
            if nodes.is_empty() || !nodes.windows(2).all(|w| w[0] < w[1]) {
                return Err(ModelError::TableShape {
                    table,
                    shape: vec![nodes.len()],
                    expected: "parameter nodes in ascending order",
                });
            }
        }
        let expected = shape.phi.len() * shape.theta.len() * shape.width * shape.height;
        if values.len() != expected {
            return Err(ModelError::TableSize { table, expected, found: values.len() });
        }
        if let Some((index, &value)) = values.iter().enumerate().find(|(_, v)| !v.is_finite()) {
            return Err(ModelError::TableValue {
                table,
                index,
                value: value.into(),
                expected: "finite values",
            });
        }
        Ok(Self { shape, values, cumulative: None })
    }

    /// Returns a table that is also a pdf; each slice is scaled so that it integrates to 1.
    ///
    /// The values must not be negative, and some value of every slice must be positive.
    ///
    /// # Errors
    ///
    /// As [`InterpolatedWarp::lookup`], and [`ModelError::TableValue`] for a negative value or a slice
    /// of zeros.
    pub fn pdf(
        table: &'static str,
        shape: WarpShape,
        values: Vec<f32>,
    ) -> Result<Self, ModelError> {
        let mut warp = Self::lookup(table, shape, values)?;
        if let Some((index, &value)) = warp.values.iter().enumerate().find(|(_, v)| **v < 0.0) {
            return Err(ModelError::TableValue {
                table,
                index,
                value: value.into(),
                expected: "a pdf, which is not negative",
            });
        }
        let (width, height) = (warp.shape.width, warp.shape.height);
        let mut rows = Vec::with_capacity(warp.values.len());
        let mut columns = Vec::with_capacity(warp.values.len() / width);
        for (slice, values) in warp.values.chunks_exact_mut(width * height).enumerate() {
            let total = accumulate(values, width, &mut rows, &mut columns);
            if !total.is_finite() || total <= 0.0 {
                return Err(ModelError::TableValue {
                    table,
                    index: slice * width * height,
                    value: total,
                    expected: "a slice that is positive somewhere",
                });
            }
            let tail = |all: usize, len: usize| all - len;
            let (row_start, column_start) =
                (tail(rows.len(), width * height), tail(columns.len(), height));
            #[expect(clippy::cast_possible_truncation, reason = "tables are f32")]
            let scale = (1.0 / total) as f32;
            let scaled = [values, &mut rows[row_start..], &mut columns[column_start..]];
            scaled.into_iter().flatten().for_each(|v| *v *= scale);
        }
        warp.cumulative = Some(Cumulative { rows, columns });
        Ok(warp)
    }

    /// Returns the value at a point of the unit square, for parameters clamped to the range of their
    /// nodes.
    pub fn eval(&self, point: DVec2, phi: f64, theta: f64) -> f64 {
        let patch = Patch::new(&self.shape, point);
        let slices = Slices::new(&self.shape, phi, theta);
        patch.bilinear(&slices.corners(&self.values, &self.shape, &patch))
    }

    /// Returns the cumulative distribution of the pdf at (phi, theta): first along the row of `point`,
    /// then over the rows.
    ///
    /// Points drawn from the pdf are mapped to points that are uniform on the unit square. A table
    /// that is no pdf maps every point to itself.
    pub fn invert(&self, point: DVec2, phi: f64, theta: f64) -> DVec2 {
        let Some(cumulative) = &self.cumulative else { return point };
        let shape = &self.shape;
        let patch = Patch::new(shape, point);
        let slices = Slices::new(shape, phi, theta);
        let [v00, v10, v01, v11] = slices.corners(&self.values, shape, &patch);
        let (u, v) = (patch.fraction.x, patch.fraction.y);

        let left = (1.0 - v) * v00 + v * v01;
        let right = (1.0 - v) * v10 + v * v11;
        let within_patch = u * (left + 0.5 * u * (right - left));
        let row = |table: &[f32], column: usize| {
            let at =
                |y: usize| slices.mix(table, shape.width * shape.height, y * shape.width + column);
            [at(patch.row), at(patch.row + 1)]
        };
        let [low, high] = row(&cumulative.rows, patch.column);
        let before_patch = (1.0 - v) * low + v * high;
        let [row_low, row_high] = row(&cumulative.rows, shape.width - 1);
        let whole_row = (1.0 - v) * row_low + v * row_high;
        let x = if whole_row > 0.0 { (within_patch + before_patch) / whole_row } else { u };

        let rows_below = slices.mix(&cumulative.columns, shape.height, patch.row);
        let y = rows_below + v * (row_low + 0.5 * v * (row_high - row_low));
        DVec2::new(x, y)
    }
}

/// Appends the running integrals of one slice and returns its total.
fn accumulate(values: &[f32], width: usize, rows: &mut Vec<f32>, columns: &mut Vec<f32>) -> f64 {
    #[expect(clippy::cast_possible_truncation, reason = "tables are f32")]
    let narrow = |v: f64| v as f32;
    let mut row_totals = Vec::with_capacity(values.len() / width);
    for row in values.chunks_exact(width) {
        let mut sum = 0.0;
        rows.push(0.0);
        for pair in row.windows(2) {
            sum += 0.5 * (f64::from(pair[0]) + f64::from(pair[1]));
            rows.push(narrow(sum));
        }
        row_totals.push(sum);
    }
    let mut total = 0.0;
    columns.push(0.0);
    for pair in row_totals.windows(2) {
        total += 0.5 * (pair[0] + pair[1]);
        columns.push(narrow(total));
    }
    total
}

/// The bilinear patch that holds a point.
struct Patch {
    column: usize,
    row: usize,
    fraction: DVec2,
}

impl Patch {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "positions are clamped to the table, whose sides are far below 2⁵³"
    )]
    fn new(shape: &WarpShape, point: DVec2) -> Self {
        let side = |position: f64, nodes: usize| {
            let scaled = position.clamp(0.0, 1.0) * (nodes - 1) as f64;
            let low = (scaled as usize).min(nodes - 2);
            (low, scaled - low as f64)
        };
        let (column, u) = side(point.x, shape.width);
        let (row, v) = side(point.y, shape.height);
        Self { column, row, fraction: DVec2::new(u, v) }
    }

    fn bilinear(&self, [v00, v10, v01, v11]: &[f64; 4]) -> f64 {
        let (u, v) = (self.fraction.x, self.fraction.y);
        (1.0 - v) * ((1.0 - u) * v00 + u * v10) + v * ((1.0 - u) * v01 + u * v11)
    }
}

/// The parameter slices around (phi, theta) and their weights.
struct Slices([(usize, f64); 4]);

impl Slices {
    fn new(shape: &WarpShape, phi: f64, theta: f64) -> Self {
        let [(p0, wp0), (p1, wp1)] = interval(&shape.phi, phi);
        let [(t0, wt0), (t1, wt1)] = interval(&shape.theta, theta);
        let slice = |p: usize, t: usize| p * shape.theta.len() + t;
        Self([
            (slice(p0, t0), wp0 * wt0),
            (slice(p0, t1), wp0 * wt1),
            (slice(p1, t0), wp1 * wt0),
            (slice(p1, t1), wp1 * wt1),
        ])
    }

    /// The entry at `offset` of slices of `len` entries, interpolated over the parameters.
    fn mix(&self, table: &[f32], len: usize, offset: usize) -> f64 {
        self.0
            .iter()
            .filter(|(_, weight)| *weight != 0.0)
            .map(|&(slice, weight)| weight * f64::from(table[slice * len + offset]))
            .sum()
    }

    fn corners(&self, table: &[f32], shape: &WarpShape, patch: &Patch) -> [f64; 4] {
        let offset = patch.row * shape.width + patch.column;
        [0, 1, shape.width, shape.width + 1]
            .map(|step| self.mix(table, shape.width * shape.height, offset + step))
    }
}

/// The two nodes around a parameter and their weights; clamped at both ends.
fn interval(nodes: &[f32], parameter: f64) -> [(usize, f64); 2] {
    if nodes.len() == 1 {
        return [(0, 1.0), (0, 0.0)];
    }
    let above = nodes.partition_point(|&node| f64::from(node) <= parameter);
    let low = above.clamp(1, nodes.len() - 1) - 1;
    let (a, b) = (f64::from(nodes[low]), f64::from(nodes[low + 1]));
    let fraction = ((parameter - a) / (b - a)).clamp(0.0, 1.0);
    [(low, 1.0 - fraction), (low + 1, fraction)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shape() -> WarpShape {
        WarpShape { width: 4, height: 3, phi: vec![0.0], theta: vec![0.0, 1.0] }
    }

    #[test]
    fn an_even_density_moves_nothing() {
        let warp = InterpolatedWarp::pdf("even", shape(), vec![3.0; 24]).unwrap();
        let point = DVec2::new(0.3, 0.85);
        assert!(warp.invert(point, 0.0, 0.4).distance(point) < 1e-6);
    }

    #[test]
    fn the_derivative_of_the_inverse_is_the_density() {
        let values: Vec<f32> = (0..24_u8).map(|i| 1.0 + f32::from(i * 7 % 11)).collect();
        let warp = InterpolatedWarp::pdf("test", shape(), values).unwrap();
        let (point, step) = (DVec2::new(0.37, 0.61), 1e-5);
        let at = |dx: f64, dy: f64| warp.invert(point + DVec2::new(dx, dy), 0.0, 0.3);
        let dx = (at(step, 0.0) - at(-step, 0.0)) / (2.0 * step);
        let dy = (at(0.0, step) - at(0.0, -step)) / (2.0 * step);
        // Values are per patch; there are 3 × 2 of them on the unit square.
        let pdf = warp.eval(point, 0.0, 0.3) * 6.0;
        assert!((dx.perp_dot(dy) - pdf).abs() < 1e-4 * pdf, "{pdf}");
    }

    #[test]
    fn bad_tables_are_refused() {
        let nan = InterpolatedWarp::lookup("t", shape(), vec![f32::NAN; 24]);
        assert!(matches!(nan, Err(ModelError::TableValue { index: 0, .. })), "{nan:?}");
        let short = InterpolatedWarp::lookup("t", shape(), vec![1.0; 23]);
        assert!(matches!(short, Err(ModelError::TableSize { expected: 24, .. })), "{short:?}");
        let dark = InterpolatedWarp::pdf("t", shape(), vec![0.0; 24]);
        assert!(matches!(dark, Err(ModelError::TableValue { .. })), "{dark:?}");
    }
}
