//! Painted materials, bases, scenes and meshes as files: any bytes give a value or an error, never a panic, and
//! what is read can be used; what is written comes back.

use brdf_factor::{FactorParams, FactorSpec, Inversion, Plan, Preinverted, Problem};
use brdf_io::{
    BasisFile, BasisRecord, FitSettings, PaintRecord, PaintedFile, basis_to_bytes,
    painted_to_bytes, parse_basis, parse_mesh, parse_painted, read_scene, read_views,
};
use brdf_mesh::{Camera, Mesh, Soup, UvSource};
use brdf_model::{Channels, PairSampling, Preset, SampleSet};
use brdf_paint::{
    GroundTruth, Mode, PaintParams, PaintSamples, SolverChoice, ViewBuffers, extract, vertex_views,
};
use brdf_param::DirectionPair;
use brdf_render::{DirectionalLight, Light, MeshView, Uniform, render_mesh};
use glam::{DVec2, DVec3};
use proptest::prelude::*;

fn painted_file() -> PaintedFile {
    let mesh = Mesh::new(Soup::torus()).unwrap().0.with_sphere_coordinates();
    let brdf = Preset::ALL[0].brdf();
    let truth = GroundTruth { brdfs: [&brdf; 3], scale: 1.0 };
    let mut samples = PaintSamples::new();
    for (at, view) in vertex_views(&mesh)[..2].iter().enumerate() {
        let buffers = ViewBuffers::of(&mesh, view, 16, 16);
        samples.add(at, &view.name, &buffers, &truth.paint(&buffers), 0.1).unwrap();
    }
    let settings = PaintParams {
        mode: Mode::Hybrid,
        solver: SolverChoice::Paper,
        products: 2,
        texels: 5,
        surface_size: 3,
        map_size: 4,
        wraps: true,
        ..PaintParams::default()
    };
    let material = extract(&samples, &settings, &|_| ()).unwrap().material;
    PaintedFile { material, record: PaintRecord { settings, uv: UvSource::Sphere } }
}

fn basis_file(inversion: Inversion) -> BasisFile {
    let sampling = PairSampling { count: 40, seed: 1, theta_max: 1.3 };
    let samples = SampleSet::draw(&Preset::ALL[0].brdf(), &sampling, Channels::Luminance);
    let params = FactorParams { texture_size: 3, ..FactorParams::default() };
    let problem = Problem::new(&samples, &params).unwrap();
    let plan = Plan::of(&FactorSpec::radial(true), 3);
    let inverted = Preinverted::new(&problem, &[], plan.clone(), inversion).unwrap();
    let components = match inverted.inverse() {
        brdf_factor::Inverse::Cholesky(_) => None,
        brdf_factor::Inverse::Svd(basis) => Some(basis.components()),
    };
    let settings =
        FitSettings { params, reciprocal: true, samples: 40, seed: 1, replicate: 1, search: None };
    BasisFile {
        inverse: inverted.inverse().clone(),
        record: BasisRecord {
            method: "radial".to_owned(),
            plan,
            settings,
            key: inverted.key().to_owned(),
            unknowns: inverted.unknowns(),
            components,
        },
    }
}

fn basis_files() -> [BasisFile; 2] {
    let svd = Inversion::Svd { components: 4, damping: brdf_factor::Damping::Linear };
    [basis_file(Inversion::Cholesky), basis_file(svd)]
}

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

fn use_painted(bytes: &[u8]) {
    if let Ok(file) = parse_painted(bytes) {
        let pair = DirectionPair::new(DVec3::Z, DVec3::new(0.6, 0.0, 0.8));
        for place in [DVec2::ZERO, DVec2::ONE, DVec2::new(0.3, 0.7)] {
            let _ = file.material.value(&pair, place);
        }
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
fn what_is_written_comes_back() {
    let file = painted_file();
    let bytes = painted_to_bytes(&file).unwrap();
    assert_eq!(parse_painted(&bytes).unwrap(), file);
    for file in basis_files() {
        let bytes = basis_to_bytes(&file).unwrap();
        let again = parse_basis(&bytes).unwrap();
        assert_eq!(again.record, file.record);
        assert_eq!(basis_to_bytes(&again).unwrap(), bytes);
    }
    let message =
        parse_painted(&basis_to_bytes(&basis_files()[0]).unwrap()).unwrap_err().to_string();
    assert!(message.contains("another kind"), "{message}");
}

#[test]
fn damaged_files_are_refused_or_usable() {
    damaged(&painted_to_bytes(&painted_file()).unwrap()).for_each(|bytes| use_painted(&bytes));
    for file in basis_files() {
        for bytes in damaged(&basis_to_bytes(&file).unwrap()) {
            let _ = parse_basis(&bytes);
        }
    }
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

#[test]
fn a_basis_without_vectors_is_refused() {
    let [_, file] = basis_files();
    let brdf_factor::Inverse::Svd(basis) = &file.inverse else { panic!("asked for") };
    assert!(
        brdf_factor::SpectralBasis::from_parts(basis.unknowns(), Vec::new(), Vec::new()).is_none(),
        "nothing to solve with"
    );
}

proptest! {
    #![proptest_config(brdf_tests::cases(500))]

    #[test]
    fn any_text_is_a_mesh_or_a_scene_or_refused(text in "[-0-9a-z#\\., \n/{}\\[\\]:\"=_]{0,200}") {
        use_mesh(text.as_bytes());
        use_mesh(format!("ply\nformat ascii 1.0\n{text}").as_bytes());
        let _ = read_scene(&text);
        let _ = read_views(&format!("[[view]]\n{text}"));
    }

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
