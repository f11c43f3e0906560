//! The frame of a surface among the axes of a scene.

use glam::DVec3;

/// An orthonormal, right-handed frame: the local x, y and z axes in those of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Local x.
    pub tangent: DVec3,
    /// Local y.
    pub bitangent: DVec3,
    /// Local z.
    pub normal: DVec3,
}

impl Frame {
    /// Returns a direction of the scene in the frame.
    pub fn to_local(&self, w: DVec3) -> DVec3 {
        DVec3::new(w.dot(self.tangent), w.dot(self.bitangent), w.dot(self.normal))
    }

    /// Returns a direction of the frame in axes of the scene.
    pub fn to_world(&self, w: DVec3) -> DVec3 {
        w.x * self.tangent + w.y * self.bitangent + w.z * self.normal
    }
}
