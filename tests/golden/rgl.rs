//! RGL materials against the database's own evaluator: 400 points each, f_r cosθo, f32 arithmetic.

use std::fs;

use brdf_files::MappedFile;
use brdf_io::{ReadOptions, read};
use brdf_param::DirectionPair;
use brdf_tests::data_file;

const MATERIALS: [&str; 6] = [
    "aurora_white",
    "cc_iris_purple_gem",
    "cc_nothern_aurora",
    "chm_light_blue",
    "cm_military_green",
    "vch_silk_blue",
];

#[test]
fn evaluation_matches_the_reference_evaluator() {
    for name in MATERIALS {
        let (Some(material), Some(golden)) = (
            data_file(&format!("rgl/{name}_rgb.bsdf")),
            data_file(&format!("rgl_golden/{name}.csv")),
        ) else {
            return;
        };
        let measurement =
            read(&MappedFile::open(&material).unwrap(), &ReadOptions::default()).unwrap();
        let brdf = measurement.measured.brdf();
        let mut worst = 0.0_f64;
        for line in fs::read_to_string(golden).unwrap().lines().skip(1) {
            let v: Vec<f64> = line.split(',').map(|field| field.parse().unwrap()).collect();
            let [ti, pi, to, po] = [v[0], v[1], v[2], v[3]].map(f64::to_radians);
            let pair = DirectionPair::from_angles(ti, pi, to, po);
            let found = brdf.eval(&pair) * pair.wo.z;
            for (found, expected) in found.channels().into_iter().zip(&v[4..7]) {
                let allowed = 1e-3 * expected + 1e-4;
                worst = worst.max((found - expected).abs() / allowed);
            }
        }
        assert!(worst <= 1.0, "{name}: {worst} times what is allowed");
    }
}
