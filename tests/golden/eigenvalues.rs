//! The largest eigenvalue of a BRDF matrix, which pins a whole model in one number.
//!
//! Origin: the project's relighting experiments, Ashikhmin–Shirley with kd .5, ks .75, exponents 10
//! and 100 on the 1804 texels of a 48² orthographic disc: 390.56, found there with SciPy.

use brdf_model::{Brdf, Preset};
use brdf_param::{DirectionPair, HemisphereMap};
use glam::{DVec2, DVec3};

#[test]
fn the_ashikhmin_shirley_matrix_has_its_recorded_largest_eigenvalue() {
    let brdf = Preset::find("ashikhmin-shirley").unwrap().brdf();
    let directions: Vec<DVec3> = (0..48 * 48)
        .map(|index| {
            let centre = |i: i32| (f64::from(i) + 0.5) / 48.0 * 2.0 - 1.0;
            DVec2::new(centre(index % 48), centre(index / 48))
        })
        .filter(|point| point.length_squared() < 1.0)
        .filter_map(|point| HemisphereMap::OrthographicDisc.decode(point))
        .collect();
    assert_eq!(directions.len(), 1804);
    let matrix: Vec<Vec<f64>> = directions
        .iter()
        .map(|&wo| directions.iter().map(|&wi| brdf.eval(&DirectionPair::new(wi, wo)).r).collect())
        .collect();
    // The next eigenvalue is −311, so plain power iteration is enough for the first.
    let mut vector = vec![1.0; directions.len()];
    let mut eigenvalue = 0.0;
    for _ in 0..60 {
        let image: Vec<f64> =
            matrix.iter().map(|row| row.iter().zip(&vector).map(|(a, b)| a * b).sum()).collect();
        eigenvalue = image.iter().map(|v| v * v).sum::<f64>().sqrt();
        vector = image.iter().map(|v| v / eigenvalue).collect();
    }
    assert!((eigenvalue - 390.56).abs() < 0.01, "{eigenvalue}");
}
