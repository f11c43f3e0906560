//! Evaluation of many pairs at once, in f32 and in tiles that the compiler can vectorize.
//!
//! Coordinates and exponentials are arithmetic over arrays of a tile; between them, each pair reads two nodes of
//! one table and four of the other, all terms of a channel at a time. No fused multiply–add, so that every
//! instruction set gives the same bits.

use std::f32::consts::{PI, TAU};

use brdf_model::elementary::{angle, exp, ln};
use brdf_model::{DirectionSlices, RgbBatch};

use crate::harmonics::Symmetry;
use crate::model::{Channel, SplineBrdf};
use crate::table::{FADE, Tables};

/// Pairs per tile.
const TILE: usize = 64;

type Lane = [f32; TILE];

/// Places of a tile's pairs: on the tables' axes, and θh over the angle below which φd fades.
struct Places {
    half: Lane,
    row: Lane,
    column: Lane,
    known: Lane,
}

pub(crate) fn evaluate(model: &SplineBrdf, pairs: DirectionSlices<'_>, out: &mut RgbBatch) {
    out.resize(pairs.len());
    // The widest vectors of the machine that runs this, chosen at run time.
    pulp::Arch::new().dispatch(Evaluate { model, pairs, out });
}

struct Evaluate<'a> {
    model: &'a SplineBrdf,
    pairs: DirectionSlices<'a>,
    out: &'a mut RgbBatch,
}

impl pulp::NullaryFnOnce for Evaluate<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { model, pairs, out } = self;
        let tables = model.tables();
        let mut start = 0;
        while start < pairs.len() {
            let len = TILE.min(pairs.len() - start);
            let (mut wi, mut wo) = ([[0.0; TILE]; 3], [[0.0; TILE]; 3]);
            for axis in 0..3 {
                wi[axis][..len].copy_from_slice(&pairs.wi()[axis][start..start + len]);
                wo[axis][..len].copy_from_slice(&pairs.wo()[axis][start..start + len]);
            }
            let places = places(tables, &wi, &wo);
            let mut sums = [[0.0; TILE]; 3];
            match tables.channels {
                1 => (0..len).for_each(|lane| read::<1>(tables, &places, lane, &mut sums)),
                _ => (0..len).for_each(|lane| read::<3>(tables, &places, lane, &mut sums)),
            }
            for (channel, transform) in model.transforms().iter().enumerate() {
                finish(&mut sums[channel], *transform, &wi[2], &wo[2]);
            }
            let source = |channel: usize| &sums[channel.min(tables.channels - 1)][..len];
            out.r[start..start + len].copy_from_slice(source(0));
            out.g[start..start + len].copy_from_slice(source(1));
            out.b[start..start + len].copy_from_slice(source(2));
            start += len;
        }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "this evaluator works in f32 throughout")]
fn narrow(value: f64) -> f32 {
    value as f32
}

/// Coordinates from h = wi + wo and wi − wo, which are perpendicular.
#[inline(always)]
fn places(tables: &Tables, wi: &[Lane; 3], wo: &[Lane; 3]) -> Places {
    let mut places =
        Places { half: [0.0; TILE], row: [0.0; TILE], column: [0.0; TILE], known: [0.0; TILE] };
    let alpha = 1.0 / narrow(tables.axis.alpha);
    let [rows, columns] = tables.size;
    let half_nodes = tables.half.len() / tables.terms;
    let per_half = (half_nodes - 1) as f32 / narrow(tables.axis.length());
    let per_row = (rows - 1) as f32;
    let per_column = (columns - 1) as f32 / narrow(tables.symmetry.period());
    for lane in 0..TILE {
        let h: [f32; 3] = std::array::from_fn(|axis| wi[axis][lane] + wo[axis][lane]);
        let d: [f32; 3] = std::array::from_fn(|axis| wi[axis][lane] - wo[axis][lane]);
        let across = (h[0] * h[0] + h[1] * h[1]).sqrt();
        let length = (across * across + h[2] * h[2]).max(1e-30).sqrt();
        let theta_h = angle(across, h[2]);
        let scaled = theta_h * alpha;
        places.half[lane] = ln(scaled + (scaled * scaled + 1.0).sqrt()) * per_half;
        places.known[lane] = (theta_h * narrow(1.0 / FADE)).min(1.0);
        // tan(θd/2) = sin θd / (1 + cos θd), both from lengths.
        let sine = 0.5 * (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
        let tangent = (sine / (1.0 + 0.5 * length)).min(1.0);
        places.row[lane] = tangent * tangent.sqrt() * per_row;
        let inverse = 1.0 / across.max(1e-30);
        let along = (h[0] * d[0] + h[1] * d[1]) * inverse * h[2] - d[2] * across;
        let beside = (h[0] * d[1] - h[1] * d[0]) * inverse * length;
        let phi = angle(beside.abs(), along);
        let folded = match tables.symmetry {
            Symmetry::Mirror => phi,
            Symmetry::Both => phi.min(PI - phi),
            Symmetry::Reciprocal if beside < 0.0 => PI - phi,
            Symmetry::None if beside < 0.0 => TAU - phi,
            Symmetry::Reciprocal | Symmetry::None => phi,
        };
        places.column[lane] = folded * per_column;
    }
    places
}

#[inline(always)]
fn read<const CHANNELS: usize>(
    tables: &Tables,
    places: &Places,
    lane: usize,
    sums: &mut [Lane; 3],
) {
    let terms = tables.terms;
    let [rows, columns] = tables.size;
    let cell = |place: f32, last: usize| {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a place on a table; what is not becomes its first node"
        )]
        let node = (place as usize).min(last - 1);
        (node, (place - node as f32).clamp(0.0, 1.0))
    };
    let (half, along) = cell(places.half[lane], tables.half.len() / terms - 1);
    let (row, down) = cell(places.row[lane], rows - 1);
    let (column, right) = cell(places.column[lane], columns - 1);
    let (below, above) = tables.half[half * terms..][..2 * terms].split_at(terms);
    let stride = CHANNELS * terms;
    let node = |row: usize, column: usize| {
        &tables.difference[(row * (columns + 1) + column) * stride..][..stride]
    };
    let corners =
        [node(row, column), node(row, column + 1), node(row + 1, column), node(row + 1, column + 1)];
    let weights =
        [(1.0 - down) * (1.0 - right), (1.0 - down) * right, down * (1.0 - right), down * right];
    let mut found = sum::<CHANNELS>([below, above], along, corners, weights);
    let known = places.known[lane];
    if known < 1.0 {
        let means = [node(row, columns), node(row, columns), node(row + 1, columns), node(row + 1, columns)];
        let mean = sum::<CHANNELS>([below, above], along, means, weights);
        for (found, mean) in found.iter_mut().zip(mean) {
            *found = known * *found + (1.0 - known) * mean;
        }
    }
    for (sums, found) in sums.iter_mut().zip(found) {
        sums[lane] = found;
    }
}

/// Σ over terms of g times the other side, for each channel.
#[inline(always)]
fn sum<const CHANNELS: usize>(
    half: [&[f32]; 2],
    along: f32,
    corners: [&[f32]; 4],
    weights: [f32; 4],
) -> [f32; CHANNELS] {
    let terms = half[0].len();
    let mut sums = [[0.0_f32; 4]; CHANNELS];
    let mut first = 0;
    while first < terms {
        let four = |values: &[f32], at: usize| -> [f32; 4] {
            values.get(at..at + 4).and_then(|v| v.try_into().ok()).unwrap_or_default()
        };
        let (below, above) = (four(half[0], first), four(half[1], first));
        let g: [f32; 4] = std::array::from_fn(|i| below[i] + along * (above[i] - below[i]));
        for (channel, sum) in sums.iter_mut().enumerate() {
            let at = channel * terms + first;
            let [a, b, c, d] = corners.map(|corner| four(corner, at));
            for i in 0..4 {
                let read = (weights[0] * a[i] + weights[1] * b[i]) + (weights[2] * c[i] + weights[3] * d[i]);
                sum[i] += g[i] * read;
            }
        }
        first += 4;
    }
    sums.map(|sum| (sum[0] + sum[1]) + (sum[2] + sum[3]))
}

/// Brings logarithms back to values, 0 where a direction is not above the surface.
#[inline(always)]
fn finish(values: &mut Lane, channel: Channel, zi: &Lane, zo: &Lane) {
    let [min, max] = channel.range;
    for ((value, &zi), &zo) in values.iter_mut().zip(zi).zip(zo) {
        let lit = f32::from(u8::from(zi > 0.0 && zo > 0.0));
        *value = (exp(*value) - channel.offset).clamp(min, max) * lit;
    }
}
