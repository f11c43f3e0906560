//! Meshes of any triangles, degenerate ones among them.

use brdf_mesh::{Mesh, Soup};
use glam::DVec3;
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    /// Triangles anywhere, degenerate ones among them: what is kept can be hit.
    #[test]
    fn any_triangles_can_be_cast_at(
        corners in prop::collection::vec(prop::array::uniform3(-1.0_f64..1.0), 3..12),
        triangles in prop::collection::vec(prop::array::uniform3(0_u32..12), 1..10),
    ) {
        let count = u32::try_from(corners.len()).unwrap();
        let soup = Soup {
            positions: corners.into_iter().map(DVec3::from).collect(),
            triangles: triangles.into_iter().map(|t| t.map(|at| at % count)).collect(),
            ..Soup::default()
        };
        if let Ok((mesh, notes)) = Mesh::new(soup) {
            prop_assert_eq!(notes.triangles, mesh.triangles().len());
            for triangle in mesh.triangles() {
                let [a, b, c] = triangle.map(|at| mesh.positions()[at as usize]);
                let normal = (b - a).cross(c - a).normalize();
                let target = (a + b + c) / 3.0;
                // Rays towards the middle of a triangle meet it, or something before it.
                for side in [1.0, -1.0] {
                    let origin = target + side * 3.0 * normal;
                    let hit = mesh.hit(origin, -side * normal, 0.0);
                    let area = (b - a).cross(c - a).length();
                    prop_assert!(
                        area < 1e-5 || hit.is_some_and(|h| h.distance < 3.0 + 1e-6),
                        "{:?}", hit
                    );
                    if let Some(hit) = hit {
                        let surface = mesh.surface(&hit);
                        prop_assert!((surface.normal.length() - 1.0).abs() < 1e-9);
                        prop_assert!(surface.tangent.dot(surface.normal).abs() < 1e-9);
                        prop_assert!((0.0..=1.0).contains(&surface.uv.x));
                    }
                }
            }
        }
    }
}
