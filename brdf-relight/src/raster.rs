//! Pictures of relit surfaces by drawing their triangles.

use brdf_model::Rgb;
use brdf_render::{Camera, Film, Pixel};
use glam::{DVec2, Vec3};
use rayon::prelude::*;

use crate::frame::tangent_frame;
use crate::scene::{Part, RelitScene};

/// How a picture is taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shot {
    /// From where.
    pub camera: Camera,
    /// Pixels along each side.
    pub size: usize,
    /// Points along each side of a pixel.
    pub points: usize,
}

/// A vertex in the picture: column, row, and one over the distance along the view.
type Projected = Option<[f32; 3]>;

/// Rows of a band, which a thread draws.
const BAND: usize = 16;
/// Nothing is drawn there.
const EMPTY: u32 = u32::MAX;

/// What a point of the picture shows: which triangle of which part, and shares of its second and third corner.
#[derive(Clone, Copy)]
struct Point {
    part: u32,
    triangle: u32,
    nearness: f32,
    shares: [f32; 2],
}

/// Draws parts as light made them, and counts points where the sum of products was below 0 and set to 0. View maps
/// are read for each point, between the values of the corners.
pub fn picture(parts: &[Part<'_>], relit: &RelitScene, shot: &Shot) -> (Film, usize) {
    let side = shot.size * shot.points;
    let projected: Vec<Vec<Projected>> = parts
        .iter()
        .map(|part| {
            let of = |position: &glam::DVec3| project(&shot.camera, *position, side);
            part.surface.positions.par_iter().map(of).collect()
        })
        .collect();
    let band = BAND * shot.points;
    let bands = bins(parts, &projected, side, band);
    let rows: Vec<(Vec<Pixel>, usize)> = bands
        .par_iter()
        .enumerate()
        .map(|(number, triangles)| {
            let first = number * band;
            let points = drawn(parts, &projected, triangles, first, side, band);
            shaded(parts, relit, shot, &points, first)
        })
        .collect();
    let negative = rows.iter().map(|(_, negative)| negative).sum();
    let mut pixels: Vec<Pixel> = rows.into_iter().flat_map(|(pixels, _)| pixels).collect();
    pixels.truncate(shot.size * shot.size);
    (Film::new(shot.size, pixels), negative)
}

#[expect(clippy::cast_possible_truncation, reason = "places in a picture")]
fn project(camera: &Camera, position: glam::DVec3, side: usize) -> Projected {
    let (place, distance) = camera.project(position, side, side)?;
    Some([place.x as f32, place.y as f32, (1.0 / distance) as f32])
}

/// For each band of so many rows of points the triangles that reach into it, as part and number.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "rows of a picture"
)]
fn bins(
    parts: &[Part<'_>],
    projected: &[Vec<Projected>],
    side: usize,
    band: usize,
) -> Vec<Vec<(u32, u32)>> {
    let mut bands = vec![Vec::new(); side.div_ceil(band)];
    for (number, (part, places)) in (0..).zip(parts.iter().zip(projected)) {
        for (triangle, corners) in (0..).zip(&part.surface.triangles) {
            let Some([a, b, c]) = visible(places, corners) else { continue };
            let top = a[1].min(b[1]).min(c[1]).max(0.0);
            let bottom = a[1].max(b[1]).max(c[1]).min(side as f32 - 1.0);
            let left = a[0].min(b[0]).min(c[0]);
            let right = a[0].max(b[0]).max(c[0]);
            if top > bottom || left > side as f32 || right < 0.0 {
                continue;
            }
            for band in &mut bands[top as usize / band..=bottom as usize / band] {
                band.push((number, triangle));
            }
        }
    }
    bands
}

/// A triangle before the camera, seen from either side.
fn visible(places: &[Projected], corners: &[u32; 3]) -> Option<[[f32; 3]; 3]> {
    let [a, b, c] = corners.map(|at| places[at as usize]);
    Some([a?, b?, c?])
}

/// What the points of a band show, `[row][column]`.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "places in a picture"
)]
fn drawn(
    parts: &[Part<'_>],
    projected: &[Vec<Projected>],
    triangles: &[(u32, u32)],
    first: usize,
    side: usize,
    rows: usize,
) -> Vec<Point> {
    let nothing = Point { part: EMPTY, triangle: 0, nearness: 0.0, shares: [0.0; 2] };
    let mut points = vec![nothing; rows * side];
    for &(part, triangle) in triangles {
        let corners = &parts[part as usize].surface.triangles[triangle as usize];
        let Some([a, b, c]) = visible(&projected[part as usize], corners) else { continue };
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
        if area == 0.0 {
            continue;
        }
        // Points lie in the middle of their cells.
        let from = |v: f32, low: usize| ((v - 0.5).ceil().max(low as f32)) as usize;
        let to = |v: f32, high: usize| ((v - 0.5).floor() + 1.0).clamp(0.0, high as f32) as usize;
        let low = |axis: usize| a[axis].min(b[axis]).min(c[axis]);
        let high = |axis: usize| a[axis].max(b[axis]).max(c[axis]);
        let columns = from(low(0), 0)..to(high(0), side);
        for row in from(low(1), first)..to(high(1), (first + rows).min(side)) {
            let y = row as f32 + 0.5;
            for column in columns.clone() {
                let x = column as f32 + 0.5;
                let second = ((x - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (y - a[1])) / area;
                let third = ((b[0] - a[0]) * (y - a[1]) - (x - a[0]) * (b[1] - a[1])) / area;
                let rest = 1.0 - second - third;
                if second < 0.0 || third < 0.0 || rest < 0.0 {
                    continue;
                }
                // One over the distance is linear in the picture, and so are values divided by it.
                let nearness = rest * a[2] + second * b[2] + third * c[2];
                let point = &mut points[(row - first) * side + column];
                if nearness > point.nearness {
                    let shares = [second * b[2] / nearness, third * c[2] / nearness];
                    *point = Point { part, triangle, nearness, shares };
                }
            }
        }
    }
    points
}

/// Pixels of a band, means of their points, and how many points were negative.
#[expect(clippy::cast_precision_loss, reason = "few points")]
fn shaded(
    parts: &[Part<'_>],
    relit: &RelitScene,
    shot: &Shot,
    points: &[Point],
    first: usize,
) -> (Vec<Pixel>, usize) {
    let (per, side) = (shot.points, shot.size * shot.points);
    let widest = parts.iter().map(|part| 3 * part.maps.terms).max().unwrap_or(0);
    let (mut values, mut negative) = (vec![0.0; widest], 0);
    let rows = points.len() / side / per;
    let mut pixels = Vec::with_capacity(rows * shot.size);
    for row in 0..rows {
        for column in 0..shot.size {
            let (mut sum, mut hits) = ([0.0_f32; 3], 0_usize);
            for at in 0..per * per {
                let (down, across) = (row * per + at / per, column * per + at % per);
                let point = &points[down * side + across];
                if point.part == EMPTY {
                    continue;
                }
                let place = DVec2::new(across as f64 + 0.5, (first + down) as f64 + 0.5);
                let to_camera = -shot.camera.ray(place, side, side).as_vec3();
                let part = &parts[point.part as usize];
                let colour =
                    colour(part, &relit.parts[point.part as usize], point, to_camera, &mut values);
                negative += usize::from(colour.iter().any(|v| *v < 0.0));
                sum.iter_mut().zip(colour).for_each(|(sum, v)| *sum += v.max(0.0));
                hits += 1;
            }
            pixels.push(if hits == 0 {
                Pixel::Background
            } else {
                let mean = sum.map(|v| f64::from(v) / hits as f64);
                Pixel::Radiance(Rgb::from(mean), hits as f64 / (per * per) as f64)
            });
        }
    }
    (pixels, negative)
}

/// Σ_k h_k(wo) times what arrives for k, at a point.
#[inline(always)]
fn colour(
    part: &Part<'_>,
    arriving: &[[f32; 3]],
    point: &Point,
    to_camera: Vec3,
    values: &mut [f32],
) -> [f32; 3] {
    let terms = part.maps.terms;
    let corners = part.surface.triangles[point.triangle as usize].map(|at| at as usize);
    let [second, third] = point.shares;
    let shares = [1.0 - second - third, second, third];
    let normal: glam::DVec3 = corners
        .iter()
        .zip(shares)
        .map(|(corner, share)| f64::from(share) * part.surface.normals[*corner])
        .sum();
    let frame = tangent_frame(normal.normalize_or(glam::DVec3::Y)).as_mat3();
    let mut local = frame.transpose() * to_camera;
    // Smooth normals may look away where the triangle does not: its rim answers.
    if local.z < 0.0 {
        local = Vec3::new(local.x, local.y, 0.0).normalize_or(Vec3::X);
    }
    let values = &mut values[..3 * terms];
    part.maps.view.read(local, 1.0, values);
    let mut sum = [0.0; 3];
    for (corner, share) in corners.into_iter().zip(shares) {
        let own = &arriving[corner * terms..][..terms];
        for (value, h) in own.iter().zip(values.as_chunks::<3>().0) {
            for channel in 0..3 {
                sum[channel] += share * value[channel] * h[channel];
            }
        }
    }
    sum
}
