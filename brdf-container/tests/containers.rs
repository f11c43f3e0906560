//! Containers of BRDFs: any bytes give a value or an error, never a panic; what is written can be read.

#![allow(
    clippy::unwrap_used,
    clippy::missing_panics_doc,
    reason = "a test that cannot go on has failed"
)]

use brdf_container::{
    Contained, looks_like_container, read_container, read_factored, read_projections,
    write_factored, write_samples, write_separable, write_table,
};
use brdf_factor::{FactorParams, FactorSpec, TexelFormat, factorize};
use brdf_fit::{
    FactoredModel, FactoredRecord, FitSettingsRecord, Method, RankRecord, SeparableModel,
    SeparableRecord, SeparableSettingsRecord, TermRecord,
};
use brdf_job::Job;
use brdf_model::{
    Channels, MerlLookup, MerlNodes, MerlTable, PairSampling, Preset, SampleSet, log_offsets,
    measure,
};
use brdf_param::{HemisphereMap, Parametrization, Space};
use brdf_separable::{
    BrdfMatrix, Decomposition, EigenSolver, Fill, HemisphereGrid, Layout, MatrixParams,
    SeparableParams, factorize_matrix,
};
use proptest::prelude::*;

const THETA_MAX: f64 = 1.396;
const LOOKUP: MerlLookup = MerlLookup::Trilinear(MerlNodes::Centre);

fn samples() -> SampleSet {
    let sampling = PairSampling { count: 300, seed: 1, theta_max: THETA_MAX };
    SampleSet::draw(&Preset::ALL[0].brdf(), &sampling, Channels::Rgb)
}

/// The model with texels in a format.
fn stored_as(format: TexelFormat) -> FactoredModel {
    let mut file = model_file();
    file.model = file.model.stored_as(format).unwrap();
    for smaller in &mut file.smaller {
        *smaller = smaller.stored_as(format).unwrap();
    }
    file.record.settings.texels = format;
    file
}

fn model_file() -> FactoredModel {
    let samples = samples();
    let params = FactorParams { texture_size: 4, ..FactorParams::default() };
    let fit = factorize(&samples, &FactorSpec::mccool(true), &params).unwrap();
    let training = measure(&samples, &fit.model, &log_offsets(&samples));
    let one = factorize(&samples, &FactorSpec::mccool(true)[..1], &params).unwrap();
    FactoredModel {
        smaller: vec![one.model],
        record: FactoredRecord {
            method: Method::McCool,
            input: "preset".to_owned(),
            space: Space::Standard,
            settings: FitSettingsRecord {
                params,
                reciprocal: true,
                samples: 300,
                highlight: 0.0,
                seed: 1,
                replicate: 1,
                texels: TexelFormat::F32,
                search: None,
            },
            terms: vec![TermRecord {
                textures: 2,
                family: None,
                projections: Vec::new(),
                training,
                held_out: None,
                stored: None,
            }],
            samples_used: fit.samples_used,
            dropped: fit.dropped,
        },
        model: fit.model,
    }
}

/// Sums of products: textures on both sides, scalar ones on the first, and shared ones with signs.
fn separable_files() -> Vec<SeparableModel> {
    let chart = HemisphereGrid::Plane { map: HemisphereMap::OrthographicDisc, resolution: 4 };
    let layout = Layout::new(Parametrization::Standard, chart, chart);
    let brdf = Preset::find("red-plastic").unwrap().brdf();
    let matrix = BrdfMatrix::sample(&brdf, &layout, &MatrixParams::default()).unwrap();
    let eigen = Decomposition::Eigen(EigenSolver::Krylov);
    [(Decomposition::Svd, false), (Decomposition::Svd, true), (eigen, false)]
        .into_iter()
        .map(|(decomposition, joint_rgb)| {
            let params = SeparableParams { decomposition, joint_rgb, rank: 2, tolerance: 1e-5 };
            let fit = factorize_matrix(&matrix, &params, &Job::new()).unwrap();
            SeparableModel {
                model: fit.model,
                record: SeparableRecord {
                    method: Method::Svd,
                    input: "preset".to_owned(),
                    settings: SeparableSettingsRecord {
                        decomposition,
                        rank: 2,
                        joint_rgb,
                        theta_max: 1.5,
                        fill: Fill::Edge,
                        weight_power: 0.0,
                        held_out_theta_max: THETA_MAX,
                        seed: 1,
                    },
                    cells: matrix.counts(),
                    asymmetry: matrix.asymmetry(),
                    spectra: fit.spectra,
                    terms: fit
                        .errors
                        .into_iter()
                        .map(|matrix| RankRecord { matrix, held_out: None })
                        .collect(),
                },
            }
        })
        .collect()
}

/// One small valid file of each kind but tables.
fn valid_files() -> Vec<Vec<u8>> {
    vec![
        write_factored(&model_file()).unwrap(),
        write_factored(&stored_as(TexelFormat::F16)).unwrap(),
        write_factored(&stored_as(TexelFormat::U8)).unwrap(),
        write_samples(&samples()).unwrap(),
        write_separable(&separable_files()[1]).unwrap(),
    ]
}

#[test]
fn valid_files_are_recognised_by_content_and_read() {
    for bytes in valid_files() {
        assert!(looks_like_container(&bytes), "a container");
        assert!(brdf_io::detect(&bytes).is_err(), "no measured file");
        read_container(&bytes, LOOKUP).unwrap();
    }
}

#[test]
fn every_truncation_is_an_error() {
    for bytes in valid_files() {
        for length in 0..bytes.len() {
            let outcome = read_container(&bytes[..length], LOOKUP);
            assert!(outcome.is_err(), "cut at {length} was accepted");
        }
    }
}

#[test]
fn every_flipped_byte_is_read_or_refused() {
    for bytes in valid_files() {
        for at in 0..bytes.len().min(4_000) {
            for flip in [0x01, 0x80, 0xff] {
                let mut damaged = bytes.clone();
                damaged[at] ^= flip;
                let _ = read_container(&damaged, LOOKUP);
            }
        }
    }
}

#[test]
fn models_tables_and_samples_survive_storage_bit_by_bit() {
    for format in TexelFormat::ALL {
        let file = stored_as(format);
        let bytes = write_factored(&file).unwrap();
        assert_eq!(read_factored(&bytes).unwrap(), file);
        let read = read_container(&bytes, LOOKUP).unwrap();
        let Contained::Factored(again) = read else { panic!("a model") };
        assert_eq!(*again, file);
        assert_eq!(write_factored(&again).unwrap(), bytes);
    }

    for file in separable_files() {
        let bytes = write_separable(&file).unwrap();
        let read = read_container(&bytes, LOOKUP).unwrap();
        let Contained::Separable(again) = read else { panic!("a sum of products") };
        assert_eq!(*again, file);
        assert_eq!(write_separable(&again).unwrap(), bytes);
    }

    let samples = samples();
    let read = read_container(&write_samples(&samples).unwrap(), LOOKUP).unwrap();
    let Contained::Samples(again) = read else { panic!("samples") };
    assert_eq!(again, samples);

    let table = MerlTable::tabulate(&Preset::ALL[1].brdf());
    let read = read_container(&write_table(&table).unwrap(), LOOKUP).unwrap();
    let Contained::Table(again) = read else { panic!("a table") };
    assert_eq!(again, table);
}

/// What the program says of a model is what lies behind the head of its file.
#[test]
fn the_bytes_of_a_model_are_those_of_its_tensors() {
    for format in TexelFormat::ALL {
        let file = stored_as(format);
        let bytes = write_factored(&file).unwrap();
        let head = u64::from_le_bytes(bytes[..8].try_into().unwrap());
        let smaller: usize = file.smaller.iter().map(|model| model.payload_bytes()).sum();
        let tensors = bytes.len() - 8 - usize::try_from(head).unwrap();
        assert_eq!(tensors, file.model.payload_bytes() + smaller, "{format:?}");
    }
}

#[test]
fn texels_of_other_types_and_ranges_that_are_none_are_refused_in_one_line() {
    let replaced = |bytes: &[u8], from: &str, to: &str| {
        assert_eq!(from.len(), to.len(), "offsets stay");
        let head = String::from_utf8_lossy(&bytes[8..]).find(from).unwrap() + 8;
        let mut changed = bytes.to_vec();
        changed[head..head + to.len()].copy_from_slice(to.as_bytes());
        read_factored(&changed).unwrap_err().to_string()
    };
    let half = write_factored(&stored_as(TexelFormat::F16)).unwrap();
    // As many bytes a value as f16, so that the file itself is sound.
    let said = replaced(&half, r#""F16""#, r#""I16""#);
    assert!(said.contains("in F32, F16 or U8") && said.contains("I16"), "{said}");
    let eight = write_factored(&stored_as(TexelFormat::U8)).unwrap();
    let said = replaced(&eight, "factor0.range", "factor0.wrong");
    assert!(said.contains("factor0.range"), "{said}");
    for said in [said, replaced(&eight, r#""U8""#, r#""I8""#)] {
        assert_eq!(said.lines().count(), 1, "{said}");
    }

    let mut upside_down = stored_as(TexelFormat::U8);
    upside_down.smaller.clear();
    let mut bytes = write_factored(&upside_down).unwrap();
    let stored = upside_down.model.factors()[0].stored(3);
    let [low, high] = stored.ranges[0].map(f32::to_le_bytes);
    let range = [low, high].concat();
    let at = bytes.windows(8).position(|window| window == range).unwrap();
    bytes[at..at + 8].copy_from_slice(&[high, low].concat());
    let said = read_factored(&bytes).unwrap_err().to_string();
    assert!(said.contains("a smallest and a largest value"), "{said}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    #[test]
    fn any_text_is_read_or_refused(text in "[-0-9a-zé#\\., \n\t{}\\[\\]:\"e_]{0,300}") {
        let _ = read_container(text.as_bytes(), LOOKUP);
        let _ = read_projections(&text);
    }

    #[test]
    fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let _ = read_container(&bytes, LOOKUP);
    }
}
