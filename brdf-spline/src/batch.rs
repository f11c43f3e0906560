//! Evaluation of many pairs at once, in f32 and in tiles that the compiler can vectorize.
//!
//! Coordinates and exponentials are arithmetic over arrays of a tile; between them, each pair reads two nodes of
//! one table and four of the other, all terms of a channel at a time. No fused multiply–add, so that every
//! instruction set gives the same bits.

use std::f32::consts::{PI, TAU};

use brdf_model::elementary::{angle, exp, ln};
use brdf_model::{DirectionSlices, GgxLobes, Rgb, RgbBatch};

use crate::channel::Channel;
use crate::harmonics::Symmetry;
use crate::nodes::COSINE_MIN;
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

pub(crate) fn evaluate(
    tables: &Tables,
    channels: &[Channel],
    base: Option<&GgxLobes>,
    pairs: DirectionSlices<'_>,
    out: &mut RgbBatch,
) {
    out.resize(pairs.len());
    // The widest vectors of the machine that runs this, chosen at run time.
    // Without a base nothing of one is compiled in: the loops are a third faster.
    match base {
        None => {
            pulp::Arch::new().dispatch(Evaluate::<false> { tables, channels, base, pairs, out })
        }
        Some(_) => {
            pulp::Arch::new().dispatch(Evaluate::<true> { tables, channels, base, pairs, out });
        }
    }
}

struct Evaluate<'a, const ON_BASE: bool> {
    tables: &'a Tables,
    channels: &'a [Channel],
    base: Option<&'a GgxLobes>,
    pairs: DirectionSlices<'a>,
    out: &'a mut RgbBatch,
}

impl<const ON_BASE: bool> pulp::NullaryFnOnce for Evaluate<'_, ON_BASE> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { tables, channels, base, pairs, out } = self;
        let mut start = 0;
        while start < pairs.len() {
            let len = TILE.min(pairs.len() - start);
            let (mut wi, mut wo) = ([[0.0; TILE]; 3], [[0.0; TILE]; 3]);
            for axis in 0..3 {
                wi[axis][..len].copy_from_slice(&pairs.wi()[axis][start..start + len]);
                wo[axis][..len].copy_from_slice(&pairs.wo()[axis][start..start + len]);
            }
            let lit = lit(&wi[2], &wo[2]);
            hold(&mut wi);
            hold(&mut wo);
            let places = places(tables, &wi, &wo);
            let mut sums = [[0.0; TILE]; 3];
            // No closures here: what is not inlined is not compiled for the wide vectors.
            if tables.channels == 1 {
                for lane in 0..len {
                    read::<1>(tables, &places, lane, &mut sums);
                }
            } else {
                for lane in 0..len {
                    read::<3>(tables, &places, lane, &mut sums);
                }
            }
            if let (true, Some(base)) = (ON_BASE, base) {
                for values in sums.iter_mut().take(channels.len()) {
                    for value in values {
                        *value = exp(*value);
                    }
                }
                multiply_base(base, channels, &wi, &wo, &mut sums);
                for (channel, transform) in channels.iter().enumerate() {
                    finish(&mut sums[channel], *transform, &lit);
                }
            } else {
                for (channel, transform) in channels.iter().enumerate() {
                    finish_logarithms(&mut sums[channel], *transform, &lit);
                }
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
    // Loops of one kind of arithmetic each: what the compiler makes vectors of.
    let (mut across, mut up, mut length) = ([0.0; TILE], [0.0; TILE], [0.0; TILE]);
    let (mut along, mut beside) = ([0.0; TILE], [0.0; TILE]);
    for lane in 0..TILE {
        let (hx, hy) = (wi[0][lane] + wo[0][lane], wi[1][lane] + wo[1][lane]);
        let hz = wi[2][lane] + wo[2][lane];
        let (dx, dy) = (wi[0][lane] - wo[0][lane], wi[1][lane] - wo[1][lane]);
        let dz = wi[2][lane] - wo[2][lane];
        let flat = hx * hx + hy * hy;
        across[lane] = flat.sqrt();
        up[lane] = hz;
        length[lane] = (flat + hz * hz).sqrt();
        // tan(θd/2) = sin θd / (1 + cos θd), both from lengths.
        let sine = 0.5 * (dx * dx + dy * dy + dz * dz).sqrt();
        let tangent = (sine / (1.0 + 0.5 * length[lane])).min(1.0);
        places.row[lane] = tangent * tangent.sqrt() * per_row;
        let inverse = 1.0 / across[lane].max(1e-30);
        along[lane] = (hx * dx + hy * dy) * inverse * hz - dz * across[lane];
        beside[lane] = (hx * dy - hy * dx) * inverse * length[lane];
    }
    for lane in 0..TILE {
        let theta_h = angle(across[lane], up[lane]);
        places.known[lane] = (theta_h * narrow(1.0 / FADE)).min(1.0);
        places.half[lane] = theta_h * alpha;
    }
    for half in &mut places.half {
        *half = ln(*half + (*half * *half + 1.0).sqrt()) * per_half;
    }
    // What a turn to the other side of h does to φd, and what half a turn does.
    let (other_side, is_folded) = match tables.symmetry {
        Symmetry::Mirror => (None, false),
        Symmetry::Both => (None, true),
        Symmetry::Reciprocal => (Some(PI), false),
        Symmetry::None => (Some(TAU), false),
    };
    for lane in 0..TILE {
        let phi = angle(beside[lane].abs(), along[lane]);
        let phi = if is_folded { phi.min(PI - phi) } else { phi };
        places.column[lane] = phi * per_column;
    }
    if let Some(turn) = other_side {
        for (column, beside) in places.column.iter_mut().zip(&beside) {
            let other = turn * per_column - *column;
            *column = if *beside < 0.0 { other } else { *column };
        }
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
    let line = (columns + 1) * stride;
    let corner = row * line + column * stride;
    let upper = &tables.difference[corner..corner + 2 * stride];
    let lower = &tables.difference[corner + line..corner + line + 2 * stride];
    let corners = [&upper[..stride], &upper[stride..], &lower[..stride], &lower[stride..]];
    let weights =
        [(1.0 - down) * (1.0 - right), (1.0 - down) * right, down * (1.0 - right), down * right];
    let mut found = sum::<CHANNELS>([below, above], along, corners, weights);
    let known = places.known[lane];
    if known < 1.0 {
        let at = row * line + columns * stride;
        let (upper, lower) = (
            &tables.difference[at..at + stride],
            &tables.difference[at + line..at + line + stride],
        );
        let means = [upper, upper, lower, lower];
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
    let [below, above] = [half[0].as_chunks::<4>().0, half[1].as_chunks::<4>().0];
    let [a, b, c, d] = corners;
    let (a, b) = (a.as_chunks::<4>().0, b.as_chunks::<4>().0);
    let (c, d) = (c.as_chunks::<4>().0, d.as_chunks::<4>().0);
    let fours = below.len();
    let mut found = [0.0; CHANNELS];
    for (channel, found) in found.iter_mut().enumerate() {
        let own = channel * fours..(channel + 1) * fours;
        let (a, b) = (&a[own.clone()], &b[own.clone()]);
        let (c, d) = (&c[own.clone()], &d[own]);
        let mut sum = [0.0_f32; 4];
        for i in 0..fours {
            for lane in 0..4 {
                let g = below[i][lane] + along * (above[i][lane] - below[i][lane]);
                let read = (weights[0] * a[i][lane] + weights[1] * b[i][lane])
                    + (weights[2] * c[i][lane] + weights[3] * d[i][lane]);
                sum[lane] += g * read;
            }
        }
        *found = (sum[0] + sum[1]) + (sum[2] + sum[3]);
    }
    found
}

/// Multiplies values by a + g of a base g.
#[inline(always)]
fn multiply_base(
    base: &GgxLobes,
    channels: &[Channel],
    wi: &[Lane; 3],
    wo: &[Lane; 3],
    values: &mut [Lane; 3],
) {
    let (mut across, mut up, mut fifth) = ([0.0; TILE], [0.0; TILE], [0.0; TILE]);
    for lane in 0..TILE {
        let (hx, hy) = (wi[0][lane] + wo[0][lane], wi[1][lane] + wo[1][lane]);
        let hz = wi[2][lane] + wo[2][lane];
        let (flat, high) = (hx * hx + hy * hy, hz * hz);
        let length = flat + high;
        across[lane] = flat / length;
        up[lane] = high / length;
        let falloff = 1.0 - (0.5 * length.sqrt()).min(1.0);
        let square = falloff * falloff;
        fifth[lane] = square * square * falloff;
    }
    let rgb = |colour: Rgb| colour.channels().map(narrow);
    let [diffuse, sheen] = [rgb(base.diffuse / std::f64::consts::PI), rgb(base.sheen)];
    let mut sums = [[0.0; TILE]; 3];
    for (channel, sums) in sums.iter_mut().enumerate().take(channels.len()) {
        let offset = channels[channel].offset + diffuse[channel];
        for (sum, fifth) in sums.iter_mut().zip(&fifth) {
            *sum = offset + sheen[channel] * fifth;
        }
    }
    for lobe in &base.lobes {
        let square = narrow(lobe.alpha * lobe.alpha);
        let (f0, f90) = (rgb(lobe.f0), narrow(lobe.f90));
        let mut facets = [0.0; TILE];
        for lane in 0..TILE {
            let (zi, zo) = (wi[2][lane], wo[2][lane]);
            let spread = across[lane] / square + up[lane];
            let distribution = 1.0 / (PI * square * spread * spread);
            let [behind, before] = [zi, zo].map(|z| (square + (1.0 - square) * z * z).sqrt());
            facets[lane] = distribution * 0.5 / (zo * behind + zi * before);
        }
        for (channel, sums) in sums.iter_mut().enumerate().take(channels.len()) {
            for lane in 0..TILE {
                let fresnel = f0[channel] * (1.0 - fifth[lane]) + f90 * fifth[lane];
                sums[lane] += fresnel * facets[lane];
            }
        }
    }
    for (values, sums) in values.iter_mut().zip(&sums).take(channels.len()) {
        for (value, sum) in values.iter_mut().zip(sums) {
            *value *= sum;
        }
    }
}

/// Brings logarithms of a + f back to values, 0 where a direction is not above the surface.
#[inline(always)]
fn finish_logarithms(values: &mut Lane, channel: Channel, lit: &Lane) {
    let [min, max] = channel.range;
    for (value, lit) in values.iter_mut().zip(lit) {
        *value = (exp(*value) - channel.offset).clamp(min, max) * lit;
    }
}

/// Brings a + f back to values, 0 where a direction is not above the surface.
#[inline(always)]
fn finish(values: &mut Lane, channel: Channel, lit: &Lane) {
    let [min, max] = channel.range;
    for (value, lit) in values.iter_mut().zip(lit) {
        *value = (*value - channel.offset).clamp(min, max) * lit;
    }
}

/// 1 where both directions are above the surface, else 0.
#[inline(always)]
fn lit(zi: &Lane, zo: &Lane) -> Lane {
    let mut lit = [0.0; TILE];
    for ((lit, &zi), &zo) in lit.iter_mut().zip(zi).zip(zo) {
        *lit = f32::from(u8::from(zi > 0.0 && zo > 0.0));
    }
    lit
}

/// Brings grazing directions back to the limit, as `eval` does.
#[inline(always)]
fn hold([xs, ys, zs]: &mut [Lane; 3]) {
    let limit = narrow(COSINE_MIN);
    let reach = (1.0 - limit * limit).sqrt();
    for ((x, y), z) in xs.iter_mut().zip(ys).zip(zs) {
        let scale = reach / (*x * *x + *y * *y).max(1e-30).sqrt();
        let factor = if *z < limit { scale } else { 1.0 };
        *x *= factor;
        *y *= factor;
        *z = z.max(limit);
    }
}
