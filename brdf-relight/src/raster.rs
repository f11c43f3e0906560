//! Pictures of relit surfaces by drawing their triangles.

use brdf_image::{Film, Pixel};
use brdf_mesh::Camera;
use brdf_model::Rgb;
use glam::Vec3;
use rayon::prelude::*;

use crate::frame::tangent_frame;
use crate::scene::{Part, RelitScene};

/// Options of a picture: camera, size and points a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderParams {
    /// Camera that the picture is taken with.
    pub camera: Camera,
    /// Pixels along each side.
    pub size: usize,
    /// Points along each side of a pixel.
    pub points: usize,
}

/// A vertex in the picture.
#[derive(Clone, Copy)]
struct Projected {
    column: f32,
    row: f32,
    /// One over the distance along the view; 0 behind the camera.
    nearness: f32,
    /// Whether its normal does not look away.
    is_facing: bool,
}

/// Cosine between normal and view down to which a vertex faces the camera: smooth normals lean.
const LEAST_FACING: f32 = -0.25;

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

/// Renders parts as light made them, and returns the picture with the number of points where the sum of products was
/// below 0 and set to 0.
///
/// View maps are read for each point, between the values of the corners. Triangles whose normals look away are not
/// drawn.
pub fn render(parts: &[Part<'_>], relit: &RelitScene, shot: &RenderParams) -> (Film, usize) {
    let side = shot.size * shot.points;
    let projected: Vec<Vec<Projected>> = parts
        .iter()
        .map(|part| {
            let vertices = part.surface.positions.par_iter().zip(&part.shading_normals);
            vertices.map(|(position, normal)| project(shot, *position, *normal)).collect()
        })
        .collect();
    let band = BAND * shot.points;
    let bins = bins(parts, &projected, side, band);
    let mut pixels = vec![Pixel::Background; shot.size * shot.size];
    let negative = pixels
        .par_chunks_mut(BAND * shot.size)
        .enumerate()
        .map(|(number, pixels)| {
            let first = number * band;
            let triangles = bins.iter().flat_map(|bands| &bands[number]);
            let points = drawn(parts, &projected, triangles, first, side, band);
            shaded(parts, relit, shot, &points, first, pixels)
        })
        .sum();
    (Film::new(shot.size, pixels), negative)
}

#[expect(clippy::cast_possible_truncation, reason = "places in a picture")]
fn project(shot: &RenderParams, position: glam::DVec3, normal: Vec3) -> Projected {
    let side = shot.size * shot.points;
    let to_eye = (shot.camera.eye - position).as_vec3().normalize_or_zero();
    match shot.camera.project(position, side, side) {
        Some((place, distance)) => Projected {
            column: place.x as f32,
            row: place.y as f32,
            nearness: (1.0 / distance) as f32,
            is_facing: normal.dot(to_eye) > LEAST_FACING,
        },
        None => Projected { column: 0.0, row: 0.0, nearness: 0.0, is_facing: false },
    }
}

/// Triangles that are sorted into bands together.
const CHUNK: usize = 8192;

/// For each chunk of triangles and each band of so many rows of points, the triangles that reach into it, as part and number.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "rows of a picture")]
fn bins(
    parts: &[Part<'_>],
    projected: &[Vec<Projected>],
    side: usize,
    band: usize,
) -> Vec<Vec<Vec<(u32, u32)>>> {
    let chunks: Vec<(u32, u32, &[[u32; 3]])> = (0..)
        .zip(parts)
        .flat_map(|(part, own)| {
            let chunks = (0..).step_by(CHUNK).zip(own.surface.triangles.chunks(CHUNK));
            chunks.map(move |(first, triangles)| (part, first, triangles))
        })
        .collect();
    let sorted = chunks.into_par_iter().map(|(part, first, triangles)| {
        let mut bands = vec![Vec::new(); side.div_ceil(band)];
        for (number, corners) in (first..).zip(triangles) {
            let Some([a, b, c]) = visible(&projected[part as usize], corners) else { continue };
            let top = a.row.min(b.row).min(c.row).max(0.0);
            let bottom = a.row.max(b.row).max(c.row).min(side as f32 - 1.0);
            let left = a.column.min(b.column).min(c.column);
            let right = a.column.max(b.column).max(c.column);
            if top > bottom || left > side as f32 || right < 0.0 {
                continue;
            }
            for band in &mut bands[top as usize / band..=bottom as usize / band] {
                band.push((part, number));
            }
        }
        bands
    });
    sorted.collect()
}

/// The corners of a triangle before the camera that does not look away.
#[inline(always)]
fn visible(vertices: &[Projected], corners: &[u32; 3]) -> Option<[Projected; 3]> {
    let [a, b, c] = *corners;
    let [a, b, c] = [vertices[a as usize], vertices[b as usize], vertices[c as usize]];
    let is_before = a.nearness > 0.0 && b.nearness > 0.0 && c.nearness > 0.0;
    (is_before && (a.is_facing || b.is_facing || c.is_facing)).then_some([a, b, c])
}

/// What the points of a band show, `[row][column]`.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "places in a picture")]
fn drawn<'a>(
    parts: &[Part<'_>],
    projected: &[Vec<Projected>],
    triangles: impl Iterator<Item = &'a (u32, u32)>,
    first: usize,
    side: usize,
    rows: usize,
) -> Vec<Point> {
    let nothing = Point { part: EMPTY, triangle: 0, nearness: 0.0, shares: [0.0; 2] };
    let mut points = vec![nothing; rows * side];
    for &(part, triangle) in triangles {
        let corners = &parts[part as usize].surface.triangles[triangle as usize];
        let Some([a, b, c]) = visible(&projected[part as usize], corners) else { continue };
        // Points lie in the middle of their cells; the first whose middle is not before a place.
        let next = |v: f32, low: usize, high: usize| ((v + 0.5) as usize).clamp(low, high);
        let left = next(a.column.min(b.column).min(c.column), 0, side);
        let right = next(a.column.max(b.column).max(c.column), 0, side);
        let end = (first + rows).min(side);
        let top = next(a.row.min(b.row).min(c.row), first, end);
        let bottom = next(a.row.max(b.row).max(c.row), first, end);
        if left == right || top == bottom {
            continue;
        }
        let (ab, ac) = ([b.column - a.column, b.row - a.row], [c.column - a.column, c.row - a.row]);
        let area = ab[0] * ac[1] - ac[0] * ab[1];
        if area == 0.0 {
            continue;
        }
        let per_area = area.recip();
        for row in top..bottom {
            let y = row as f32 + 0.5 - a.row;
            for column in left..right {
                let x = column as f32 + 0.5 - a.column;
                let second = (x * ac[1] - ac[0] * y) * per_area;
                let third = (ab[0] * y - x * ab[1]) * per_area;
                let rest = 1.0 - second - third;
                if second < 0.0 || third < 0.0 || rest < 0.0 {
                    continue;
                }
                // One over the distance is linear in the picture, and so are values divided by it.
                let nearness = rest * a.nearness + second * b.nearness + third * c.nearness;
                let point = &mut points[(row - first) * side + column];
                if nearness > point.nearness {
                    let shares = [second * b.nearness / nearness, third * c.nearness / nearness];
                    *point = Point { part, triangle, nearness, shares };
                }
            }
        }
    }
    points
}

/// Shades the pixels of a band, means of their points; how many points were negative.
fn shaded(
    parts: &[Part<'_>],
    relit: &RelitScene,
    shot: &RenderParams,
    points: &[Point],
    first: usize,
    pixels: &mut [Pixel],
) -> usize {
    let widest = parts.iter().map(|part| 3 * part.maps.terms).max().unwrap_or(0);
    let values = &mut vec![0.0; widest];
    let rays = RayGrid::of(shot);
    pulp::Arch::new().dispatch(Shade { parts, relit, shot, rays, points, first, values, pixels })
}

/// Directions of the rays through points of a picture, not of unit length: linear in column and row.
#[derive(Clone, Copy)]
struct RayGrid {
    origin: Vec3,
    across: Vec3,
    down: Vec3,
}

impl RayGrid {
    fn of(shot: &RenderParams) -> Self {
        let (camera, side) = (&shot.camera, (shot.size * shot.points) as f64);
        let right = camera.forward().cross(camera.up());
        let half = (0.5 * camera.fov()).tan();
        let corner = camera.forward() + half * (camera.up() - right);
        let step = 2.0 * half / side;
        let [across, down] = [step * right, -step * camera.up()];
        let origin = corner + 0.5 * (across + down);
        Self { origin: origin.as_vec3(), across: across.as_vec3(), down: down.as_vec3() }
    }

    #[inline(always)]
    fn through(&self, column: usize, row: usize) -> Vec3 {
        self.origin + column as f32 * self.across + row as f32 * self.down
    }
}

struct Shade<'a> {
    parts: &'a [Part<'a>],
    relit: &'a RelitScene,
    shot: &'a RenderParams,
    rays: RayGrid,
    points: &'a [Point],
    first: usize,
    /// Room for the view maps of a point.
    values: &'a mut [f32],
    pixels: &'a mut [Pixel],
}

impl pulp::NullaryFnOnce for Shade<'_> {
    type Output = usize;

    #[inline(always)]
    fn call(self) -> usize {
        let Self { parts, relit, shot, rays, points, first, values, pixels } = self;
        let (per, side) = (shot.points, shot.size * shot.points);
        let mut negative = 0;
        for (number, pixel) in pixels.iter_mut().enumerate() {
            let (row, column) = (number / shot.size, number % shot.size);
            let (mut sum, mut hits) = (Vec3::ZERO, 0_usize);
            for at in 0..per * per {
                let (down, across) = (row * per + at / per, column * per + at % per);
                let point = &points[down * side + across];
                if point.part == EMPTY {
                    continue;
                }
                let part = &parts[point.part as usize];
                let arriving = &relit.parts[point.part as usize];
                let to_camera = -rays.through(across, first + down);
                let colour = colour(part, arriving, point, to_camera, values);
                negative += usize::from(colour.min_element() < 0.0);
                sum += colour.max(Vec3::ZERO);
                hits += 1;
            }
            if hits > 0 {
                let mean = (sum / hits as f32).as_dvec3();
                let colour = Rgb::new(mean.x, mean.y, mean.z);
                *pixel = Pixel::Radiance(colour, hits as f64 / (per * per) as f64);
            }
        }
        negative
    }
}

/// Σ_k h_k(wo) times what arrives for k, at a point.
#[inline(always)]
fn colour(
    part: &Part<'_>,
    arriving: &[[f32; 3]],
    point: &Point,
    to_camera: Vec3,
    values: &mut [f32],
) -> Vec3 {
    let terms = part.maps.terms;
    let [a, b, c] = part.surface.triangles[point.triangle as usize];
    let (a, b, c) = (a as usize, b as usize, c as usize);
    let [second, third] = point.shares;
    let first = 1.0 - second - third;
    let values = &mut values[..3 * terms];
    if let Some(constant) = part.maps.view.constant_values() {
        values.copy_from_slice(constant);
    } else {
        let normals = &part.shading_normals;
        let normal = first * normals[a] + second * normals[b] + third * normals[c];
        let mut local = local_to(normal.normalize_or(Vec3::Y), to_camera.normalize());
        // Smooth normals may look away where the triangle does not: its rim answers.
        if local.z < 0.0 {
            local = Vec3::new(local.x, local.y, 0.0).normalize_or(Vec3::X);
        }
        part.maps.view.read(local, 1.0, values);
    }
    let a = arriving[a * terms..][..terms].as_flattened();
    let b = arriving[b * terms..][..terms].as_flattened();
    let c = arriving[c * terms..][..terms].as_flattened();
    for (value, ((a, b), c)) in values.iter_mut().zip(a.iter().zip(b).zip(c)) {
        *value *= first * a + second * b + third * c;
    }
    let mut sum = Vec3::ZERO;
    for term in values.as_chunks::<3>().0 {
        sum += Vec3::from(*term);
    }
    sum
}

/// A direction in the tangent frame of a normal.
#[inline(always)]
fn local_to(n: Vec3, w: Vec3) -> Vec3 {
    if n.y < -0.9 {
        // Where f32 loses the frame.
        return (tangent_frame(n.as_dvec3()).transpose() * w.as_dvec3()).as_vec3();
    }
    let rest = 1.0 / (1.0 + n.y);
    let s = Vec3::new(1.0 - n.x * n.x * rest, -n.x, -n.x * n.z * rest);
    Vec3::new(s.dot(w), n.cross(s).dot(w), n.dot(w))
}
