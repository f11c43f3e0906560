//! The frame of a surface among the axes of a scene.

use glam::DVec3;

/// An orthonormal, right-handed frame: the local x, y and z axes, given in axes of the scene.
///
/// ```
/// use brdf_param::Frame;
/// use glam::DVec3;
///
/// // A wall whose normal points along x of the scene.
/// let wall = Frame { tangent: DVec3::Y, bitangent: DVec3::Z, normal: DVec3::X };
/// assert_eq!(wall.to_local(DVec3::X), DVec3::Z);
/// assert_eq!(wall.to_world(DVec3::Z), DVec3::X);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Local x axis, a unit vector.
    pub tangent: DVec3,
    /// Local y axis, a unit vector.
    pub bitangent: DVec3,
    /// Local z axis, a unit vector.
    pub normal: DVec3,
}

impl Frame {
    /// Returns a direction of the scene in axes of the frame.
    pub fn to_local(&self, w: DVec3) -> DVec3 {
        DVec3::new(w.dot(self.tangent), w.dot(self.bitangent), w.dot(self.normal))
    }

    /// Returns a direction of the frame in axes of the scene.
    pub fn to_world(&self, w: DVec3) -> DVec3 {
        w.x * self.tangent + w.y * self.bitangent + w.z * self.normal
    }
}
