//! Trilinear lookups in the MERL grid for many pairs at once, in f32.
//!
//! Three loops a tile: places in the grid (arithmetic over arrays, which the compiler vectorizes),
//! a touch of every cell that will be needed (the table is far larger than the caches, and with
//! nothing in between the misses overlap), and the interpolation.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use crate::merl::{MerlNodes, MerlTable};
use crate::{DirectionSlices, RgbBatch};

/// Pairs per tile.
const TILE: usize = 64;

/// Sides of the grid in f32.
const THETA: f32 = MerlTable::THETA_H as f32;
const PHI: f32 = MerlTable::PHI_D as f32;

pub(crate) fn evaluate(
    cells: &[[f32; 3]],
    nodes: MerlNodes,
    pairs: DirectionSlices<'_>,
    out: &mut RgbBatch,
) {
    out.resize(pairs.len());
    let mut tile = Tile::default();
    let mut start = 0;
    while start < pairs.len() {
        let len = TILE.min(pairs.len() - start);
        // The widest vectors of the machine that runs this, chosen at run time.
        pulp::Arch::new().dispatch(Locate { tile: &mut tile, nodes, pairs, start, len });
        let touched = tile.touch(cells, len);
        for lane in 0..len {
            let [r, g, b] = if touched { tile.blend(cells, lane) } else { [0.0; 3] };
            out.r[start + lane] = r;
            out.g[start + lane] = g;
            out.b[start + lane] = b;
        }
        start += len;
    }
}

/// Where the pairs of a tile lie in the grid.
struct Tile {
    /// First cells of the rows along phi_d at the two theta_h and theta_d nodes around each pair.
    rows: [[u32; TILE]; 4],
    /// Nodes of phi_d.
    phi_d: [[u32; TILE]; 2],
    /// Ways from the first to the second node along theta_h, theta_d and phi_d.
    fractions: [[f32; TILE]; 3],
    /// 1 where both directions are above the surface, else 0.
    lit: [f32; TILE],
}

impl Default for Tile {
    fn default() -> Self {
        Self {
            rows: [[0; TILE]; 4],
            phi_d: [[0; TILE]; 2],
            fractions: [[0.0; TILE]; 3],
            lit: [0.0; TILE],
        }
    }
}

impl Tile {
    /// Reads one cell of each row, so that the next loop finds them in the cache. Always true; what
    /// was read must be used, or the compiler leaves it out.
    fn touch(&self, cells: &[[f32; 3]], len: usize) -> bool {
        let mut largest = 0.0_f32;
        for lane in 0..len {
            for rows in &self.rows {
                let cell = (rows[lane] + self.phi_d[0][lane]) as usize;
                largest = largest.max(cells.get(cell).map_or(0.0, |c| c[0]));
            }
        }
        largest >= 0.0
    }

    fn blend(&self, cells: &[[f32; 3]], lane: usize) -> [f32; 3] {
        let [h, d, p] = [0, 1, 2].map(|axis| self.fractions[axis][lane]);
        let across = [(1.0 - h) * (1.0 - d), (1.0 - h) * d, h * (1.0 - d), h * d];
        let along = [1.0 - p, p];
        let mut sum = [0.0_f32; 3];
        let mut valid = 0.0_f32;
        for (rows, weight) in self.rows.iter().zip(across) {
            for (nodes, share) in self.phi_d.iter().zip(along) {
                let Some(cell) = cells.get((rows[lane] + nodes[lane]) as usize) else { continue };
                // Invalid cells weigh nothing; no branch, for the memory to keep pace.
                let known = f32::from(u8::from(cell[0] >= 0.0)) * weight * share;
                valid += known;
                for (total, value) in sum.iter_mut().zip(cell) {
                    *total += known * value;
                }
            }
        }
        let scale = self.lit[lane] / valid.max(f32::MIN_POSITIVE);
        sum.map(|total| total * scale)
    }
}

struct Locate<'a> {
    tile: &'a mut Tile,
    nodes: MerlNodes,
    pairs: DirectionSlices<'a>,
    start: usize,
    len: usize,
}

impl pulp::NullaryFnOnce for Locate<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { tile, nodes, pairs, start, len } = self;
        let shift = nodes.shift();
        let load = |component: &[f32]| {
            let mut lanes = [0.0_f32; TILE];
            lanes[..len].copy_from_slice(&component[start..start + len]);
            lanes
        };
        let [ix, iy, iz] = [load(pairs.wi()[0]), load(pairs.wi()[1]), load(pairs.wi()[2])];
        let [ox, oy, oz] = [load(pairs.wo()[0]), load(pairs.wo()[1]), load(pairs.wo()[2])];
        for lane in 0..TILE {
            let (hx, hy, hz) = (ix[lane] + ox[lane], iy[lane] + oy[lane], iz[lane] + oz[lane]);
            let (kx, ky, kz) = (ix[lane] - ox[lane], iy[lane] - oy[lane], iz[lane] - oz[lane]);
            let planar = (hx * hx + hy * hy).sqrt();
            let length = (hx * hx + hy * hy + hz * hz).sqrt();
            let back = (kx * kx + ky * ky + kz * kz).sqrt();
            let theta_h = (arctangent(planar, hz.max(0.0)) / FRAC_PI_2).sqrt() * THETA;
            let theta_d = arctangent(back, length) / FRAC_PI_2 * THETA;
            // The azimuth of wi about the half vector, folded to [0, π); see the single form.
            let leaning = planar > 1e-6;
            let across = if leaning { hx * ky - hy * kx } else { ky };
            let along = if leaning { -kz * length } else { kx };
            let quarter = arctangent(across.abs(), along.abs());
            let opposite = (across < 0.0) != (along < 0.0);
            let phi_d = (if opposite { PI - quarter } else { quarter }) / PI * PHI - shift;

            let (h0, h1, h) = clamped(theta_h - shift);
            let (d0, d1, d) = clamped(theta_d - shift);
            let wrapped = if phi_d < 0.0 { phi_d + PHI } else { phi_d };
            let p0 = wrapped.floor().min(PHI - 1.0);
            let p1 = if p0 + 1.0 < PHI { p0 + 1.0 } else { 0.0 };
            let row = |h: f32, d: f32| whole((h * THETA + d) * PHI);
            tile.rows[0][lane] = row(h0, d0);
            tile.rows[1][lane] = row(h0, d1);
            tile.rows[2][lane] = row(h1, d0);
            tile.rows[3][lane] = row(h1, d1);
            tile.phi_d[0][lane] = whole(p0);
            tile.phi_d[1][lane] = whole(p1);
            tile.fractions[0][lane] = h;
            tile.fractions[1][lane] = d;
            tile.fractions[2][lane] = (wrapped - p0).min(1.0);
            tile.lit[lane] = if iz[lane].min(oz[lane]) > 0.0 { 1.0 } else { 0.0 };
        }
    }
}

/// The nodes around a place along a theta axis, and the way between them.
#[inline(always)]
fn clamped(place: f32) -> (f32, f32, f32) {
    let inside = place.clamp(0.0, THETA - 1.0);
    let low = inside.floor();
    (low, (low + 1.0).min(THETA - 1.0), inside - low)
}

/// The integer that a whole number from 0 to 2²³ − 1 is, by its bits: unlike `as`, which saturates,
/// this is one vector instruction.
#[inline(always)]
fn whole(value: f32) -> u32 {
    (value + 8_388_608.0).to_bits() & 0x007f_ffff
}

/// atan(y / x) for y, x ≥ 0, to 4e-7; 0 where both are 0.
///
/// The ratio is brought to [0, 1], then to |z| ≤ tan(π/8), where four terms of a minimax polynomial
/// suffice (Moshier's Cephes).
#[inline(always)]
fn arctangent(y: f32, x: f32) -> f32 {
    const TAN_PI_8: f32 = 0.414_213_57;
    let (small, large) = (y.min(x), y.max(x).max(f32::MIN_POSITIVE));
    let ratio = small / large;
    let steep = ratio > TAN_PI_8;
    let z = if steep { (ratio - 1.0) / (ratio + 1.0) } else { ratio };
    let w = z * z;
    let polynomial = ((0.080_537_44 * w - 0.138_776_86) * w + 0.199_777_1) * w - 0.333_329_5;
    let angle = z + z * w * polynomial + if steep { FRAC_PI_4 } else { 0.0 };
    if y > x { FRAC_PI_2 - angle } else { angle }
}

#[cfg(test)]
mod tests {
    use super::arctangent;

    #[test]
    fn the_arctangent_is_good_to_rounding() {
        for step in 0..=9000_u16 {
            let angle = f32::from(step) * 0.01_f32.to_radians();
            let (sin, cos) = angle.sin_cos();
            let error = (arctangent(sin, cos.max(0.0)) - angle).abs();
            assert!(error < 4e-7, "{error} at {angle}");
        }
    }
}
