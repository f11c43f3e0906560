//! Painted materials, bases and scenes as files: any bytes give a value or an error, never a panic, and what is read
//! can be used; what is written comes back.

#![allow(
    clippy::unwrap_used,
    clippy::missing_panics_doc,
    reason = "a test that cannot go on has failed"
)]

use brdf_container::{
    ContainerError, Kind, PaintedFile, read_basis, read_painted, read_scene, read_views,
    write_basis, write_painted,
};
use brdf_factor::{FactorParams, FactorSpec, Inversion, Plan, Preinverted, Problem};
use brdf_fit::{Basis, BasisRecord, FitSettingsRecord, Method};
use brdf_job::Job;
use brdf_mesh::{Mesh, Soup, UvSource};
use brdf_model::{Channels, PairSampling, Preset, SampleSet};
use brdf_paint::{
    GroundTruth, Mode, PaintParams, PaintRecord, PaintSamples, SolverChoice, ViewBuffers, extract,
    vertex_views,
};
use brdf_param::DirectionPair;
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
    let material = extract(&samples, &settings, &Job::new()).unwrap().material;
    PaintedFile { material, record: PaintRecord { settings, uv: UvSource::Sphere } }
}

fn basis_file(inversion: Inversion) -> Basis {
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
    let settings = FitSettingsRecord {
        params,
        reciprocal: true,
        samples: 40,
        highlight: 0.0,
        seed: 1,
        replicate: 1,
        texels: brdf_factor::TexelFormat::F32,
        search: None,
    };
    Basis {
        inverse: inverted.inverse().clone(),
        record: BasisRecord {
            method: Method::Radial,
            plan,
            settings,
            key: inverted.key().to_owned(),
            unknowns: inverted.unknowns(),
            components,
        },
    }
}

fn basis_files() -> [Basis; 2] {
    let svd = Inversion::Svd { components: 4, damping: brdf_factor::Damping::Linear };
    [basis_file(Inversion::Cholesky), basis_file(svd)]
}

fn use_painted(bytes: &[u8]) {
    if let Ok(file) = read_painted(bytes) {
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
    let bytes = write_painted(&file).unwrap();
    assert_eq!(read_painted(&bytes).unwrap(), file);
    for file in basis_files() {
        let bytes = write_basis(&file).unwrap();
        let again = read_basis(&bytes).unwrap();
        assert_eq!(again.record, file.record);
        assert_eq!(write_basis(&again).unwrap(), bytes);
    }
    let error = read_painted(&write_basis(&basis_files()[0]).unwrap()).unwrap_err();
    let is_another_kind =
        matches!(error, ContainerError::Kind { found: Kind::Basis, expected: Kind::Painted });
    assert!(is_another_kind, "{error}");
}

#[test]
fn damaged_files_are_refused_or_usable() {
    damaged(&write_painted(&painted_file()).unwrap()).for_each(|bytes| use_painted(&bytes));
    for file in basis_files() {
        for bytes in damaged(&write_basis(&file).unwrap()) {
            let _ = read_basis(&bytes);
        }
    }
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
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn any_text_is_a_scene_or_refused(text in "[-0-9a-z#\\., \n/{}\\[\\]:\"=_]{0,200}") {
        let _ = read_scene(&text);
        let _ = read_views(&format!("[[view]]\n{text}"));
    }
}
