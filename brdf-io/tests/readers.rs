//! Readers: any bytes give a value or an error, never a panic; what is written can be read.

#![allow(
    clippy::unwrap_used,
    clippy::missing_panics_doc,
    reason = "a test that cannot go on has failed"
)]

use std::fs;
use std::io::Write as _;
use std::path::PathBuf;

use brdf_io::{
    Format, Measured, ReadOptions, detect, direction_rows, nbrdf_names, read, write_merl,
    write_samples,
};
use brdf_model::{Brdf, Channels, MerlTable, Nbrdf, PairSampling, Preset, RglBrdf, SampleSet};
use proptest::prelude::*;

const THETA_MAX: f64 = 1.396;

/// The folder of measured data: `BRDF_DATA`, or `../shared/data` beside the project.
///
/// `None`, with a printed reason, where a file in it is missing: tests then skip.
#[expect(clippy::print_stderr, reason = "a skipped test says why")]
fn data_file(relative: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("BRDF_DATA").map_or_else(
        || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared/data"),
        PathBuf::from,
    );
    let path = folder.join(relative);
    if path.exists() {
        return Some(path);
    }
    eprintln!("skipped: {relative} is not in the data folder; set BRDF_DATA to where it is");
    None
}

fn samples() -> SampleSet {
    let sampling = PairSampling { count: 100, seed: 1, theta_max: THETA_MAX };
    SampleSet::draw(&Preset::ALL[0].brdf(), &sampling, Channels::Rgb)
}

/// An archive of two neural BRDFs, or of one, as NumPy writes them.
fn archive(names: &[&str]) -> Vec<u8> {
    let mut zip = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for name in names {
        zip.start_file(format!("{name}.npy"), zip::write::SimpleFileOptions::default()).unwrap();
        let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (675,), }";
        let padded = format!("{header:<117}\n");
        zip.write_all(b"\x93NUMPY\x01\x00").unwrap();
        zip.write_all(&u16::try_from(padded.len()).unwrap().to_le_bytes()).unwrap();
        zip.write_all(padded.as_bytes()).unwrap();
        for index in 0..u16::try_from(Nbrdf::WEIGHTS).unwrap() {
            zip.write_all(&(f32::from(index % 13) * 0.01).to_le_bytes()).unwrap();
        }
    }
    zip.finish().unwrap().into_inner()
}

#[test]
fn materials_of_an_archive_are_taken_by_name() {
    let bytes = archive(&["felt", "brass"]);
    assert_eq!(nbrdf_names(&bytes).unwrap(), ["brass", "felt"]);
    let take = |material: Option<&str>| {
        let options =
            ReadOptions { material: material.map(str::to_owned), ..ReadOptions::default() };
        read(&bytes, &options)
    };
    assert!(matches!(take(Some("felt")).unwrap().measured, Measured::Nbrdf(_)));
    for (material, word) in [(None, "several"), (Some("gold"), "\"gold\"")] {
        let message = take(material).unwrap_err().to_string();
        assert!(message.contains(word) && message.contains("brass, felt"), "{message}");
    }
}

/// A small anisotropic tensor file, as RGL's layout describes it.
#[expect(clippy::cast_possible_truncation, reason = "a handful of short names")]
fn tensor_file(phi_i: &[f32]) -> Vec<u8> {
    let theta_i = [0.0_f32, 0.8, 1.5];
    let ramp = |n: usize| -> Vec<f32> { (0..n).map(|i| 1.0 + (i % 7) as f32).collect() };
    let slices = phi_i.len() * theta_i.len();
    let fields: Vec<(&str, Vec<u64>, Vec<f32>)> = vec![
        ("phi_i", vec![phi_i.len() as u64], phi_i.to_vec()),
        ("theta_i", vec![3], theta_i.to_vec()),
        ("ndf", vec![2, 4], ramp(8)),
        ("sigma", vec![2, 4], ramp(8)),
        ("vndf", vec![phi_i.len() as u64, 3, 4, 4], ramp(slices * 16)),
        ("rgb", vec![phi_i.len() as u64, 3, 3, 2, 2], ramp(slices * 12)),
    ];
    let mut header = b"tensor_file\0\x01\x00".to_vec();
    header.extend((fields.len() as u32).to_le_bytes());
    let names: usize = fields.iter().map(|(n, s, _)| 2 + n.len() + 2 + 1 + 8 + 8 * s.len()).sum();
    let mut offset = header.len() + names;
    let mut data = Vec::new();
    for (name, shape, values) in &fields {
        header.extend((name.len() as u16).to_le_bytes());
        header.extend(name.as_bytes());
        header.extend((shape.len() as u16).to_le_bytes());
        header.push(10);
        header.extend((offset as u64).to_le_bytes());
        shape.iter().for_each(|side| header.extend(side.to_le_bytes()));
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        offset += bytes.len();
        data.extend(bytes);
    }
    [header, data].concat()
}

fn cornell() -> Vec<u8> {
    b"# spectra\n3\n450 550 650\n0.5 0 0.5 3.1 0.1 0.2 0.3\n0.2 0 0.1 1.0 0.1, 0.1 0.1\n".to_vec()
}

fn alta() -> Vec<u8> {
    b"#DIM 3 1\n#PARAM_IN ISOTROPIC_TL_TV_PROJ_DPHI\n#PARAM_OUT INV_STERADIAN\n0.3 0.2 0.1 0.5\n\
      0.3 -0.4 0.0 0.7\n"
        .to_vec()
}

/// One small valid file for each text or compact format.
fn valid_files() -> Vec<(Format, Vec<u8>)> {
    vec![
        (Format::Nbrdf, archive(&["felt"])),
        (Format::Rgl, tensor_file(&[0.0])),
        (Format::Rgl, tensor_file(&[-3.2, -1.5, 0.0])),
        (Format::Table, write_samples(&samples()).into_bytes()),
        (Format::Cornell, cornell()),
        (Format::Alta, alta()),
    ]
}

#[test]
fn valid_files_are_recognised_by_content_and_read() {
    for (format, bytes) in valid_files() {
        assert_eq!(detect(&bytes).unwrap(), format);
        read(&bytes, &ReadOptions::default()).unwrap();
    }
}

#[test]
fn every_truncation_is_an_error_or_a_shorter_table() {
    for (format, bytes) in valid_files() {
        for length in 0..bytes.len() {
            let outcome = read(&bytes[..length], &ReadOptions::default());
            // A text that ends after a whole row is a whole text.
            let may_pass = matches!(format, Format::Table | Format::Cornell | Format::Alta);
            assert!(may_pass || outcome.is_err(), "{format:?} cut at {length} was accepted");
        }
    }
}

#[test]
fn every_flipped_byte_is_read_or_refused() {
    for (_, bytes) in valid_files() {
        for at in 0..bytes.len().min(4_000) {
            for flip in [0x01, 0x80, 0xff] {
                let mut damaged = bytes.clone();
                damaged[at] ^= flip;
                let _ = read(&damaged, &ReadOptions::default());
            }
        }
    }
}

#[test]
fn lying_headers_allocate_nothing() {
    // A tensor of 2⁶⁰ values in a file of a few hundred bytes.
    let mut bytes = tensor_file(&[0.0]);
    let at = bytes.windows(3).position(|w| w == b"ndf").unwrap() + 3 + 2 + 1 + 8;
    bytes[at..at + 8].copy_from_slice(&(1_u64 << 60).to_le_bytes());
    let message = read(&bytes, &ReadOptions::default()).unwrap_err().to_string();
    assert!(message.contains("ndf") && message.contains("past the end"), "{message}");

    // A MERL header over nothing, and over too much.
    let header: Vec<u8> = [90_u32, 90, 180].iter().flat_map(|d| d.to_le_bytes()).collect();
    let message = read(&header, &ReadOptions::default()).unwrap_err().to_string();
    assert!(message.contains("34992012") && message.contains("12 bytes"), "{message}");
}

#[test]
fn tables_survive_storage_bit_by_bit() {
    let table = MerlTable::tabulate(&Preset::ALL[1].brdf());
    let read = read(&write_merl(&table), &ReadOptions::default()).unwrap();
    let Measured::Merl(again) = read.measured else { panic!("a table") };
    assert_eq!(again, table);
}

#[test]
fn damaged_measured_files_are_refused_in_one_line() {
    let Some(path) = data_file("rgl/aurora_white_rgb.bsdf") else { return };
    let bytes = fs::read(path).unwrap();
    for length in [0, 5, 17, 100, 1_000, 200_000, bytes.len() - 2_000] {
        let message = read(&bytes[..length], &ReadOptions::default()).unwrap_err().to_string();
        assert!(
            !message.contains('\n') && message.contains("expected")
                || message.contains("past the end"),
            "{message}"
        );
    }
}

/// An anisotropic file measured over half a turn repeats after half a turn.
#[test]
fn half_measured_anisotropy_is_completed_by_symmetry() {
    let bytes = tensor_file(&[-std::f32::consts::PI, -1.5, 0.0]);
    let read = read(&bytes, &ReadOptions::default()).unwrap();
    let Measured::Rgl(material) = read.measured else { panic!("an RGL material") };
    let material: RglBrdf = *material;
    assert!(!material.is_isotropic());
    let sampling = PairSampling { count: 200, seed: 1, theta_max: 1.2 };
    for pair in sampling.pairs() {
        let (here, there) = (
            material.eval(&pair).r,
            material.eval(&pair.rotated_about_normal(std::f64::consts::PI)).r,
        );
        assert!((here - there).abs() <= 1e-6 * here, "{here} {there} at {pair:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    #[test]
    fn any_text_is_read_or_refused(text in "[-0-9a-zé#\\., \n\t{}\\[\\]:\"e_]{0,300}") {
        let _ = read(text.as_bytes(), &ReadOptions::default());
        let _ = direction_rows(&text);
    }

    #[test]
    fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let _ = read(&bytes, &ReadOptions::default());
    }
}
