//! Meshes: any bytes give a mesh or an error, never a panic, and what is read can be rendered.

use brdf_mesh::{Camera, Mesh, Soup, parse_mesh};
use brdf_model::Preset;
use brdf_paint::{ViewBuffers, vertex_views};
use brdf_render::{DirectionalLight, Light, MeshView, Uniform, render_mesh};
use glam::DVec3;
use proptest::prelude::*;

/// A square of two triangles, little-endian, with normals.
fn binary_ply() -> Vec<u8> {
    let mut bytes = b"ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\n\
        property float y\nproperty float z\nproperty float nx\nproperty float ny\n\
        property float nz\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
        .to_vec();
    for (x, y) in [(0.0_f32, 0.0_f32), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
        bytes.extend([x, y, 0.0, 0.0, 0.0, 1.0].iter().flat_map(|v| v.to_le_bytes()));
    }
    for corners in [[0_i32, 1, 2], [0, 2, 3]] {
        bytes.push(3);
        bytes.extend(corners.iter().flat_map(|v| v.to_le_bytes()));
    }
    bytes
}

const OBJ: &str =
    "# a square\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 1\nf 1/1 2/2 3/1 4/2\n";

fn use_mesh(bytes: &[u8]) {
    if let Ok((mesh, _)) = parse_mesh(bytes)
        && mesh.radius() < 1e6
    {
        let camera = Camera::around(mesh.centre(), mesh.radius(), DVec3::Z);
        let brdf = Preset::ALL[0].brdf();
        let view = MeshView { size: 4, has_ground: true, ..MeshView::default() };
        let light = Light::Directional(DirectionalLight::default());
        let film = render_mesh(&mesh, &Uniform(&brdf), &light, &camera, &view);
        assert_eq!(film.pixels().len(), 16, "a whole picture");
    }
}

/// Every cut and three flips of every byte.
fn damaged(bytes: &[u8]) -> impl Iterator<Item = Vec<u8>> + '_ {
    let cuts = (0..bytes.len()).map(|length| bytes[..length].to_vec());
    let flips = (0..bytes.len().min(6000)).flat_map(|at| {
        [0x01, 0x80, 0xff].map(|flip| {
            let mut damaged = bytes.to_vec();
            damaged[at] ^= flip;
            damaged
        })
    });
    cuts.chain(flips)
}

#[test]
fn damaged_files_are_refused_or_usable() {
    damaged(&binary_ply()).for_each(|bytes| use_mesh(&bytes));
    damaged(OBJ.as_bytes()).for_each(|bytes| use_mesh(&bytes));
}

/// Pictures of scans are the same anywhere: boxes are in single precision, but about the mesh.
#[test]
fn a_mesh_far_from_the_origin_has_no_holes() {
    let shift = DVec3::new(3e5, -2e5, 1e5);
    let moved = |by: DVec3| {
        let mut soup = Soup::torus();
        soup.positions.iter_mut().for_each(|p| *p += by);
        Mesh::new(soup).unwrap().0
    };
    let hits = [DVec3::ZERO, shift].map(|by| {
        let mesh = moved(by);
        let view = &vertex_views(&mesh)[3];
        let buffers = ViewBuffers::of(&mesh, view, 64, 64);
        buffers.pixels.iter().map(Option::is_some).collect::<Vec<_>>()
    });
    let differ = hits[0].iter().zip(&hits[1]).filter(|(a, b)| a != b).count();
    assert!(differ <= 2, "{differ} pixels differ");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn any_text_is_a_mesh_or_refused(text in "[-0-9a-z#\\., \n/{}\\[\\]:\"=_]{0,200}") {
        use_mesh(text.as_bytes());
        use_mesh(format!("ply\nformat ascii 1.0\n{text}").as_bytes());
    }
}
