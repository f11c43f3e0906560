//! Which directions a place sees: rays that share an origin, traced together.
//!
//! Eight by eight rays of a cube face make a tile. From their common origin a triangle covers those rays that lie on
//! the inner side of three planes through the origin, so that a tile is a small picture into which triangles are
//! drawn; depth does not matter. Boxes are visited only where they reach into the tile's pyramid and
//! not all rays behind them are covered.

use std::time::Duration;

use glam::{Vec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;

use crate::cube::{FACES, middle};

/// Rays along a side of a tile.
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

/// A mesh that stands in the way.
#[derive(Clone, Debug)]
pub struct Occluder {
    nodes: Vec<Node>,
    /// Corners of triangles, in the order of the leaves.
    triangles: Vec<[Vec3; 3]>,
    /// What all coordinates are relative to, and their unit: the mesh fills the unit ball.
    centre: glam::DVec3,
    scale: f64,
}

/// A tile of rays from a common origin, as axes and bounds of a face.
#[derive(Clone, Copy, Debug)]
pub struct Tile {
    /// Which face of the cube.
    pub face: usize,
    /// Rays along a side of the face.
    pub side: usize,
    /// First row and column.
    pub first: [usize; 2],
}

impl Occluder {
    /// Boxes around the triangles of a mesh within a ball.
    pub fn new(
        positions: &[glam::DVec3],
        triangles: &[[u32; 3]],
        centre: glam::DVec3,
        radius: f64,
    ) -> Self {
        let scale = radius.recip();
        let corner = |at: u32| ((positions[at as usize] - centre) * scale).as_vec3();
        let corners: Vec<[Vec3; 3]> = triangles.iter().map(|t| t.map(corner)).collect();
        let boxes: Vec<Aabb> = corners
            .iter()
            .map(|[a, b, c]| {
                Aabb::new(Vec3A::from(a.min(*b).min(*c)), Vec3A::from(a.max(*b).max(*c)))
            })
            .collect();
        let binary = build_bvh2(&boxes, BvhBuildParams::medium_build(), &mut Duration::default());
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

    /// A place in the occluder's own coordinates.
    pub fn origin(&self, position: glam::DVec3) -> Vec3 {
        ((position - self.centre) * self.scale).as_vec3()
    }

    /// The rays of a tile that meet a triangle, besides those already `covered`; bit 8 row + column.
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
        [near, far].map(|side| {
            let mut bound = [0.0; WIDTH];
            for lane in 0..WIDTH {
                bound[lane] = self.sign * (side[lane] - at);
            }
            bound
        })
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
        let [right, down, out] = AXES[tile.face];
        let across = places(tile.first[1], tile.side);
        let along = places(tile.first[0], tile.side);
        let limits = [across[0], across[TILE - 1], along[0], along[TILE - 1]];
        if occluder.nodes.is_empty() {
            return covered;
        }
        let mut stack = [0_u32; 256];
        let mut depth = 1;
        while depth > 0 && covered != u64::MAX {
            depth -= 1;
            let node = &occluder.nodes[stack[depth] as usize];
            let x = right.bounds(node, origin);
            let y = down.bounds(node, origin);
            let z = out.bounds(node, origin);
            let reached = reached(&x, &y, &z, &limits);
            for (child, reached) in reached.into_iter().enumerate() {
                if reached <= 0.0 {
                    continue;
                }
                let entry = node.children[child];
                if entry & LEAF == 0 {
                    stack[depth] = entry;
                    depth += 1;
                    continue;
                }
                let first = (entry & !LEAF) as usize;
                for corners in &occluder.triangles[first..first + node.counts[child] as usize] {
                    let corners = corners.map(|corner| {
                        let v = corner - origin;
                        Vec3::new(right.read(v), down.read(v), out.read(v))
                    });
                    covered |= drawn(corners, &across, &along);
                }
            }
        }
        covered
    }
}

/// Where rays of a tile go through their face.
#[inline(always)]
fn places(first: usize, side: usize) -> Lanes {
    #[expect(clippy::cast_possible_truncation, reason = "coordinates are f32 here")]
    std::array::from_fn(|at| middle(first + at, side) as f32)
}

/// Above 0 for boxes that may reach into a pyramid: for each of its planes, how far inside the box's innermost corner is.
#[inline(always)]
fn reached(x: &[Lanes; 2], y: &[Lanes; 2], z: &[Lanes; 2], limits: &[f32; 4]) -> Lanes {
    // What rounding takes from a box that a ray grazes.
    const MARGIN: f32 = 1e-6;
    let [left, right, top, bottom] = *limits;
    let mut inside = [0.0; WIDTH];
    for lane in 0..WIDTH {
        let (low, high) = (z[0][lane], z[1][lane]);
        let planes = [
            x[1][lane] - least(left, low, high),
            most(right, low, high) - x[0][lane],
            y[1][lane] - least(top, low, high),
            most(bottom, low, high) - y[0][lane],
        ];
        let nearest = planes[0].min(planes[1]).min(planes[2].min(planes[3])) + MARGIN;
        inside[lane] = if high > 0.0 { nearest } else { 0.0 };
    }
    inside
}

/// The least and the largest of a limit times a distance between two bounds.
#[inline(always)]
fn least(limit: f32, low: f32, high: f32) -> f32 {
    if limit >= 0.0 { limit * low } else { limit * high }
}

#[inline(always)]
fn most(limit: f32, low: f32, high: f32) -> f32 {
    if limit >= 0.0 { limit * high } else { limit * low }
}

/// The rays that meet a triangle, in coordinates of the face.
#[inline(always)]
fn drawn(corners: [Vec3; 3], across: &Lanes, along: &Lanes) -> u64 {
    let [a, b, c] = corners;
    if a.z <= 0.0 && b.z <= 0.0 && c.z <= 0.0 {
        return 0;
    }
    let edges = [a.cross(b), b.cross(c), c.cross(a)];
    // The side on which the origin's triangle is seen.
    let turn = edges[0].dot(c);
    if turn == 0.0 {
        return 0;
    }
    let sign = turn.signum();
    let edges = edges.map(|edge| sign * edge);
    let mut bits = 0;
    for row in 0..TILE {
        let mut inside = [0.0_f32; TILE];
        let y = along[row];
        let [p, q, r] = edges.map(|edge| edge.y * y + edge.z);
        for column in 0..TILE {
            let x = across[column];
            let least = (edges[0].x * x + p).min(edges[1].x * x + q).min(edges[2].x * x + r);
            inside[column] = least;
        }
        let mut line = 0_u64;
        for (column, inside) in inside.iter().enumerate() {
            line |= u64::from(*inside >= 0.0) << column;
        }
        bits |= line << (TILE * row);
    }
    bits
}
