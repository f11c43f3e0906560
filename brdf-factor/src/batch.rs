//! Evaluation of many pairs at once, in f32 and in tiles that the compiler can vectorize.
//!
//! Three loops a tile: texture coordinates (arithmetic over arrays), texels (four channels in one
//! load, the only step that cannot be laid out in arrays), and the inverse log map (arithmetic
//! again). No fused multiply–add, so that every instruction set gives the same bits.

use std::f32::consts::PI;

use brdf_model::elementary::{angle, exp, ln};
use brdf_model::{DirectionSlices, RgbBatch};
use brdf_param::Space;

use crate::coordinate::{Radial, Reading};
use crate::isotropic::NO_AZIMUTH;
use crate::{Angle, Axis, ChannelTransform, FactoredBrdf, Grid, Spacing};

/// Pairs per tile: all scratch arrays together stay within the first-level cache.
const TILE: usize = 64;

type Lane = [f32; TILE];

/// A coordinate with its scale folded in, ready to give texel positions.
struct Reader<'a> {
    source: Source,
    grid: Grid,
    texels: &'a [[f32; 4]],
}

enum Source {
    /// Positions are rows · coordinates + centre.
    Planar {
        space: Space,
        rows: [[f32; 4]; 2],
        centre: [f32; 2],
    },
    Radial {
        radial: Radial,
        scale: f32,
    },
    Isotropic {
        axes: [AxisReader; 2],
        swapped: bool,
    },
}

/// An axis of a texture over angles: position = shift + scale · s(angle / unit).
struct AxisReader {
    angle: Angle,
    spacing: Spacing,
    unit: f32,
    scale: f32,
    shift: f32,
}

/// The angles that textures are read at.
#[derive(Clone, Copy, PartialEq, Eq)]
enum AngleGroup {
    /// θh.
    Half,
    /// θd and φd.
    Difference,
    /// θi and θo.
    Polar,
    /// |φi − φo|.
    Azimuth,
}

/// Scratch of one tile.
struct Tile {
    wi: [Lane; 3],
    wo: [Lane; 3],
    half: [Lane; 3],
    standard: [Lane; 4],
    half_difference: [Lane; 4],
    angles: Angles,
    column: Lane,
    row: Lane,
    sums: [[f32; 4]; TILE],
}

/// Angles of a tile's pairs. φd is given by its size, cosine and sine.
struct Angles {
    theta_h: Lane,
    theta_d: Lane,
    phi_d: Lane,
    cos_d: Lane,
    sin_d: Lane,
    theta_i: Lane,
    theta_o: Lane,
    delta_phi: Lane,
}

impl Angle {
    fn group(self) -> AngleGroup {
        match self {
            Self::ThetaH => AngleGroup::Half,
            Self::ThetaI | Self::ThetaO => AngleGroup::Polar,
            Self::DeltaPhi => AngleGroup::Azimuth,
            _ => AngleGroup::Difference,
        }
    }
}

impl AxisReader {
    /// For an axis of `texels` texels and this largest angle.
    fn new(axis: Axis, largest: f64, texels: usize) -> Self {
        let last = (texels - 1) as f64;
        let (unit, scale, shift) = match axis.spacing {
            _ if axis.angle.is_signed() => (largest, 0.5 * last, 0.5 * last),
            Spacing::Linear | Spacing::Power { .. } => (largest, last, 0.0),
            Spacing::Asinh { alpha } => (alpha, last / (largest / alpha).asinh(), 0.0),
        };
        let [unit, scale, shift] = [unit, scale, shift].map(narrow);
        Self { angle: axis.angle, spacing: axis.spacing, unit, scale, shift }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "this evaluator works in f32 throughout")]
fn narrow(value: f64) -> f32 {
    value as f32
}

pub(crate) fn evaluate(model: &FactoredBrdf, pairs: DirectionSlices<'_>, out: &mut RgbBatch) {
    out.resize(pairs.len());
    let readers = readers(model);
    // The widest vectors of the machine that runs this, chosen at run time.
    pulp::Arch::new().dispatch(Evaluate { model, readers: &readers, pairs, out });
}

/// The call that [`pulp`] compiles once for each instruction set. A closure would do, if it could
/// be told to be inlined always; without that, its body is compiled for none of them.
struct Evaluate<'a> {
    model: &'a FactoredBrdf,
    readers: &'a [Reader<'a>],
    pairs: DirectionSlices<'a>,
    out: &'a mut RgbBatch,
}

impl pulp::NullaryFnOnce for Evaluate<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        run(self.model, self.readers, self.pairs, self.out);
    }
}

fn readers(model: &FactoredBrdf) -> Vec<Reader<'_>> {
    let factors = model.factors().iter();
    factors
        .flat_map(|factor| {
            factor.coordinates().iter().map(move |coordinate| {
                let grid = factor.grid();
                let last = [grid.columns, grid.rows].map(|side| (side - 1) as f64);
                let extent = factor.extent();
                let source = match coordinate.reading() {
                    Reading::Radial(radial) => {
                        Source::Radial { radial, scale: narrow(last[0] / extent.x) }
                    }
                    Reading::Planar(plane) => {
                        let rows = plane.projection.scaled_by(extent).rows();
                        let row = |at: usize| (rows[at] * (0.5 * last[at])).to_array().map(narrow);
                        Source::Planar {
                            space: plane.space,
                            rows: [row(0), row(1)],
                            centre: last.map(|last| narrow(0.5 * last)),
                        }
                    }
                    Reading::Isotropic { axes: [x, y], swapped } => Source::Isotropic {
                        axes: [
                            AxisReader::new(x, extent.x, grid.columns),
                            AxisReader::new(y, extent.y, grid.rows),
                        ],
                        swapped,
                    },
                };
                Reader { source, grid, texels: factor.texels() }
            })
        })
        .collect()
}

#[inline(always)]
fn run(
    model: &FactoredBrdf,
    readers: &[Reader<'_>],
    pairs: DirectionSlices<'_>,
    out: &mut RgbBatch,
) {
    let needs = |wanted: Space| {
        readers.iter().any(|r| matches!(r.source, Source::Planar { space, .. } if space == wanted))
    };
    let needs_half = readers.iter().any(|r| {
        matches!(
            r.source,
            Source::Planar { space: Space::HalfDifference, .. }
                | Source::Radial { radial: Radial::H, .. }
        )
    });
    let needs_angle = |wanted: AngleGroup| {
        readers.iter().any(|r| match &r.source {
            Source::Isotropic { axes, .. } => axes.iter().any(|a| a.angle.group() == wanted),
            _ => false,
        })
    };
    // Fixed half-vector coordinates leave the difference vector's columns at zero.
    let needs_difference = readers.iter().any(|r| {
        matches!(
            &r.source,
            Source::Planar { space: Space::HalfDifference, rows, .. }
                if rows.iter().any(|row| row[2] != 0.0 || row[3] != 0.0)
        )
    });
    let (sin_max, cos_max) = model.theta_max().sin_cos();
    let mut tile = Tile {
        wi: [[0.0; TILE]; 3],
        wo: [[0.0; TILE]; 3],
        half: [[0.0; TILE]; 3],
        standard: [[0.0; TILE]; 4],
        half_difference: [[0.0; TILE]; 4],
        angles: Angles {
            theta_h: [0.0; TILE],
            theta_d: [0.0; TILE],
            phi_d: [0.0; TILE],
            cos_d: [0.0; TILE],
            sin_d: [0.0; TILE],
            theta_i: [0.0; TILE],
            theta_o: [0.0; TILE],
            delta_phi: [0.0; TILE],
        },
        column: [0.0; TILE],
        row: [0.0; TILE],
        sums: [[0.0; 4]; TILE],
    };
    let mut start = 0;
    while start < pairs.len() {
        let len = TILE.min(pairs.len() - start);
        for axis in 0..3 {
            tile.wi[axis][..len].copy_from_slice(&pairs.wi()[axis][start..start + len]);
            tile.wo[axis][..len].copy_from_slice(&pairs.wo()[axis][start..start + len]);
        }
        // The tail of the last tile repeats harmless directions.
        for lane in len..TILE {
            for axis in 0..3 {
                tile.wi[axis][lane] = f32::from(u8::from(axis == 2));
                tile.wo[axis][lane] = f32::from(u8::from(axis == 2));
            }
        }
        pull_back(&mut tile.wi, narrow(sin_max), narrow(cos_max));
        pull_back(&mut tile.wo, narrow(sin_max), narrow(cos_max));
        if needs(Space::Standard) {
            standard_coordinates(&mut tile);
        }
        if needs_half {
            half_coordinates(&mut tile);
            if needs_difference {
                difference_coordinates(&mut tile);
            }
        }
        if needs_angle(AngleGroup::Half) || needs_angle(AngleGroup::Difference) {
            half_angles(&mut tile, needs_angle(AngleGroup::Difference));
        }
        if needs_angle(AngleGroup::Polar) {
            polar_angles(&tile.wi, &mut tile.angles.theta_i);
            polar_angles(&tile.wo, &mut tile.angles.theta_o);
        }
        if needs_angle(AngleGroup::Azimuth) {
            azimuth_angles(&mut tile);
        }
        tile.sums = [[0.0; 4]; TILE];
        for reader in readers {
            positions(&mut tile, &reader.source);
            accumulate(&mut tile, reader);
        }
        finish(&tile, model, pairs, start, len, out);
        start += len;
    }
}

#[inline(always)]
fn pull_back(w: &mut [Lane; 3], sin_max: f32, cos_max: f32) {
    let [xs, ys, zs] = w;
    for ((x, y), z) in xs.iter_mut().zip(ys).zip(zs) {
        let scale = sin_max / (*x * *x + *y * *y).max(1e-30).sqrt();
        let factor = if *z < cos_max { scale } else { 1.0 };
        *x *= factor;
        *y *= factor;
        *z = z.max(cos_max);
    }
}

#[inline(always)]
fn standard_coordinates(tile: &mut Tile) {
    for lane in 0..TILE {
        let (i, o) = (1.0 / (1.0 + tile.wi[2][lane]), 1.0 / (1.0 + tile.wo[2][lane]));
        tile.standard[0][lane] = tile.wi[0][lane] * i;
        tile.standard[1][lane] = tile.wi[1][lane] * i;
        tile.standard[2][lane] = tile.wo[0][lane] * o;
        tile.standard[3][lane] = tile.wo[1][lane] * o;
    }
}

#[inline(always)]
fn half_coordinates(tile: &mut Tile) {
    for lane in 0..TILE {
        let x = tile.wi[0][lane] + tile.wo[0][lane];
        let y = tile.wi[1][lane] + tile.wo[1][lane];
        let z = tile.wi[2][lane] + tile.wo[2][lane];
        let scale = 1.0 / (x * x + y * y + z * z).max(1e-30).sqrt();
        let (x, y, z) = (x * scale, y * scale, z * scale);
        let disc = 1.0 / (1.0 + z);
        tile.half[0][lane] = x;
        tile.half[1][lane] = y;
        tile.half[2][lane] = z;
        tile.half_difference[0][lane] = x * disc;
        tile.half_difference[1][lane] = y * disc;
    }
}

/// d = (r·wi, s·wi, h·wi) with s = (0, hz, −hy)/√(hy² + hz²) and r = s × h.
#[inline(always)]
fn difference_coordinates(tile: &mut Tile) {
    for lane in 0..TILE {
        let [hx, hy, hz] = [tile.half[0][lane], tile.half[1][lane], tile.half[2][lane]];
        let [x, y, z] = [tile.wi[0][lane], tile.wi[1][lane], tile.wi[2][lane]];
        let sine = (hy * hy + hz * hz).max(1e-30).sqrt();
        let inverse = 1.0 / sine;
        let in_plane = (hy * y + hz * z) * inverse;
        let along = hx * x + hy * y + hz * z;
        let r = sine * x - hx * in_plane;
        let s = (hz * y - hy * z) * inverse;
        let disc = 1.0 / (1.0 + along);
        tile.half_difference[2][lane] = r * disc;
        tile.half_difference[3][lane] = s * disc;
    }
}

/// θh, and if asked for θd and φd, from h = wi + wo and wi − wo, which are perpendicular.
#[inline(always)]
fn half_angles(tile: &mut Tile, with_difference: bool) {
    let Tile { wi, wo, angles, .. } = tile;
    let (mut across, mut up) = ([0.0; TILE], [0.0; TILE]);
    let (mut apart, mut length) = ([0.0; TILE], [0.0; TILE]);
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
        apart[lane] = (dx * dx + dy * dy + dz * dz).sqrt();
        let inverse = 1.0 / across[lane].max(1e-30);
        along[lane] = (hx * dx + hy * dy) * inverse * hz - dz * across[lane];
        beside[lane] = (hx * dy - hy * dx) * inverse * length[lane];
    }
    for lane in 0..TILE {
        angles.theta_h[lane] = angle(across[lane], up[lane]);
    }
    if with_difference {
        for lane in 0..TILE {
            angles.theta_d[lane] = angle(apart[lane], length[lane]);
            let limit = narrow(NO_AZIMUTH) * length[lane];
            let known = (across[lane] > limit) & (apart[lane] > limit);
            let (x, y) = if known { (along[lane], beside[lane]) } else { (1.0, 0.0) };
            let inverse = 1.0 / (x * x + y * y).max(1e-30).sqrt();
            angles.phi_d[lane] = angle(y.abs(), x);
            angles.cos_d[lane] = x * inverse;
            angles.sin_d[lane] = y * inverse;
        }
    }
}

#[inline(always)]
fn polar_angles(w: &[Lane; 3], out: &mut Lane) {
    for ((out, (x, y)), z) in out.iter_mut().zip(w[0].iter().zip(&w[1])).zip(&w[2]) {
        *out = angle((x * x + y * y).sqrt(), *z);
    }
}

#[inline(always)]
fn azimuth_angles(tile: &mut Tile) {
    let Tile { wi, wo, angles, .. } = tile;
    for lane in 0..TILE {
        let [ix, iy, ox, oy] = [wi[0][lane], wi[1][lane], wo[0][lane], wo[1][lane]];
        let shorter = (ix * ix + iy * iy).min(ox * ox + oy * oy).sqrt();
        let apart = angle((ix * oy - iy * ox).abs(), ix * ox + iy * oy);
        angles.delta_phi[lane] = if shorter > narrow(NO_AZIMUTH) { apart } else { 0.0 };
    }
}

/// Texel positions along one axis of a texture over angles.
#[inline(always)]
fn angle_positions(out: &mut Lane, angles: &Angles, axis: &AxisReader, swapped: bool) {
    let sign = if swapped { -1.0 } else { 1.0 };
    match axis.angle {
        Angle::ThetaH => *out = angles.theta_h,
        Angle::ThetaD => *out = angles.theta_d,
        Angle::PhiD => {
            for (out, phi) in out.iter_mut().zip(&angles.phi_d) {
                *out = if swapped { PI - phi } else { *phi };
            }
        }
        Angle::PhiDModPi => {
            for ((out, phi), sine) in out.iter_mut().zip(&angles.phi_d).zip(&angles.sin_d) {
                *out = if *sine < 0.0 { PI - phi } else { *phi };
            }
        }
        Angle::PhiDFolded => {
            for (out, phi) in out.iter_mut().zip(&angles.phi_d) {
                *out = phi.min(PI - phi);
            }
        }
        Angle::DifferenceX | Angle::DifferenceY => {
            let unit = if axis.angle == Angle::DifferenceX { &angles.cos_d } else { &angles.sin_d };
            for ((out, theta), unit) in out.iter_mut().zip(&angles.theta_d).zip(unit) {
                *out = sign * theta * unit;
            }
        }
        Angle::DifferenceXFolded | Angle::DifferenceYFolded => {
            let is_x = axis.angle == Angle::DifferenceXFolded;
            let unit = if is_x { &angles.cos_d } else { &angles.sin_d };
            for ((out, theta), unit) in out.iter_mut().zip(&angles.theta_d).zip(unit) {
                *out = (theta * unit).abs();
            }
        }
        Angle::ThetaI | Angle::ThetaO => {
            let is_light = (axis.angle == Angle::ThetaI) != swapped;
            *out = if is_light { angles.theta_i } else { angles.theta_o };
        }
        Angle::DeltaPhi => *out = angles.delta_phi,
    }
    let inverse = 1.0 / axis.unit;
    match axis.spacing {
        Spacing::Linear => {
            for out in out.iter_mut() {
                *out *= inverse;
            }
        }
        Spacing::Power { exponent } => {
            let exponent = narrow(exponent);
            for out in out.iter_mut() {
                *out = exp(exponent * ln((*out * inverse).max(1e-30)));
            }
        }
        Spacing::Asinh { .. } => {
            for out in out.iter_mut() {
                let x = *out * inverse;
                *out = ln(x + (x * x + 1.0).sqrt());
            }
        }
    }
    for out in out {
        *out = axis.shift + axis.scale * *out;
    }
}

/// Texel positions of all lanes.
#[inline(always)]
fn positions(tile: &mut Tile, source: &Source) {
    match source {
        Source::Planar { space, rows, centre } => {
            let point = match space {
                Space::Standard => &tile.standard,
                Space::HalfDifference => &tile.half_difference,
            };
            let [column, row] = [&mut tile.column, &mut tile.row];
            for (out, row, centre) in [(column, &rows[0], centre[0]), (row, &rows[1], centre[1])] {
                for lane in 0..TILE {
                    out[lane] = centre
                        + (row[0] * point[0][lane] + row[1] * point[1][lane])
                        + (row[2] * point[2][lane] + row[3] * point[3][lane]);
                }
            }
        }
        Source::Radial { radial, scale } => {
            let w = match radial {
                Radial::Wi => &tile.wi,
                Radial::Wo => &tile.wo,
                Radial::H => &tile.half,
            };
            for ((out, x), y) in tile.column.iter_mut().zip(&w[0]).zip(&w[1]) {
                *out = scale * (x * x + y * y).sqrt();
            }
        }
        Source::Isotropic { axes: [x, y], swapped } => {
            angle_positions(&mut tile.column, &tile.angles, x, *swapped);
            angle_positions(&mut tile.row, &tile.angles, y, *swapped);
        }
    }
}

/// Adds a reader's interpolated texels to the sums.
#[inline(always)]
fn accumulate(tile: &mut Tile, reader: &Reader<'_>) {
    let Grid { columns, rows } = reader.grid;
    let cell = |position: f32, last_cell: f32| {
        let inside = position.max(0.0).min(last_cell + 1.0);
        let low = inside.floor().min(last_cell);
        (low, inside - low)
    };
    let planar = rows > 1;
    let last_cells = [(columns - 2) as f32, if planar { (rows - 2) as f32 } else { 0.0 }];
    let mut corners = [0_u32; TILE];
    let (mut us, mut vs) = ([0.0; TILE], [0.0; TILE]);
    for lane in 0..TILE {
        let (column, u) = cell(tile.column[lane], last_cells[0]);
        let (row, v) = if planar { cell(tile.row[lane], last_cells[1]) } else { (0.0, 0.0) };
        corners[lane] = whole(row * columns as f32 + column);
        us[lane] = u;
        vs[lane] = v;
    }
    let stride = if planar { columns } else { 0 };
    for lane in 0..TILE {
        let corner = corners[lane] as usize;
        let (u, v) = (us[lane], vs[lane]);
        let [Some(below), Some(above)] =
            [corner, corner + stride].map(|at| reader.texels.get(at..at + 2))
        else {
            continue;
        };
        let weights = [(1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v];
        let sum = &mut tile.sums[lane];
        for channel in 0..4 {
            sum[channel] += (weights[0] * below[0][channel] + weights[1] * below[1][channel])
                + (weights[2] * above[0][channel] + weights[3] * above[1][channel]);
        }
    }
}

/// Inverse log map, clamps at 0 and at the ceiling, and 0 where a direction is not above the surface.
#[inline(always)]
fn finish(
    tile: &Tile,
    model: &FactoredBrdf,
    pairs: DirectionSlices<'_>,
    start: usize,
    len: usize,
    out: &mut RgbBatch,
) {
    let mut lit = [0.0_f32; TILE];
    let (zi, zo) = (&pairs.wi()[2][start..start + len], &pairs.wo()[2][start..start + len]);
    for ((lit, &i), &o) in lit.iter_mut().zip(zi).zip(zo) {
        *lit = f32::from(u8::from(i > 0.0 && o > 0.0));
    }
    let mut values = [[0.0_f32; TILE]; 3];
    let maps = model.maps();
    for (channel, (map, ceiling)) in maps.iter().zip(model.ceilings()).enumerate() {
        let ceiling = narrow(*ceiling);
        // f = scale · e^x + shift in every case.
        let (scale, shift) = match *map {
            ChannelTransform::Offset { a } => (1.0, -narrow(a)),
            ChannelTransform::Log => (1.0, 0.0),
            ChannelTransform::Highlight { a } => (-1.0, narrow(a)),
            ChannelTransform::Zero => (0.0, 0.0),
        };
        for lane in 0..TILE {
            let value = scale * exp(tile.sums[lane][channel]) + shift;
            values[channel][lane] = value.min(ceiling).max(0.0) * lit[lane];
        }
    }
    let source = |channel: usize| &values[if maps.len() == 1 { 0 } else { channel }][..len];
    out.r[start..start + len].copy_from_slice(source(0));
    out.g[start..start + len].copy_from_slice(source(1));
    out.b[start..start + len].copy_from_slice(source(2));
}

const TWO_23: f32 = 8_388_608.0;

/// The integer that a whole number from 0 to 2²³ − 1 is, by its bits: unlike `as`, which saturates,
/// this is one vector instruction.
#[inline(always)]
fn whole(value: f32) -> u32 {
    (value + TWO_23).to_bits() & 0x007f_ffff
}
