//! Transport as a file: any bytes give a value or an error, never a panic, and what is read can be used; what is
//! written comes back.

#![allow(
    clippy::unwrap_used,
    clippy::missing_panics_doc,
    reason = "a test that cannot go on has failed"
)]

use brdf_container::{read_piece, read_relight, write_piece, write_relight};
use brdf_mesh::{Camera, Mesh, Soup};
use brdf_relight::{
    BrdfMaps, Chunk, Codec, CubeLight, LightMaps, LightRule, MapParams, Occluder, Part,
    Precomputation, PrecomputeParams, Quality, RelightRecord, RelitScene, RenderParams, Surface,
    render,
};
use glam::DVec3;

const CODECS: [Codec; 2] =
    [Codec::Wavelet { coefficients: 3 }, Codec::Clusters { tolerance: 1e-3 }];

/// A triangle and a half of another.
fn transport(codec: Codec) -> (Vec<Part<'static>>, Vec<Chunk>, RelightRecord) {
    let soup = Soup {
        positions: vec![DVec3::ZERO, DVec3::X, DVec3::Z, DVec3::Y],
        triangles: vec![[0, 2, 1], [0, 1, 3]],
        ..Soup::default()
    };
    let (mesh, _) = Mesh::new(soup).unwrap();
    let params = PrecomputeParams { codec, quality: Quality::One };
    let (surface, maps) = (Surface::of(&mesh), BrdfMaps::diffuse(0.5));
    let work = Precomputation::new(&mesh, surface, maps, params);
    let occluder = Occluder::of(&mesh);
    let chunks: Vec<Chunk> =
        (0..work.chunks().len()).map(|at| work.make(&occluder, at).unwrap()).collect();
    let record = RelightRecord {
        mesh: "two.obj".to_owned(),
        brdf: "matt".to_owned(),
        maps: MapParams { rank: 1, light_maps: LightMaps::Joint, resolution: 2, weight_power: 0.0 },
        precompute: params,
    };
    (vec![work.assemble(&chunks)], chunks, record)
}

fn use_transport(bytes: &[u8]) -> bool {
    let Ok(file) = read_relight(bytes) else { return false };
    let mut relit = RelitScene::default();
    relit.relight(&file.parts, &CubeLight::uniform([1.0; 3]).coefficients(LightRule::All));
    let camera = Camera::around(DVec3::ZERO, 2.0, DVec3::new(0.6, 0.0, 0.8));
    let (film, _) = render(&file.parts, &relit, &RenderParams { camera, size: 4, points: 1 });
    film.pixels().len() == 16
}

#[test]
fn what_is_written_comes_back() {
    for codec in CODECS {
        let (parts, chunks, record) = transport(codec);
        let bytes = write_relight(&parts, &record).unwrap();
        let file = read_relight(&bytes).unwrap();
        assert_eq!(file.record, record);
        assert_eq!(file.parts[0].transport, parts[0].transport);
        assert_eq!(file.parts[0].maps, parts[0].maps);
        assert_eq!(file.parts[0].surface.triangles, parts[0].surface.triangles);
        assert_eq!(write_relight(&file.parts, &file.record).unwrap(), bytes);
        for (number, chunk) in chunks.into_iter().enumerate() {
            assert_eq!(read_piece(&write_piece(number, &chunk)).unwrap(), (number, chunk));
        }
    }
}

#[test]
fn damaged_files_are_refused_or_usable() {
    for codec in CODECS {
        let (parts, chunks, record) = transport(codec);
        let bytes = write_relight(&parts, &record).unwrap();
        assert!(use_transport(&bytes), "whole");
        // Offsets make most of the file: its head is damaged everywhere, the rest here and there.
        let places = (0..3000).chain((3000..bytes.len()).step_by(97));
        for at in places {
            for flip in [0x01, 0x80, 0xff] {
                let mut damaged = bytes.clone();
                damaged[at.min(bytes.len() - 1)] ^= flip;
                use_transport(&damaged);
            }
        }
        for length in (0..bytes.len()).step_by(211) {
            assert!(!use_transport(&bytes[..length]), "cut to {length}");
        }
        let chunk = write_piece(0, &chunks[0]);
        for length in 0..chunk.len() {
            let _ = read_piece(&chunk[..length]);
        }
    }
}
