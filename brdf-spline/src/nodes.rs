//! Where a material is known, and how much each place counts.

use std::f64::consts::{FRAC_PI_2, PI};

use brdf_model::{Brdf, GgxLobes, Rgb, SampleSet};
use brdf_param::{DirectionPair, HalfDifference};
use rayon::prelude::*;

use crate::base::value_of;
use crate::harmonics::Symmetry;

/// θh at which nodes change from even spacing to a geometric one, radians.
const HALF_BEND: f64 = 0.008;
/// Smallest cosine of a node's directions; models are held beyond.
pub(crate) const COSINE_MIN: f64 = 0.05;
/// Beyond this angle nodes are there to keep the model sane, not to be judged, radians.
const JUDGED: f64 = 80.0 * PI / 180.0;
/// What they count beside the others.
const BEYOND: f64 = 0.02;

/// Nodes of a base beside samples.
const BESIDE: NodeGrid = NodeGrid { theta_h: 28, theta_d: 9, phi_d: 8 };

/// Numbers of nodes along each angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct NodeGrid {
    pub(crate) theta_h: usize,
    pub(crate) theta_d: usize,
    /// For each half turn.
    pub(crate) phi_d: usize,
}

/// Angles of a node's difference vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Difference {
    pub(crate) theta: f64,
    pub(crate) phi: f64,
}

/// One value of the material.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Node {
    /// Value of each channel, sr⁻¹.
    pub(crate) value: [f64; 3],
    /// Cosine of the angle of incidence.
    pub(crate) cosine: f64,
    /// Share of uniform pairs, and of pairs half of which are around the mirror direction, that the node
    /// stands for; each adds up to 1 over all nodes. Both are 0 where nothing is known.
    pub(crate) shares: [f64; 2],
}

impl Node {
    pub(crate) fn is_known(&self) -> bool {
        self.shares[0] > 0.0
    }
}

/// Lobes under a sum of products.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Base {
    pub(crate) lobes: GgxLobes,
    /// Value of each channel at each node, sr⁻¹.
    pub(crate) values: Vec<[f64; 3]>,
}

/// The nodes that a model is fitted to.
#[derive(Clone, Debug)]
pub(crate) struct Nodes {
    /// θh of each distinct half vector.
    pub(crate) halves: Vec<f64>,
    pub(crate) differences: Vec<Difference>,
    /// Whether every half vector meets every difference vector, or each just its own.
    pub(crate) is_grid: bool,
    /// On a grid, those of a difference vector together.
    pub(crate) nodes: Vec<Node>,
    /// How many of them, from the first on, are of the material; the others are of the base.
    own: usize,
    /// What products change, and its values at the nodes.
    pub(crate) base: Option<Base>,
    /// Channels that are fitted: 1 or 3.
    pub(crate) channels: usize,
    /// Places without a finite value, which are left out.
    pub(crate) not_finite: usize,
}

impl NodeGrid {
    fn halves(self) -> impl Iterator<Item = (f64, f64)> {
        let last = (FRAC_PI_2 / HALF_BEND).asinh();
        midpoints(self.theta_h).map(move |t| {
            let s = t * last;
            (HALF_BEND * s.sinh(), HALF_BEND * s.cosh())
        })
    }

    fn differences(self, symmetry: Symmetry) -> impl Iterator<Item = (Difference, f64)> {
        let period = symmetry.period();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a small positive number"
        )]
        let azimuths = (self.phi_d as f64 * period / PI).ceil().max(4.0) as usize;
        midpoints(self.theta_d).flat_map(move |v| {
            let (theta, step) = (2.0 * v.atan(), 2.0 / (1.0 + v * v));
            midpoints(azimuths).map(move |t| (Difference { theta, phi: t * period }, step))
        })
    }
}

/// The middles of equal parts of [0, 1].
fn midpoints(count: usize) -> impl Iterator<Item = f64> {
    (0..count).map(move |index| (index as f64 + 0.5) / count as f64)
}

impl Nodes {
    /// Evaluates a material at the nodes of a grid; `channels` is 1 for luminance, else 3.
    pub(crate) fn of_grid(
        brdf: &dyn Brdf,
        grid: NodeGrid,
        symmetry: Symmetry,
        channels: usize,
    ) -> Self {
        let halves = grid.halves().map(|(theta, _)| theta).collect();
        let differences = grid.differences(symmetry).map(|(difference, _)| difference).collect();
        let nodes = on_grid(brdf, grid, symmetry, channels);
        Self::new(halves, differences, true, nodes, channels)
    }

    /// Takes measured rows as they are, every row counting the same, and lobes beside them everywhere, which all in all
    /// count as much as a share of the rows. The lobes become the base.
    pub(crate) fn of_samples(
        samples: &SampleSet,
        symmetry: Symmetry,
        base: Option<(&GgxLobes, f64)>,
    ) -> Self {
        let channels = samples.channels().count();
        let (mut halves, mut differences, mut nodes) = (Vec::new(), Vec::new(), Vec::new());
        let mut values = Vec::new();
        for (index, pair) in samples.pairs().enumerate() {
            let angles = HalfDifference::from_pair(&pair);
            halves.push(angles.theta_h);
            differences.push(Difference { theta: angles.theta_d, phi: angles.phi_d });
            let value = of_channels(samples.rgb(index), channels);
            nodes.push(Node { value, cosine: pair.wi.z, shares: [1.0; 2] });
            values.extend(value_of(base.map(|(lobes, _)| lobes), &pair));
        }
        if let Some((lobes, share)) = base {
            let beside = on_grid(lobes, BESIDE, symmetry, channels);
            let totals = totals(&beside);
            let places = BESIDE.differences(symmetry).flat_map(|(difference, _)| {
                BESIDE.halves().map(move |(theta_h, _)| (theta_h, difference))
            });
            for ((half, difference), mut node) in places.zip(beside).filter(|(_, n)| n.is_known()) {
                for (own, total) in node.shares.iter_mut().zip(totals) {
                    *own *= share * samples.len() as f64 / total;
                }
                halves.push(half);
                differences.push(difference);
                values.push(node.value);
                nodes.push(node);
            }
        }
        let base = base.map(|(lobes, _)| Base { lobes: lobes.clone(), values });
        let own = samples.len();
        Self { own, base, ..Self::new(halves, differences, false, nodes, channels) }
    }

    fn new(
        halves: Vec<f64>,
        differences: Vec<Difference>,
        is_grid: bool,
        mut nodes: Vec<Node>,
        channels: usize,
    ) -> Self {
        let mut not_finite = 0;
        for node in &mut nodes {
            if node.value.iter().any(|v| !v.is_finite()) {
                not_finite += 1;
                *node = Node::default();
            }
        }
        let totals = totals(&nodes);
        for node in nodes.iter_mut().filter(|node| node.is_known()) {
            let [uniform, mirror] = [0, 1].map(|set| node.shares[set] / totals[set]);
            node.shares = [uniform, 0.5 * (uniform + mirror)];
        }
        let own = nodes.len();
        Self { halves, differences, is_grid, nodes, own, base: None, channels, not_finite }
    }

    /// ln(a + g) of the base at a node, 0 without one.
    pub(crate) fn base_logarithms(&self, node: usize, offsets: [f64; 3]) -> [f64; 3] {
        match &self.base {
            Some(base) => std::array::from_fn(|c| {
                if c < self.channels { (offsets[c] + base.values[node][c]).ln() } else { 0.0 }
            }),
            None => [0.0; 3],
        }
    }

    /// The nodes with data, of the material and of a base beside it.
    pub(crate) fn known(&self) -> impl Iterator<Item = &Node> {
        self.nodes.iter().filter(|node| node.is_known())
    }

    /// The nodes at which the material is known.
    pub(crate) fn measured(&self) -> impl Iterator<Item = &Node> {
        self.nodes[..self.own].iter().filter(|node| node.is_known())
    }

    /// The mean value of each channel over uniform pairs.
    pub(crate) fn mean(&self) -> [f64; 3] {
        self.nodes.iter().fold([0.0; 3], |sum, node| {
            std::array::from_fn(|c| sum[c] + node.shares[0] * node.value[c])
        })
    }
}

/// Evaluates a material at the nodes of a grid, those of a difference vector together.
fn on_grid(brdf: &dyn Brdf, grid: NodeGrid, symmetry: Symmetry, channels: usize) -> Vec<Node> {
    let halves: Vec<(f64, f64)> = grid.halves().collect();
    let differences: Vec<(Difference, f64)> = grid.differences(symmetry).collect();
    let columns: Vec<Vec<Node>> = differences
        .par_iter()
        .map(|&(difference, step_d)| {
            let mut column = vec![Node::default(); halves.len()];
            let pairs: Vec<(usize, DirectionPair)> = halves
                .iter()
                .enumerate()
                .map(|(half, &(theta_h, _))| (half, pair(theta_h, difference)))
                .filter(|(_, pair)| pair.wi.z.min(pair.wo.z) >= COSINE_MIN && brdf.has_data(pair))
                .collect();
            let only: Vec<DirectionPair> = pairs.iter().map(|(_, pair)| *pair).collect();
            let mut values = Vec::new();
            brdf.eval_pairs(&only, &mut values);
            for (&(half, pair), value) in pairs.iter().zip(values) {
                let (theta_h, step_h) = halves[half];
                let shares = densities(theta_h, difference.theta, &pair);
                let shares = shares.map(|density| density * step_h * step_d);
                let value = of_channels(value, channels);
                column[half] = Node { value, cosine: pair.wi.z, shares };
            }
            column
        })
        .collect();
    columns.concat()
}

/// What shares add up to.
fn totals(nodes: &[Node]) -> [f64; 2] {
    nodes.iter().fold([0.0; 2], |sum, node| [sum[0] + node.shares[0], sum[1] + node.shares[1]])
}

/// The pair of a node, with φh = 0.
fn pair(theta_h: f64, difference: Difference) -> DirectionPair {
    HalfDifference { theta_h, phi_h: 0.0, theta_d: difference.theta, phi_d: difference.phi }
        .to_pair()
}

fn of_channels(value: Rgb, channels: usize) -> [f64; 3] {
    match channels {
        1 => [value.luminance().max(0.0), 0.0, 0.0],
        _ => value.channels().map(|v| v.max(0.0)),
    }
}

/// Densities over (θh, θd, φd) of pairs that are uniform on two parabolic discs, and of pairs around the
/// mirror direction (θh = 90° u², wi uniform on its disc), up to factors.
fn densities(theta_h: f64, theta_d: f64, pair: &DirectionPair) -> [f64; 2] {
    let disc = |z: f64| 1.0 / ((1.0 + z) * (1.0 + z));
    let (sin_d, cos_d) = theta_d.sin_cos();
    let (zi, zo) = (pair.wi.z, pair.wo.z);
    let beyond = if zi.min(zo) < JUDGED.cos() { BEYOND } else { 1.0 };
    let uniform = 4.0 * cos_d * theta_h.sin() * sin_d * disc(zi) * disc(zo);
    let mirror = sin_d * disc(zi) / theta_h.sqrt();
    [uniform * beyond, mirror * beyond]
}
