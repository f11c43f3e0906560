//! Grids of texels: their places, a mask of those in use, and linear interpolation between them.

use brdf_param::convex_hull;
use glam::DVec2;
use serde::{Deserialize, Serialize};

/// The grid of a factor's texels, in one or two dimensions.
///
/// In two dimensions texel (i, j) lies at (−1 + 2i/(columns−1), −1 + 2j/(rows−1)), row j; in one
/// dimension, where there is one row, texel i lies at i/(columns−1).
///
/// ```
/// use brdf_factor::Grid;
/// use glam::DVec2;
///
/// let grid = Grid { columns: 5, rows: 3 };
/// assert_eq!((grid.texels(), grid.dimensions()), (15, 2));
/// assert_eq!(grid.position(7), DVec2::ZERO, "the middle of the texture");
/// assert_eq!(Grid::line(4).dimensions(), 1);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Grid {
    /// Number of texels in a row, ≥ 2.
    pub columns: usize,
    /// Number of rows: 1 in one dimension, else ≥ 2.
    pub rows: usize,
}

/// The texels around a point and their weights: four in two dimensions, two in one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Taps {
    texels: [usize; 4],
    weights: [f64; 4],
    count: usize,
}

impl Taps {
    pub(crate) fn iter(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.texels.iter().copied().zip(self.weights).take(self.count)
    }
}

impl Grid {
    /// The range of sizes that a side of a texture can have.
    pub const SIZES: std::ops::RangeInclusive<usize> = 2..=1024;

    /// Returns a square of `size`² texels.
    pub fn square(size: usize) -> Self {
        Self { columns: size, rows: size }
    }

    /// Returns a line of `size` texels.
    pub fn line(size: usize) -> Self {
        Self { columns: size, rows: 1 }
    }

    /// Returns the number of dimensions, 1 or 2.
    pub fn dimensions(&self) -> usize {
        if self.rows == 1 { 1 } else { 2 }
    }

    /// Returns the number of texels.
    pub fn texels(&self) -> usize {
        self.columns * self.rows
    }

    /// Returns the texture coordinates of a texel, given by its index row by row.
    pub fn position(&self, texel: usize) -> DVec2 {
        let (column, row) = ((texel % self.columns) as f64, (texel / self.columns) as f64);
        let x = column / (self.columns - 1) as f64;
        match self.dimensions() {
            1 => DVec2::new(x, 0.0),
            _ => DVec2::new(-1.0 + 2.0 * x, -1.0 + 2.0 * row / (self.rows - 1) as f64),
        }
    }

    /// The texels around a point, which is moved to the rim if it lies outside.
    pub(crate) fn taps(&self, point: DVec2) -> Taps {
        if self.dimensions() == 1 {
            let (low, f) = cell(point.x * (self.columns - 1) as f64, self.columns);
            return Taps {
                texels: [low, low + 1, 0, 0],
                weights: [1.0 - f, f, 0.0, 0.0],
                count: 2,
            };
        }
        let ([column, row], [u, v]) = self.place(0.5 * (point + 1.0));
        let corner = row * self.columns + column;
        Taps {
            texels: [corner, corner + 1, corner + self.columns, corner + self.columns + 1],
            weights: [(1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v],
            count: 4,
        }
    }

    /// The texel below a place of the unit square, and the way to the next.
    pub(crate) fn place(&self, place: DVec2) -> ([usize; 2], [f64; 2]) {
        let (column, u) = cell(place.x * (self.columns - 1) as f64, self.columns);
        let (row, v) = cell(place.y * (self.rows - 1) as f64, self.rows);
        ([column, row], [u, v])
    }

    /// The point lies on the grid, to rounding.
    pub(crate) fn holds(&self, point: DVec2) -> bool {
        let slack = 1e-9;
        match self.dimensions() {
            1 => (-slack..=1.0 + slack).contains(&point.x),
            _ => point.abs().max_element() <= 1.0 + slack,
        }
    }

    /// The texels that can matter for points inside the convex hull of `outline`: those less than
    /// one texel away from it, row by row. In one dimension, all.
    pub(crate) fn mask(&self, outline: &[DVec2]) -> Vec<bool> {
        if self.dimensions() == 1 || outline.len() < 3 {
            return vec![true; self.texels()];
        }
        let texel = 2.0 / DVec2::new((self.columns - 1) as f64, (self.rows - 1) as f64);
        let hull = convex_hull(outline);
        // A texel exactly one step away has no weight, but must not be lost to rounding either.
        let slack = 1e-9;
        let edges: Vec<(DVec2, f64)> = hull
            .iter()
            .zip(hull.iter().cycle().skip(1))
            .map(|(&a, &b)| {
                let outward = -(b - a).perp();
                // The hull grown by a texel along both axes.
                let grown = outward.abs().dot(texel + slack);
                (outward, outward.dot(a) + grown)
            })
            .collect();
        (0..self.rows).flat_map(|row| self.masked_row(row, &edges)).collect()
    }

    /// The texels of a row within all half-planes outward · point ≤ limit.
    fn masked_row(&self, row: usize, edges: &[(DVec2, f64)]) -> impl Iterator<Item = bool> + use<> {
        let y = self.position(row * self.columns).y;
        let (mut from, mut to) = (f64::NEG_INFINITY, f64::INFINITY);
        for &(outward, limit) in edges {
            let rest = limit - outward.y * y;
            if outward.x > 0.0 {
                to = to.min(rest / outward.x);
            } else if outward.x < 0.0 {
                from = from.max(rest / outward.x);
            } else if rest < 0.0 {
                to = f64::NEG_INFINITY;
            }
        }
        let grid = *self;
        (0..self.columns).map(move |column| (from..=to).contains(&grid.position(column).x))
    }

    /// The existing neighbours of a texel along the axes.
    pub(crate) fn neighbours(&self, texel: usize) -> impl Iterator<Item = usize> + use<> {
        let (columns, rows) = (self.columns, self.rows);
        let (column, row) = (texel % columns, texel / columns);
        [
            (column > 0).then(|| texel - 1),
            (column + 1 < columns).then_some(texel + 1),
            (row > 0).then(|| texel - columns),
            (row + 1 < rows).then_some(texel + columns),
        ]
        .into_iter()
        .flatten()
    }

    /// Gives every texel outside the mask the mean of its known neighbours, ring by ring, so that
    /// lookups which stray by a rounding error stay sensible.
    pub(crate) fn fill_unmasked<const N: usize>(&self, mask: &[bool], texels: &mut [[f32; N]]) {
        let mut known = mask.to_vec();
        while known.iter().any(|k| !k) && known.iter().any(|k| *k) {
            let ring: Vec<(usize, [f32; N])> = (0..self.texels())
                .filter(|&t| !known[t])
                .filter_map(|t| {
                    let around: Vec<usize> = self.neighbours(t).filter(|&n| known[n]).collect();
                    let count = f32::from(u8::try_from(around.len()).unwrap_or(4));
                    (!around.is_empty()).then(|| {
                        let mean = std::array::from_fn(|c| {
                            around.iter().map(|&n| texels[n][c]).sum::<f32>() / count
                        });
                        (t, mean)
                    })
                })
                .collect();
            for (texel, value) in ring {
                texels[texel] = value;
                known[texel] = true;
            }
        }
    }
}

/// The texel below a position, in texels of a side of `count`, and the way to the next. A position beyond the
/// side is moved to its end.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "positions are clamped to the texture"
)]
#[inline]
pub(crate) fn cell(position: f64, count: usize) -> (usize, f64) {
    let inside = position.clamp(0.0, (count - 1) as f64);
    let low = (inside as usize).min(count - 2);
    (low, inside - low as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn taps_reproduce_a_linear_function() {
        let grid = Grid { columns: 7, rows: 5 };
        let linear = |p: DVec2| 3.0 + 2.0 * p.x - 5.0 * p.y;
        for point in [DVec2::new(-1.0, 1.0), DVec2::new(0.123, -0.77), DVec2::ONE] {
            let read: f64 =
                grid.taps(point).iter().map(|(t, w)| w * linear(grid.position(t))).sum();
            assert!((read - linear(point)).abs() < 1e-12, "{read} at {point}");
        }
    }

    #[test]
    fn every_tap_of_a_point_inside_the_outline_is_masked_in() {
        let grid = Grid { columns: 9, rows: 14 };
        // A sliver thinner than a texel.
        let outline = [(-0.9, -0.91), (0.9, 0.88), (0.9, 0.89)].map(DVec2::from);
        let mask = grid.mask(&outline);
        for step in 0..=1000 {
            let point = outline[0].lerp(outline[1], f64::from(step) / 1000.0);
            assert!(grid.taps(point).iter().all(|(t, _)| mask[t]), "at {point}");
        }
        assert!(mask.iter().any(|m| !m), "far corners are masked out");
    }

    #[test]
    fn unmasked_texels_take_the_nearest_ring() {
        let grid = Grid::square(3);
        let mut texels = [[0.0_f32]; 9];
        texels[4] = [2.0];
        let mask: Vec<bool> = (0..9).map(|t| t == 4).collect();
        grid.fill_unmasked(&mask, &mut texels);
        assert!(texels.iter().all(|t| (t[0] - 2.0).abs() < 1e-6), "{texels:?}");
    }
}
