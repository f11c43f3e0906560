//! Shapes that a material is shown on, and a camera that fits each.
//!
//! Axes of the camera: x right, y up, z towards it. Axes of a shape: the same before it is tilted.

use std::f64::consts::{FRAC_PI_2, PI};

use brdf_param::Frame;
use glam::{DMat3, DVec2, DVec3};

use crate::spatially_varying::{SpatiallyVarying, TexturePoint};
use crate::sphere::RADIUS;
use crate::stage::{Hit, Stage, wrapped};

/// A shape that a material is laid on.
///
/// A sphere carries the tile by longitude and latitude, a cylinder by angle and height: squares on
/// the equator of the one, everywhere on the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// A square, its top away from the camera, in perspective: directions to the camera differ.
    Plane,
    /// A sphere, orthographic; without a tilt that of [`render_sphere`](crate::render_sphere).
    Sphere,
    /// The side of an upright cylinder, its top towards the camera, orthographic. As high as makes
    /// its picture square.
    Cylinder,
}

/// The largest tilt that is shown, radians: beyond it little is seen of a plane or of a cylinder's
/// side.
const STEEPEST: f64 = 85.0 * PI / 180.0;
/// From the camera to the centre of a plane, in half sides. A tilt of 60° then shows angles to the
/// normal from 43° to 69°.
const DISTANCE: f64 = 2.5;
/// Least cosine that stretches a footprint or a circle of latitude; keeps quotients finite.
const LEAST_COSINE: f64 = 1e-4;

impl Shape {
    /// Returns the tilt that shows it well, radians: 60° for a plane, none for a sphere, 15° for a cylinder.
    pub fn default_tilt(self) -> f64 {
        match self {
            Self::Plane => 60_f64.to_radians(),
            Self::Sphere => 0.0,
            Self::Cylinder => 15_f64.to_radians(),
        }
    }

    /// From the axes of the shape to those of the camera.
    fn rotation(self, tilt: f64) -> DMat3 {
        match self {
            Self::Plane => DMat3::from_rotation_x(-tilt),
            Self::Sphere | Self::Cylinder => DMat3::from_rotation_x(tilt),
        }
    }
}

/// A shape before its camera.
pub(crate) struct Scene<'a> {
    material: &'a dyn SpatiallyVarying,
    shape: Shape,
    rotation: DMat3,
    camera: Camera,
    /// Half the height of a cylinder.
    half_height: f64,
    tiles: f64,
    /// Pixels in a row.
    columns: usize,
    /// Rows of pixels: as many as the shape fills.
    rows: usize,
}

/// A place of a surface, in axes of the shape.
struct Surface {
    /// Along the ray, in units of the shape.
    distance: f64,
    tangent: DVec3,
    normal: DVec3,
    /// Tiles from the corner that u and v are counted from.
    uv: DVec2,
    /// Tiles per unit along the tangent and the bitangent.
    density: DVec2,
}

impl<'a> Scene<'a> {
    /// Fits a picture of `columns` pixels in a row.
    pub(crate) fn new(
        material: &'a dyn SpatiallyVarying,
        shape: Shape,
        tilt: f64,
        tiles: f64,
        columns: usize,
    ) -> Self {
        let tilt = tilt.clamp(-STEEPEST, STEEPEST);
        let rotation = shape.rotation(tilt);
        let columns = columns.max(1);
        let (camera, rows) = match shape {
            Shape::Plane => Camera::facing_square(&rotation, columns),
            Shape::Sphere => (Camera::orthographic(0.0), columns),
            Shape::Cylinder => (Camera::orthographic(-0.5 * RADIUS * tilt.sin()), columns),
        };
        // The rim of the near side hangs below that of the silhouette by sin(tilt).
        let half_height = (2.0 - tilt.sin().abs()) / (2.0 * tilt.cos());
        Self { material, shape, rotation, camera, half_height, tiles, columns, rows }
    }

    fn surface(&self, origin: DVec3, direction: DVec3) -> Option<Surface> {
        match self.shape {
            Shape::Plane => plane(origin, direction, self.tiles),
            Shape::Sphere => sphere(origin, direction, self.tiles),
            Shape::Cylinder => cylinder(origin, direction, self.half_height, self.tiles),
        }
    }
}

impl Stage for Scene<'_> {
    fn size(&self) -> (usize, usize) {
        (self.columns, self.rows)
    }

    fn hit(&self, column: f64, row: f64, step: f64) -> Option<Hit<'_>> {
        let half = 0.5 * to_f64(self.columns);
        let place = DVec2::new(column - half, 0.5 * to_f64(self.rows) - row) / half;
        let (origin, direction) = self.camera.ray(place);
        let to_shape = self.rotation.transpose();
        let surface = self.surface(to_shape * origin, to_shape * direction)?;
        let [tangent, normal] = [surface.tangent, surface.normal].map(|axis| self.rotation * axis);
        let frame = Frame { tangent, bitangent: normal.cross(tangent), normal };
        if direction.dot(normal) >= 0.0 {
            return None;
        }
        let depth = -surface.distance * direction.z;
        let side = step / half * self.camera.unit_at(depth);
        let footprint = footprint(&frame, direction, side, surface.density);
        let [u, v] = surface.uv.to_array().map(wrapped);
        Some(Hit {
            frame,
            to_camera: -direction,
            at: TexturePoint { u, v, footprint },
            material: self.material,
            position: origin + surface.distance * direction,
        })
    }

    /// Shapes are convex.
    fn is_lit(&self, _hit: &Hit<'_>, _direction: DVec3) -> bool {
        true
    }
}

/// The square from −1 to 1 along x and y.
fn plane(origin: DVec3, direction: DVec3, tiles: f64) -> Option<Surface> {
    let distance = -origin.z / direction.z;
    let point = (origin + distance * direction).truncate();
    (point.abs().max_element() <= 1.0).then(|| Surface {
        distance,
        tangent: DVec3::X,
        normal: DVec3::Z,
        uv: 0.5 * tiles * (point + DVec2::ONE),
        density: DVec2::splat(0.5 * tiles),
    })
}

/// The unit sphere; u and v are 0 at the left rim of an untilted one and at the south pole.
fn sphere(origin: DVec3, direction: DVec3, tiles: f64) -> Option<Surface> {
    let distance = nearer_root(1.0, origin.dot(direction), origin.length_squared() - 1.0)?;
    let normal = (origin + distance * direction).normalize();
    let cos_latitude = normal.x.hypot(normal.z).max(LEAST_COSINE);
    let per_radian = tiles / PI;
    let latitude = normal.y.clamp(-1.0, 1.0).asin();
    Some(Surface {
        distance,
        tangent: DVec3::Y.cross(normal).try_normalize().unwrap_or(DVec3::X),
        normal,
        uv: per_radian * DVec2::new(normal.x.atan2(normal.z) + FRAC_PI_2, latitude + FRAC_PI_2),
        density: per_radian * DVec2::new(1.0 / cos_latitude, 1.0),
    })
}

/// The cylinder of radius 1 about y; u is 0 at its left rim, v at its foot.
fn cylinder(origin: DVec3, direction: DVec3, half_height: f64, tiles: f64) -> Option<Surface> {
    let across = |w: DVec3| DVec2::new(w.x, w.z);
    let (from, towards) = (across(origin), across(direction));
    let distance =
        nearer_root(towards.length_squared(), from.dot(towards), from.length_squared() - 1.0)?;
    let point = origin + distance * direction;
    let per_unit = tiles / PI;
    (point.y.abs() <= half_height).then(|| {
        let normal = DVec3::new(point.x, 0.0, point.z).normalize();
        Surface {
            distance,
            tangent: DVec3::Y.cross(normal),
            normal,
            uv: per_unit * DVec2::new(point.x.atan2(point.z) + FRAC_PI_2, point.y + half_height),
            density: DVec2::splat(per_unit),
        }
    })
}

/// The smaller root of a x² + 2 b x + c, a > 0; none where it only touches.
fn nearer_root(a: f64, b: f64, c: f64) -> Option<f64> {
    let discriminant = b * b - a * c;
    (discriminant > 0.0).then(|| (-b - discriminant.sqrt()) / a)
}

/// The longer side, in tiles, of what a square of this side across the ray covers on the surface.
/// The longer one, lest anything alias; samples within a pixel keep the blur across it small.
fn footprint(frame: &Frame, direction: DVec3, side: f64, density: DVec2) -> f64 {
    let cosine = direction.dot(frame.normal).min(-LEAST_COSINE);
    [DVec3::X, DVec3::Y]
        .map(|axis| {
            let step = side * axis;
            let along = step - direction * (step.dot(frame.normal) / cosine);
            (density * DVec2::new(along.dot(frame.tangent), along.dot(frame.bitangent))).length()
        })
        .into_iter()
        .fold(0.0, f64::max)
}

/// A camera that looks along −z. The picture's places are in half widths of it, y up.
struct Camera {
    /// Height of the eye over the origin; none for parallel rays.
    eye: Option<f64>,
    /// Half widths of the picture for a unit of the shape, at a depth of 1 in perspective.
    scale: f64,
    /// Height of the picture's centre over the origin's image, in half widths.
    centre: f64,
}

impl Camera {
    fn orthographic(centre: f64) -> Self {
        Self { eye: None, scale: RADIUS, centre }
    }

    /// In perspective, fitted to the rotated square; the second is the number of rows it fills.
    fn facing_square(rotation: &DMat3, columns: usize) -> (Self, usize) {
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| {
            let corner = *rotation * DVec3::new(x, y, 0.0);
            corner.truncate() / (DISTANCE - corner.z)
        });
        let lowest = corners.into_iter().fold(DVec2::INFINITY, DVec2::min);
        let highest = corners.into_iter().fold(DVec2::NEG_INFINITY, DVec2::max);
        let scale = RADIUS / highest.x;
        let share = 0.5 * scale * (highest.y - lowest.y) + (1.0 - RADIUS);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a positive share of the columns"
        )]
        let rows = (share * to_f64(columns)).round().max(1.0) as usize;
        let centre = 0.5 * scale * (lowest.y + highest.y);
        (Self { eye: Some(DISTANCE), scale, centre }, rows)
    }

    /// Origin and unit direction of the ray through a place. Parallel rays start in the plane of the
    /// origin: what is nearer than it stands at a negative distance.
    fn ray(&self, place: DVec2) -> (DVec3, DVec3) {
        let on_plane = DVec2::new(place.x, place.y + self.centre) / self.scale;
        match self.eye {
            None => (on_plane.extend(0.0), DVec3::NEG_Z),
            Some(height) => (height * DVec3::Z, on_plane.extend(-1.0).normalize()),
        }
    }

    /// Units of the shape in a half width of the picture, at a depth before the eye.
    fn unit_at(&self, depth: f64) -> f64 {
        if self.eye.is_some() { depth / self.scale } else { 1.0 / self.scale }
    }
}

fn to_f64(count: usize) -> f64 {
    count as f64
}

#[cfg(test)]
mod tests {
    use brdf_model::Rgb;

    use super::*;

    struct Nothing;

    impl SpatiallyVarying for Nothing {
        fn reflect(&self, _at: &TexturePoint, _wo: DVec3, _lights: &[DVec3], _out: &mut [Rgb]) {}
    }

    const SHAPES: [Shape; 3] = [Shape::Plane, Shape::Sphere, Shape::Cylinder];

    fn scene(shape: Shape) -> Scene<'static> {
        Scene::new(&Nothing, shape, shape.default_tilt(), 2.0, 64)
    }

    #[test]
    fn frames_are_right_handed_and_face_the_camera() {
        for shape in SHAPES {
            let scene = scene(shape);
            let (mut hits, rows) = (0, to_f64(scene.rows));
            for index in 0..400_u32 {
                let column = f64::from(index % 20) * 3.2;
                let row = rows * (f64::from(index / 20) + 0.5) / 20.0;
                let Some(Hit { frame, to_camera, at, .. }) = scene.hit(column, row, 1.0) else {
                    continue;
                };
                hits += 1;
                assert!((0.0..1.0).contains(&at.u) && (0.0..1.0).contains(&at.v), "{at:?}");
                let volume = frame.tangent.cross(frame.bitangent).dot(frame.normal);
                assert!((volume - 1.0).abs() < 1e-12, "{shape:?}: {volume}");
                assert!(frame.to_local(to_camera).z > 0.0, "{shape:?} faces the camera");
            }
            assert!(hits > 250, "{shape:?} fills its picture: {hits} of 400");
        }
    }

    /// The difference between neighbours, where neither u nor v wraps.
    fn step_right_and_up(scene: &Scene, column: f64, row: f64) -> Option<[DVec2; 2]> {
        let uv = |column, row| scene.hit(column, row, 1.0).map(|h| DVec2::new(h.at.u, h.at.v));
        let here = uv(column, row)?;
        let steps = [uv(column + 1e-3, row)? - here, uv(column, row - 1e-3)? - here];
        steps.iter().all(|s| s.length() < 0.5).then_some(steps.map(|s| 1e3 * s))
    }

    #[test]
    fn u_runs_right_and_v_up_at_the_centre() {
        for shape in SHAPES {
            let scene = scene(shape);
            let [right, up] = step_right_and_up(&scene, 30.3, 0.47 * to_f64(scene.rows)).unwrap();
            assert!(right.x > 0.0 && right.y.abs() < 0.1 * right.x, "{shape:?}: {right}");
            assert!(up.y > 0.0 && up.x.abs() < 0.1 * up.y, "{shape:?}: {up}");
        }
    }

    #[test]
    fn the_footprint_is_the_longer_step_to_a_neighbour() {
        for shape in SHAPES {
            let scene = scene(shape);
            for (x, y) in [(0.5, 0.5), (0.3, 0.4), (0.66, 0.71)] {
                let (column, row) = (64.0 * x, to_f64(scene.rows) * y);
                let Some(steps) = step_right_and_up(&scene, column, row) else { continue };
                let expected = steps[0].length().max(steps[1].length());
                let found = scene.hit(column, row, 1.0).unwrap().at.footprint;
                assert!((found / expected - 1.0).abs() < 1e-2, "{shape:?}: {found} {expected}");
            }
        }
    }

    #[test]
    fn the_footprint_of_a_plane_grows_towards_its_far_side() {
        let scene = scene(Shape::Plane);
        let footprints: Vec<f64> = (0..scene.rows)
            .rev()
            .filter_map(|row| scene.hit(32.0, to_f64(row) + 0.5, 1.0))
            .map(|hit| hit.at.footprint)
            .collect();
        assert!(footprints.len() > 10, "{} rows", footprints.len());
        assert!(footprints.windows(2).all(|w| w[1] > w[0]), "{footprints:?}");
    }

    #[test]
    fn a_rounded_wrap_stays_below_one() {
        assert!(wrapped(-1e-20).abs() < 1e-300, "a tiny negative number wraps to 0");
        assert!((wrapped(-0.25) - 0.75).abs() < 1e-15, "the part after the point");
    }
}
