//! Which share of each texel of the sky a vertex sees.

use glam::{DVec3, Vec3};

use crate::cube::{FACES, SIDE, TEXELS, middle};
use crate::ray_packet::{Occluder, TILE, Tile};

/// The number of rays with which visibility is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Quality {
    /// One ray through the middle of each texel.
    One,
    /// Four by four rays in texels whose neighbours are not as they are, one elsewhere.
    #[default]
    Adaptive,
    /// Four by four rays in each texel.
    Sixteen,
}

/// Rays along a side of a texel that is looked at finely.
const FINE: usize = 4;

/// Visible shares of the texels of the cube from one place, in sixteenths.
#[derive(Clone, Debug)]
pub struct Visibility {
    shares: Vec<u8>,
    fine: Vec<bool>,
}

impl Default for Visibility {
    fn default() -> Self {
        Self { shares: vec![0; TEXELS], fine: vec![false; TEXELS] }
    }
}

impl Visibility {
    /// Returns, for each texel, the sixteenths that are above the horizon and not covered.
    pub fn shares(&self) -> &[u8] {
        &self.shares
    }

    /// Computes the shares that are visible from a place with this unit normal, past `occluder`.
    pub fn look(&mut self, occluder: &Occluder, position: DVec3, normal: DVec3, quality: Quality) {
        let (origin, up) = (occluder.origin(position), normal.as_vec3());
        if quality == Quality::Sixteen {
            self.shares.fill(0);
            return self.look_finely(occluder, origin, up, None);
        }
        self.look_once(occluder, origin, up);
        if quality == Quality::Adaptive {
            let mut fine = std::mem::take(&mut self.fine);
            mark_borders(&self.shares, &mut fine);
            for (share, fine) in self.shares.iter_mut().zip(&fine) {
                *share = if *fine { 0 } else { *share };
            }
            self.look_finely(occluder, origin, up, Some(&fine));
            self.fine = fine;
        }
    }

    fn look_once(&mut self, occluder: &Occluder, origin: Vec3, up: Vec3) {
        for face in 0..6 {
            for row in (0..SIDE).step_by(TILE) {
                for column in (0..SIDE).step_by(TILE) {
                    let tile = Tile { face, side: SIDE, first: [row, column] };
                    let seen = seen(occluder, origin, up, &tile);
                    for bit in 0..TILE * TILE {
                        let texel = (face * SIDE + row + bit % TILE) * SIDE + column + bit / TILE;
                        self.shares[texel] = if seen >> bit & 1 == 1 { 16 } else { 0 };
                    }
                }
            }
        }
    }

    /// Sixteen rays in chosen texels, or in all; their shares are 0 before.
    fn look_finely(
        &mut self,
        occluder: &Occluder,
        origin: Vec3,
        up: Vec3,
        chosen: Option<&[bool]>,
    ) {
        let step = TILE / FINE;
        for face in 0..6 {
            for row in (0..SIDE).step_by(step) {
                for column in (0..SIDE).step_by(step) {
                    let texel = |bit: usize| {
                        let (down, across) = (bit % TILE / FINE, bit / TILE / FINE);
                        (face * SIDE + row + down) * SIDE + column + across
                    };
                    let corners = [0, TILE - 1, TILE * (TILE - 1), TILE * TILE - 1];
                    let is_chosen = |bit| chosen.is_none_or(|chosen| chosen[texel(bit)]);
                    if !corners.into_iter().any(is_chosen) {
                        continue;
                    }
                    let first = [FINE * row, FINE * column];
                    let tile = Tile { face, side: FINE * SIDE, first };
                    let seen = seen(occluder, origin, up, &tile);
                    for bit in (0..TILE * TILE).filter(|bit| seen >> bit & 1 == 1) {
                        if is_chosen(bit) {
                            self.shares[texel(bit)] += 1;
                        }
                    }
                }
            }
        }
    }
}

/// Marks texels that differ from one beside them on their face.
fn mark_borders(shares: &[u8], differs: &mut [bool]) {
    differs.fill(false);
    for texel in 0..TEXELS {
        let (row, column) = (texel / SIDE % SIDE, texel % SIDE);
        for (is_inside, step) in [(column + 1 < SIDE, 1), (row + 1 < SIDE, SIDE)] {
            if is_inside && shares[texel] != shares[texel + step] {
                differs[texel] = true;
                differs[texel + step] = true;
            }
        }
    }
}

/// The rays of a tile that are above the horizon and meet nothing.
fn seen(occluder: &Occluder, origin: Vec3, up: Vec3, tile: &Tile) -> u64 {
    let below = below_horizon(up, tile);
    if below == u64::MAX { 0 } else { !occluder.cover(origin, tile, below) }
}

fn below_horizon(up: Vec3, tile: &Tile) -> u64 {
    let face = &FACES[tile.face];
    #[expect(clippy::cast_possible_truncation, reason = "coordinates are f32 here")]
    let height = |row: usize, column: usize| {
        let across = middle(tile.first[1] + column, tile.side) as f32;
        let along = middle(tile.first[0] + row, tile.side) as f32;
        let [right, down, out] = [face.right, face.down, face.out].map(|v| v.as_vec3().dot(up));
        out + across * right + along * down
    };
    let last = TILE - 1;
    let corners = [height(0, 0), height(0, last), height(last, 0), height(last, last)];
    // Heights are linear over a face.
    if corners.iter().all(|height| *height > 0.0) {
        return 0;
    }
    if corners.iter().all(|height| *height <= 0.0) {
        return u64::MAX;
    }
    let bits = (0..TILE * TILE).filter(|bit| height(bit % TILE, bit / TILE) <= 0.0);
    bits.fold(0, |mask, bit| mask | 1 << bit)
}
