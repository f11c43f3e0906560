//! Which directions a place sees: rays that share an origin, traced together.
//!
//! Eight by eight rays of a cube face make a tile. From their common origin a triangle covers those rays that lie on
//! the inner side of three planes through the origin, so that a tile is a small picture into which triangles are
//! drawn; depth does not matter. Boxes are visited only where they reach into the tile's pyramid and
//! not all rays behind them are covered.

use std::time::Duration;

use brdf_mesh::Mesh;
use glam::{Vec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;

use crate::cube::{FACES, middle};

/// Number of rays along a side of a tile.
pub const TILE: usize = 8;
/// Children of a node.
const WIDTH: usize = 8;
/// No child.
const NONE: u32 = u32::MAX;
/// Child entries with this bit are leaves: the rest names their first triangle.
const LEAF: u32 = 1 << 31;

type Lanes = [f32; WIDTH];

/// The boxes of eight children.
#[derive(Clone, Debug)]
struct Node {
    /// Lower and upper bounds, `[axis][child]`.
    low: [Lanes; 3],
    high: [Lanes; 3],
    children: [u32; WIDTH],
    /// Triangles of leaves.
    counts: [u8; WIDTH],
}

/// A mesh that stands in the way of light, prepared for tiles of rays.
#[derive(Clone, Debug)]
pub struct Occluder {
    nodes: Vec<Node>,
    /// Corners of triangles, in the order of the leaves.
    triangles: Vec<[Vec3; 3]>,
    /// What all coordinates are relative to, and their unit: the mesh fills the unit ball.
    centre: glam::DVec3,
    scale: f64,
}

/// A tile of 8 × 8 rays from a common origin, as axes and bounds of a face.
#[derive(Clone, Copy, Debug)]
pub struct Tile {
    /// Face of the cube.
    pub face: usize,
    /// Rays along a side of the face.
    pub side: usize,
    /// First row and column.
    pub first: [usize; 2],
}

impl Occluder {
    /// Returns an occluder of the triangles of a mesh.
    pub fn of(mesh: &Mesh) -> Self {
        let (positions, centre, scale) = (mesh.positions(), mesh.centre(), mesh.radius().recip());
        let corner = |at: u32| ((positions[at as usize] - centre) * scale).as_vec3();
        let corners: Vec<[Vec3; 3]> = mesh.triangles().iter().map(|t| t.map(corner)).collect();
        let boxes: Vec<Aabb> = corners
            .iter()
            .map(|[a, b, c]| {
                Aabb::new(Vec3A::from(a.min(*b).min(*c)), Vec3A::from(a.max(*b).max(*c)))
            })
            .collect();
        // Each triangle alone: boxes tell which rays it can meet.
        let params = BvhBuildParams { max_prims_per_leaf: 1, ..BvhBuildParams::medium_build() };
        let binary = build_bvh2(&boxes, params, &mut Duration::default());
        let mut made = Self { nodes: Vec::new(), triangles: Vec::new(), centre, scale };
        if !binary.nodes.is_empty() {
            made.adopt(&binary, 0, &corners);
        }
        made
    }

    /// Makes a node of a subtree of binary ones: the largest inner node is opened until eight are left.
    fn adopt(&mut self, binary: &Bvh2, root: usize, corners: &[[Vec3; 3]]) -> u32 {
        let index = self.nodes.len();
        let nobody = Node {
            low: [[f32::INFINITY; WIDTH]; 3],
            high: [[f32::NEG_INFINITY; WIDTH]; 3],
            children: [NONE; WIDTH],
            counts: [0; WIDTH],
        };
        self.nodes.push(nobody);
        let mut open = vec![root];
        while open.len() < WIDTH {
            let inner = open.iter().enumerate().filter(|(_, at)| !binary.nodes[**at].is_leaf());
            let area = |at: &usize| binary.nodes[*at].aabb().half_area();
            let Some((place, at)) = inner.max_by(|a, b| area(a.1).total_cmp(&area(b.1))) else {
                break;
            };
            let first = binary.nodes[*at].first_index as usize;
            open[place] = first;
            open.push(first + 1);
        }
        for (child, at) in open.into_iter().enumerate() {
            let node = &binary.nodes[at];
            let bounds = node.aabb();
            for axis in 0..3 {
                self.nodes[index].low[axis][child] = bounds.min[axis];
                self.nodes[index].high[axis][child] = bounds.max[axis];
            }
            let (entry, count) = if node.is_leaf() {
                let first = u32::try_from(self.triangles.len()).unwrap_or(NONE);
                let own = node.first_index as usize..(node.first_index + node.prim_count) as usize;
                let own = binary.primitive_indices[own].iter();
                self.triangles.extend(own.map(|at| corners[*at as usize]));
                (LEAF | first, u8::try_from(node.prim_count).unwrap_or(u8::MAX))
            } else {
                (self.adopt(binary, at, corners), 0)
            };
            self.nodes[index].children[child] = entry;
            self.nodes[index].counts[child] = count;
        }
        u32::try_from(index).unwrap_or(NONE)
    }

    /// Returns a place in the occluder's own coordinates.
    pub fn origin(&self, position: glam::DVec3) -> Vec3 {
        ((position - self.centre) * self.scale).as_vec3()
    }

    /// Returns the rays of a tile that meet a triangle, together with those already `covered`; ray `(column, row)`
    /// is bit 8 column + row.
    pub fn cover(&self, origin: Vec3, tile: &Tile, covered: u64) -> u64 {
        pulp::Arch::new().dispatch(Cover { occluder: self, origin, tile, covered })
    }
}

struct Cover<'a> {
    occluder: &'a Occluder,
    origin: Vec3,
    tile: &'a Tile,
    covered: u64,
}

/// An axis of a face, which is an axis of space up to its sign.
#[derive(Clone, Copy)]
struct Axis {
    axis: usize,
    sign: f32,
}

impl Axis {
    const fn of(face: usize, which: usize) -> Self {
        let f = &FACES[face];
        let v = match which {
            0 => f.right,
            1 => f.down,
            _ => f.out,
        };
        let (axis, value) = if v.x != 0.0 {
            (0, v.x)
        } else if v.y != 0.0 {
            (1, v.y)
        } else {
            (2, v.z)
        };
        Self { axis, sign: if value > 0.0 { 1.0 } else { -1.0 } }
    }

    /// Bounds of eight boxes along the axis, relative to a place.
    #[inline(always)]
    fn bounds(self, node: &Node, origin: Vec3) -> [Lanes; 2] {
        let (low, high) = (&node.low[self.axis], &node.high[self.axis]);
        let at = origin[self.axis];
        let (near, far) = if self.sign > 0.0 { (low, high) } else { (high, low) };
        let mut bounds = [[0.0; WIDTH]; 2];
        for lane in 0..WIDTH {
            bounds[0][lane] = self.sign * (near[lane] - at);
            bounds[1][lane] = self.sign * (far[lane] - at);
        }
        bounds
    }

    #[inline(always)]
    fn read(self, v: Vec3) -> f32 {
        self.sign * v[self.axis]
    }
}

/// Right, down and out of each face.
const AXES: [[Axis; 3]; 6] = {
    let mut axes = [[Axis { axis: 0, sign: 1.0 }; 3]; 6];
    let mut face = 0;
    while face < 6 {
        axes[face] = [Axis::of(face, 0), Axis::of(face, 1), Axis::of(face, 2)];
        face += 1;
    }
    axes
};

impl pulp::NullaryFnOnce for Cover<'_> {
    type Output = u64;

    #[inline(always)]
    fn call(self) -> u64 {
        let Self { occluder, origin, tile, mut covered } = self;
        if occluder.nodes.is_empty() {
            return covered;
        }
        let axes = AXES[tile.face];
        let rays = Rays::of(tile);
        let mut stack = vec![(0_u32, 0.0)];
        while let Some((entry, _)) = stack.pop() {
            if covered == u64::MAX {
                break;
            }
            let node = &occluder.nodes[entry as usize];
            let x = axes[0].bounds(node, origin);
            let y = axes[1].bounds(node, origin);
            let z = axes[2].bounds(node, origin);
            let windows = rays.windows(&x, &y, &z);
            let first = stack.len();
            for child in 0..WIDTH {
                if windows[child] & !covered == 0 {
                    continue;
                }
                let entry = node.children[child];
                if entry & LEAF == 0 {
                    // The nearest last, so that it is next: it covers more than what lies behind it.
                    stack.push((entry, z[0][child]));
                    let mut at = stack.len() - 1;
                    while at > first && stack[at - 1].1 < stack[at].1 {
                        stack.swap(at - 1, at);
                        at -= 1;
                    }
                    continue;
                }
                let first = (entry & !LEAF) as usize;
                for corners in &occluder.triangles[first..first + node.counts[child] as usize] {
                    covered |= rays.drawn(axes, origin, corners);
                }
            }
        }
        covered
    }
}

/// Where the rays of a tile go through their face.
struct Rays {
    across: Lanes,
    along: Lanes,
    /// Places between one ray and the next, the other way round.
    per_place: f32,
}

/// As vector instructions have them; for numbers.
#[inline(always)]
fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[inline(always)]
fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The nearest whole number to one from 0 to 8, of two the even one.
#[inline(always)]
fn rounded(v: f32) -> u32 {
    // Beyond 2²³ floats are whole.
    (v + 8_388_608.0).to_bits() & 0xf
}

/// The first rows of a column, and the first columns of a tile, by their number.
const FIRST: [u64; 9] = [0, 0x1, 0x3, 0x7, 0xf, 0x1f, 0x3f, 0x7f, 0xff];
const FIRST_COLUMNS: [u64; 9] = {
    let mut masks = [u64::MAX; 9];
    let mut count = 0;
    while count < 8 {
        masks[count] = (1 << (8 * count)) - 1;
        count += 1;
    }
    masks
};

/// What rounding takes from a box that a ray grazes.
const MARGIN: f32 = 1e-6;
/// What it takes from the window of a box, in rays.
const SLACK: f32 = 1e-3;

impl Rays {
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "coordinates are f32 here")]
    fn of(tile: &Tile) -> Self {
        let places = |first| std::array::from_fn(|at| middle(first + at, tile.side) as f32);
        Self {
            across: places(tile.first[1]),
            along: places(tile.first[0]),
            per_place: 0.5 * tile.side as f32,
        }
    }

    /// Which rays may meet each of eight boxes, bounded along right, down and out.
    #[inline(always)]
    fn windows(&self, x: &[Lanes; 2], y: &[Lanes; 2], z: &[Lanes; 2]) -> [u64; WIDTH] {
        let [left, right] = self.range(x, z, self.across[0]);
        let [top, bottom] = self.range(y, z, self.along[0]);
        let mut windows = [0; WIDTH];
        for lane in 0..WIDTH {
            let is_reached = left[lane] < right[lane] && top[lane] < bottom[lane];
            if is_reached && z[1][lane] > 0.0 {
                let rows = FIRST[bottom[lane] as usize] & !FIRST[top[lane] as usize] & 0xff;
                let columns =
                    FIRST_COLUMNS[right[lane] as usize] & !FIRST_COLUMNS[left[lane] as usize];
                windows[lane] = (rows * 0x0101_0101_0101_0101) & columns;
            }
        }
        windows
    }

    /// Along one axis of the face, the first ray that may meet each of eight boxes, and the first beyond those.
    #[inline(always)]
    fn range(&self, side: &[Lanes; 2], z: &[Lanes; 2], first: f32) -> [[u32; WIDTH]; 2] {
        let mut range = [[0; WIDTH]; 2];
        for lane in 0..WIDTH {
            let (near, far) = (z[0][lane], z[1][lane]);
            let (low, high) = (side[0][lane], side[1][lane]);
            let [by_near, by_far] = [1.0 / near, 1.0 / far];
            let from = (min(low * by_near, low * by_far) - first) * self.per_place - SLACK;
            let to = (max(high * by_near, high * by_far) - first) * self.per_place + SLACK;
            // A box around the origin's plane may be anywhere.
            let is_before = near > MARGIN;
            let from = if is_before { from } else { 0.0 };
            let to = if is_before { to } else { 8.0 };
            // Nowhere, if all of it is outside the planes of the outermost rays; both limits are met where it is widest.
            let reach = max(-first * near, -first * far);
            let last = first + 7.0 / self.per_place;
            let over = max(last * near, last * far);
            let is_out = high + reach < -MARGIN || over - low < -MARGIN;
            let to = if is_out { -1.0 } else { to };
            range[0][lane] = rounded(min(max(from + 0.5, 0.0), 8.0));
            range[1][lane] = rounded(min(max(to + 0.5, 0.0), 8.0));
        }
        range
    }

    /// The rays from an origin that meet a triangle, by axes of their face.
    #[inline(always)]
    fn drawn(&self, axes: [Axis; 3], origin: Vec3, corners: &[Vec3; 3]) -> u64 {
        let mut local = [Vec3::ZERO; 3];
        for (local, corner) in local.iter_mut().zip(corners) {
            let v = *corner - origin;
            *local = Vec3::new(axes[0].read(v), axes[1].read(v), axes[2].read(v));
        }
        let [a, b, c] = local;
        let mut edges = [a.cross(b), b.cross(c), c.cross(a)];
        // From which side the origin sees it.
        let turn = edges[0].dot(c);
        if turn == 0.0 {
            return 0;
        }
        for edge in &mut edges {
            *edge *= turn.signum();
        }
        let mut columns = [0_u32; TILE];
        for row in 0..TILE {
            let y = self.along[row];
            let p = edges[0].y * y + edges[0].z;
            let q = edges[1].y * y + edges[1].z;
            let r = edges[2].y * y + edges[2].z;
            for (bits, x) in columns.iter_mut().zip(self.across) {
                let least = min(min(edges[0].x * x + p, edges[1].x * x + q), edges[2].x * x + r);
                *bits |= if least >= 0.0 { 1 << row } else { 0 };
            }
        }
        let mut mask = 0;
        for (column, bits) in columns.into_iter().enumerate() {
            mask |= u64::from(bits) << (TILE * column);
        }
        mask
    }
}
