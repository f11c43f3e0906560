//! A pinhole camera anywhere.

use glam::{DMat3, DVec2, DVec3};

/// A perspective camera. Its axes: x right, y up, z from the scene towards it.
///
/// ```
/// use brdf_mesh::Camera;
/// use glam::{DVec2, DVec3};
///
/// let camera = Camera::looking_at(DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO, DVec3::Y, 0.5).expect("a view");
/// let (place, distance) = camera.project(DVec3::ZERO, 200, 100).expect("before the camera");
/// assert!(place.distance(DVec2::new(100.0, 50.0)) < 1e-9 && (distance - 5.0).abs() < 1e-9);
/// assert!(camera.ray(place, 200, 100).distance(DVec3::NEG_Z) < 1e-9);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Place where it stands.
    pub eye: DVec3,
    /// Its axes in those of the scene, as columns.
    axes: DMat3,
    /// Tangent of half the angle across the picture.
    half_width: f64,
}

/// From the centre of a mesh to a camera that shows all of it, in radii.
const DISTANCE: f64 = 3.5;
/// Share of half the picture that the sphere around a mesh fills.
const FILLED: f64 = 0.96;

impl Camera {
    /// Returns a camera at `eye` that looks at `target`, with `up` upwards in its picture and an angle `fov` across
    /// in radians. `None` if it stands on its target, looks along `up`, or the angle is not within (0, π).
    pub fn looking_at(eye: DVec3, target: DVec3, up: DVec3, fov: f64) -> Option<Self> {
        let back = (eye - target).try_normalize()?;
        let right = up.cross(back).try_normalize()?;
        let is_sound = fov > 0.0 && fov < std::f64::consts::PI && eye.is_finite();
        let axes = DMat3::from_cols(right, back.cross(right), back);
        is_sound.then_some(Self { eye, axes, half_width: (0.5 * fov).tan() })
    }

    /// Returns a camera that shows all of a sphere, seen from the unit direction `from`.
    pub fn around(centre: DVec3, radius: f64, from: DVec3) -> Self {
        let eye = centre + DISTANCE * radius * from;
        let up = if from.y.abs() < 0.999 { DVec3::Y } else { DVec3::NEG_Z };
        let right = up.cross(from).normalize();
        let axes = DMat3::from_cols(right, from.cross(right), from);
        // The sphere's rim seen from the eye.
        let half_width = (1.0 / DISTANCE).asin().tan() / FILLED;
        Self { eye, axes, half_width }
    }

    /// Returns the angle across the picture, radians.
    pub fn fov(&self) -> f64 {
        2.0 * self.half_width.atan()
    }

    /// Returns the unit direction in which it looks.
    pub fn forward(&self) -> DVec3 {
        -self.axes.z_axis
    }

    /// Returns the unit direction that is up in its picture.
    pub fn up(&self) -> DVec3 {
        self.axes.y_axis
    }

    /// Returns a direction of the scene in axes of the camera.
    pub fn to_camera(&self, direction: DVec3) -> DVec3 {
        self.axes.transpose() * direction
    }

    /// Returns a direction in axes of the camera in those of the scene.
    pub fn to_scene(&self, direction: DVec3) -> DVec3 {
        self.axes * direction
    }

    /// Returns the unit direction of the ray through a place of a picture of `columns` × `rows` pixels; places are
    /// in pixels from its top left.
    pub fn ray(&self, place: DVec2, columns: usize, rows: usize) -> DVec3 {
        let half = 0.5 * columns as f64;
        let across = (place.x - half) / half * self.half_width;
        let up = (0.5 * rows as f64 - place.y) / half * self.half_width;
        (self.axes * DVec3::new(across, up, -1.0)).normalize()
    }

    /// Returns where a point stands in a picture of `columns` × `rows` pixels, in pixels from its top left, and how
    /// far it is along the view; `None` behind the camera.
    pub fn project(&self, point: DVec3, columns: usize, rows: usize) -> Option<(DVec2, f64)> {
        let local = self.to_camera(point - self.eye);
        let (distance, half) = (-local.z, 0.5 * columns as f64);
        let scale = half / (self.half_width * distance);
        let place = DVec2::new(half + local.x * scale, 0.5 * rows as f64 - local.y * scale);
        (distance > 0.0).then_some((place, distance))
    }

    /// Returns the side of a pixel at a distance of 1, in a picture of `columns` columns.
    pub fn pixel_side(&self, columns: usize) -> f64 {
        2.0 * self.half_width / columns as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_picture_is_upright_and_not_mirrored() {
        let camera = Camera::around(DVec3::ZERO, 1.0, DVec3::Z);
        let ray = |x: f64, y: f64| camera.ray(DVec2::new(x, y), 100, 100);
        assert!((ray(50.0, 50.0) - DVec3::NEG_Z).length() < 1e-12, "through the middle");
        assert!(ray(90.0, 50.0).x > 0.0 && ray(50.0, 10.0).y > 0.0, "right and up");
        let from = DVec3::new(1.0, 2.0, -0.5).normalize();
        let camera = Camera::around(DVec3::ONE, 2.0, from);
        let miss = |place| {
            let ray = camera.ray(place, 100, 100);
            let towards = DVec3::ONE - camera.eye;
            (towards - towards.dot(ray) * ray).length()
        };
        assert!(miss(DVec2::new(50.0, 50.0)) < 1e-9, "looks at the centre");
        assert!((miss(DVec2::new(98.0, 50.0)) - 2.0).abs() < 0.02, "the rim of the sphere");
    }

    #[test]
    fn a_point_is_seen_along_its_ray() {
        let camera = Camera::around(DVec3::ONE, 2.0, DVec3::new(1.0, 2.0, -0.5).normalize());
        let point = DVec3::new(0.3, 1.8, 0.1);
        let (place, distance) = camera.project(point, 300, 200).unwrap();
        let ray = camera.ray(place, 300, 200);
        assert!((point - camera.eye).normalize().distance(ray) < 1e-12, "{place}");
        assert!(((point - camera.eye).dot(camera.forward()) - distance).abs() < 1e-12);
        assert!(camera.project(2.0 * camera.eye, 300, 200).is_none(), "behind it");
    }

    #[test]
    fn a_camera_that_cannot_be_is_none() {
        let look = |eye, up, fov| Camera::looking_at(eye, DVec3::ZERO, up, fov);
        assert!(look(DVec3::ZERO, DVec3::Y, 1.0).is_none());
        assert!(look(DVec3::Y, DVec3::Y, 1.0).is_none());
        assert!(look(DVec3::Z, DVec3::Y, 4.0).is_none());
        let same = look(DVec3::Z, DVec3::Y, 1.0).unwrap();
        assert!(
            (same.forward() - DVec3::NEG_Z).length() < 1e-12 && (same.fov() - 1.0).abs() < 1e-12
        );
    }
}
