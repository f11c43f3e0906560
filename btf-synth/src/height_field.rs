//! The height field: bilinear between texel centres, repeating in both directions.
//!
//! Positions are in texels: x to the right, y along the rows (downwards in the image), z up; a
//! texel's centre stands at whole numbers. Everything is f32: the tile has at most 1024 texels, and
//! a ray is found to 1e-3 texels or so, far below the spacing of the samples.

use crate::SurfaceMaps;

/// Horizontal length of a step along a ray, in texels. Between two steps a ray can miss the corner
/// of a cell, of which it would see at most this much.
const STEP: f32 = 0.5;

/// Rounds of false position after a ray went below the surface; two suffice within a cell, where
/// the surface is nearly straight.
const REFINEMENTS: usize = 3;

/// Rays that rise as slowly as to reach the top only after so many tiles are given up.
const MAX_TILES: f32 = 4.0;

/// A position on the tile, z up, in texels.
pub(crate) type Place = [f32; 3];

/// The four texels around a place and their bilinear weights.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Taps {
    pub(crate) texels: [usize; 4],
    pub(crate) weights: [f32; 4],
}

impl Taps {
    /// The texel with the largest weight.
    pub(crate) fn nearest(&self) -> usize {
        let mut best = 0;
        for tap in 1..4 {
            if self.weights[tap] > self.weights[best] {
                best = tap;
            }
        }
        self.texels[best]
    }
}

#[derive(Debug)]
pub(crate) struct HeightField {
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// Heights in texels, with the first column and row repeated at the end.
    padded: Vec<f32>,
    /// Lowest and highest.
    pub(crate) range: [f32; 2],
    sides: [f32; 2],
}

impl HeightField {
    pub(crate) fn new(maps: &SurfaceMaps) -> Self {
        let (width, height) = (maps.width(), maps.height());
        let texels_per_unit = width as f32;
        let padded: Vec<f32> = (0..=height)
            .flat_map(|row| (0..=width).map(move |column| (row, column)))
            .map(|(row, column)| maps.heights()[row % height * width + column % width])
            .map(|value| value * texels_per_unit)
            .collect();
        let range = padded
            .iter()
            .fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], &z| [low.min(z), high.max(z)]);
        Self { width, height, padded, range, sides: [width as f32, height as f32] }
    }

    /// The height at a texel's centre.
    pub(crate) fn at(&self, texel: usize) -> f32 {
        self.padded[texel / self.width * (self.width + 1) + texel % self.width]
    }

    /// Slopes along x and y at a texel's centre, by central differences.
    pub(crate) fn gradient(&self, texel: usize) -> [f32; 2] {
        let (row, column) = (texel / self.width, texel % self.width);
        let z = |row: usize, column: usize| {
            self.at(row % self.height * self.width + column % self.width)
        };
        [
            0.5 * (z(row, column + 1) - z(row, column + self.width - 1)),
            0.5 * (z(row + 1, column) - z(row + self.height - 1, column)),
        ]
    }

    /// The place of a texel's centre, on the surface.
    pub(crate) fn centre(&self, texel: usize) -> Place {
        [(texel % self.width) as f32, (texel / self.width) as f32, self.at(texel)]
    }

    /// The same place on the tile itself: x and y from 0 to below its sides.
    pub(crate) fn wrapped(&self, [x, y, z]: Place) -> Place {
        let [x, y] = [(x, self.sides[0]), (y, self.sides[1])].map(|(value, side)| {
            let rest = value.rem_euclid(side);
            // The remainder of a tiny negative number rounds up to the side itself.
            if rest < side { rest } else { 0.0 }
        });
        [x, y, z]
    }

    /// The texels around a place on the tile.
    pub(crate) fn taps(&self, [x, y, _]: Place) -> Taps {
        let ([column, row], [fx, fy]) = self.cell(x, y);
        let next = if column + 1 == self.width { 0 } else { column + 1 };
        let below = if row + 1 == self.height { 0 } else { row + 1 };
        let (row, below) = (row * self.width, below * self.width);
        Taps {
            texels: [row + column, row + next, below + column, below + next],
            weights: [(1.0 - fx) * (1.0 - fy), fx * (1.0 - fy), (1.0 - fx) * fy, fx * fy],
        }
    }

    /// The cell of a place on the tile, and where in the cell it is.
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 and above")]
    fn cell(&self, x: f32, y: f32) -> ([usize; 2], [f32; 2]) {
        let (column, row) = (x as i32, y as i32);
        ([column as usize, row as usize], [x - column as f32, y - row as f32])
    }

    /// The height at a place on the tile.
    #[inline(always)]
    fn height_at(&self, x: f32, y: f32) -> f32 {
        let ([column, row], [fx, fy]) = self.cell(x, y);
        let start = row * (self.width + 1) + column;
        let above = &self.padded[start..start + 2];
        let below = &self.padded[start + self.width + 1..start + self.width + 3];
        let upper = above[0] + fx * (above[1] - above[0]);
        let lower = below[0] + fx * (below[1] - below[0]);
        upper + fy * (lower - upper)
    }

    /// A step of less than a tile from a place on the tile.
    #[inline(always)]
    fn moved(&self, [x, y, z]: Place, step: Place, share: f32) -> Place {
        [
            wrap_once(x + share * step[0], self.sides[0]),
            wrap_once(y + share * step[1], self.sides[1]),
            z + share * step[2],
        ]
    }

    /// Where a line of sight first meets the surface. It passes through `plane_point` (z = 0) and
    /// goes along `wo` (z > 0, y along the rows) up to the viewer.
    pub(crate) fn seen_from(&self, plane_point: [f32; 2], wo: Place) -> Place {
        let [low, high] = self.range;
        let shift = [wo[0] / wo[2], wo[1] / wo[2]];
        let top = [plane_point[0] + high * shift[0], plane_point[1] + high * shift[1], high];
        let run = (high - low) * shift[0].hypot(shift[1]);
        let count = (run / STEP).ceil().max(1.0);
        let dz = (high - low) / count;
        let step = [-dz * shift[0], -dz * shift[1], -dz];
        // The line ends at the lowest height and cannot miss, save for rounding there.
        let start = self.wrapped(top);
        self.first_hit(start, step, count)
            .unwrap_or_else(|| self.wrapped(std::array::from_fn(|i| start[i] + count * step[i])))
    }

    /// Where a ray from the surface at `start` along the unit direction `along` meets it again.
    pub(crate) fn hit_from(&self, start: Place, along: Place) -> Option<Place> {
        let sides = self.sides[0].max(self.sides[1]);
        let run = along[0].hypot(along[1]);
        // Steep rays advance by height instead.
        let stride = STEP / run.max(0.25);
        let step = along.map(|component| component * stride);
        let [low, high] = self.range;
        let rise = if along[2] > 0.0 { high - start[2] } else { start[2] - low };
        let count = (rise / step[2].abs().max(1e-6)).ceil().min(MAX_TILES * sides / STEP);
        self.first_hit(self.moved(start, step, START_OFFSET), step, count + 1.0)
    }

    /// The first of `count` steps that ends below the surface, and where in it the ray went under.
    #[inline(always)]
    fn first_hit(&self, start: Place, step: Place, count: f32) -> Option<Place> {
        let mut place = start;
        let mut clearance = place[2] - self.height_at(place[0], place[1]);
        if clearance <= 0.0 {
            return Some(place);
        }
        let mut done = 0.0;
        while done < count {
            let next = self.moved(place, step, 1.0);
            let next_clearance = next[2] - self.height_at(next[0], next[1]);
            if next_clearance <= 0.0 {
                return Some(self.refined(place, step, [clearance, next_clearance]));
            }
            (place, clearance) = (next, next_clearance);
            done += 1.0;
        }
        None
    }

    /// Where between a place above the surface and one step later the ray meets it, by false
    /// position.
    fn refined(&self, place: Place, step: Place, clearances: [f32; 2]) -> Place {
        let ([mut from, mut to], [mut above, mut below]) = ([0.0, 1.0], clearances);
        let mut share = 1.0;
        for _ in 0..REFINEMENTS {
            share = from + (to - from) * above / (above - below);
            let middle = self.moved(place, step, share);
            let clearance = middle[2] - self.height_at(middle[0], middle[1]);
            if clearance > 0.0 {
                (from, above) = (share, clearance);
            } else {
                (to, below) = (share, clearance);
            }
        }
        self.moved(place, step, share)
    }

    /// The steepest rise from a texel's centre to any point in a direction (unit, x and y): height
    /// over distance, at least 0. Rises below `flattest` may be reported as less than they are.
    pub(crate) fn horizon(&self, texel: usize, along: [f32; 2], flattest: f32) -> f32 {
        let mut place = self.centre(texel);
        let own = place[2];
        let step = [along[0], along[1], 0.0];
        let to_top = self.range[1] - own;
        let (mut steepest, mut distance) = (0.0_f32, 1.0);
        while to_top > distance * steepest.max(flattest) {
            place = self.moved(place, step, 1.0);
            steepest = steepest.max((self.height_at(place[0], place[1]) - own) / distance);
            distance += 1.0;
        }
        steepest
    }
}

/// How far a ray starts from the surface that it leaves, as a share of its first step: without it
/// rounding would put half of all starts below the surface.
const START_OFFSET: f32 = 0.1;

#[inline(always)]
fn wrap_once(value: f32, side: f32) -> f32 {
    let value = if value < 0.0 { value + side } else { value };
    // Not `else if`: a tiny negative number plus the side is the side.
    if value >= side { value - side } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ridge along y: height 4 texels over columns 8 to 11 of 32.
    fn ridge() -> HeightField {
        let heights =
            (0..32 * 4).map(|i| if (8..12).contains(&(i % 32)) { 4.0 / 32.0 } else { 0.0 });
        let maps = SurfaceMaps::new(32, 4, heights.collect(), vec![[1.0; 3]; 128], vec![1.0; 128]);
        HeightField::new(&maps.unwrap())
    }

    #[test]
    fn a_line_of_sight_stops_at_the_first_surface() {
        let field = ridge();
        let [low, high] = field.range;
        assert!((low + 0.5).abs() < 1e-6 && (high - 3.5).abs() < 1e-6, "{low} {high}");
        // From above: no shift.
        assert_eq!(field.seen_from([20.25, 1.0], [0.0, 0.0, 1.0])[..2], [20.25, 1.0]);
        // From the left at 45°, to the ground right of the ridge through its top.
        let half = 0.5_f32.sqrt();
        let seen = field.seen_from([13.0, 1.0], [-half, 0.0, half]);
        assert!((seen[0] - 9.5).abs() < 1e-3 && (seen[2] - 3.5).abs() < 1e-3, "{seen:?}");
        // On the ground, half a texel below the mean: further from the viewer.
        let seen = field.seen_from([20.0, 1.0], [-half, 0.0, half]);
        assert!((seen[0] - 20.5).abs() < 1e-3 && (seen[2] + 0.5).abs() < 1e-3, "{seen:?}");
    }

    #[test]
    #[expect(clippy::float_cmp, reason = "nothing rises there")]
    fn the_horizon_is_the_steepest_rise() {
        let field = ridge();
        // Five texels right of the ridge's last column.
        let rise = field.horizon(16, [-1.0, 0.0], 0.1);
        assert!((rise - 0.8).abs() < 1e-6, "{rise}");
        assert_eq!(field.horizon(8, [-1.0, 0.0], 0.1), 0.0);
    }

    #[test]
    fn rays_from_the_ground_meet_the_wall_or_the_sky() {
        let field = ridge();
        let hit = field.hit_from(field.centre(15), [-0.8, 0.0, 0.6]).unwrap();
        assert!((11.0..=12.0).contains(&hit[0]), "{hit:?}");
        assert!(field.hit_from(field.centre(20), [0.1, 0.0, 0.995]).is_none());
    }

    #[test]
    #[expect(clippy::float_cmp, reason = "whole numbers")]
    fn places_wrap_onto_the_tile() {
        let field = ridge();
        assert_eq!(field.wrapped([-1.0, 5.0, 2.0]), [31.0, 1.0, 2.0]);
        assert_eq!(wrap_once(-1e-9, 32.0), 0.0);
        let taps = field.taps([31.75, 3.5, 0.0]);
        assert_eq!(taps.texels, [127, 96, 31, 0]);
        assert_eq!(taps.nearest(), 96);
    }
}
