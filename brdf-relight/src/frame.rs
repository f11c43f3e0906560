//! Tangent frames that depend on the normal alone.

use glam::{DMat3, DVec3};

/// Returns tangent, bitangent and normal, as columns, of a frame that is smooth all over a surface.
///
/// The tangents are s along u and t against v of the stereographic projection from the south pole, (n.x, n.z) / (1 +
/// n.y). The frame is smooth everywhere but at the south pole, about which it turns twice; there it is one of its
/// limits. Sources: Wang, Tran and Luebke 2004, section 3.4; the closed form divides their s by its length 2 (1 +
/// n.y).
///
/// ```
/// use glam::DVec3;
///
/// let normal = DVec3::new(0.6, 0.8, 0.0);
/// let frame = brdf_relight::tangent_frame(normal);
/// assert!((frame * DVec3::Z).distance(normal) < 1e-12);
/// assert!((frame.determinant() - 1.0).abs() < 1e-12);
/// ```
pub fn tangent_frame(normal: DVec3) -> DMat3 {
    let n = normal;
    let rest = 1.0 + n.y;
    if rest < 1e-7 {
        return DMat3::from_cols(DVec3::X, DVec3::Z, n);
    }
    let s = DVec3::new(1.0 - n.x * n.x / rest, -n.x, -n.x * n.z / rest);
    // Near the pole rounding has made it neither unit nor at a right angle.
    let s = (s - s.dot(n) * n).normalize();
    DMat3::from_cols(s, n.cross(s), n)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn unit() -> impl Strategy<Value = DVec3> {
        (-1.0..1.0_f64, 0.0..std::f64::consts::TAU).prop_map(|(y, phi)| {
            let planar = (1.0 - y * y).sqrt();
            DVec3::new(planar * phi.cos(), y, planar * phi.sin()).normalize()
        })
    }

    proptest! {
        #[test]
        fn frames_are_right_handed_and_unit(n in unit()) {
            let frame = tangent_frame(n);
            let identity = frame.transpose() * frame;
            prop_assert!((0..3).all(|c| (identity.col(c) - DMat3::IDENTITY.col(c)).length() < 1e-12));
            prop_assert!((frame.determinant() - 1.0).abs() < 1e-12);
            prop_assert_eq!(frame.z_axis, n);
        }

        #[test]
        fn the_tangent_is_the_derivative_of_the_projection(n in unit()) {
            prop_assume!(n.y > -0.9);
            let (u, v) = (n.x / (1.0 + n.y), n.z / (1.0 + n.y));
            let back = |u: f64, v: f64| {
                let r = u * u + v * v;
                DVec3::new(2.0 * u, 1.0 - r, 2.0 * v) / (1.0 + r)
            };
            let h = 1e-6;
            let along_u = (back(u + h, v) - back(u - h, v)).normalize();
            let along_v = (back(u, v + h) - back(u, v - h)).normalize();
            let frame = tangent_frame(n);
            prop_assert!((frame.x_axis - along_u).length() < 1e-7);
            prop_assert!((frame.y_axis + along_v).length() < 1e-7);
        }
    }

    #[test]
    fn the_south_pole_has_a_frame() {
        let near = DVec3::new(1e-5, -1.0, 1e-5).normalize();
        for n in [DVec3::NEG_Y, near] {
            let frame = tangent_frame(n);
            assert!((frame.determinant() - 1.0).abs() < 1e-9, "{frame}");
        }
    }
}
