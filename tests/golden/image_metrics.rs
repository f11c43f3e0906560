//! Image measures against scikit-image (PSNR, SSIM), flip-evaluator (ꟻLIP) and colour-science
//! (ΔE_ITP), recorded by `scripts/image_metrics.py` on pictures made from formulas.

use brdf_image::{PIXELS_PER_DEGREE, Planes, delta_e_itp_map, flip_map, psnr_db, ssim_map};

const WIDTH: usize = 64;
const HEIGHT: usize = 48;
const RECORDED: &str = include_str!("data/image_metrics.csv");

fn base(x: f64, y: f64, c: f64) -> f64 {
    (0.5 + 0.35 * (0.21 * x + 0.13 * y + c).sin() * (0.17 * y - 0.07 * x * c).cos()).clamp(0.0, 1.0)
}

fn picture(f: impl Fn(f64, f64, f64) -> f64) -> Planes {
    let plane = |c: u8| {
        (0..WIDTH * HEIGHT)
            .map(|i| {
                let [x, y] = [i % WIDTH, i / WIDTH].map(|v| v as f64);
                f(x, y, f64::from(c)).clamp(0.0, 1.0)
            })
            .collect()
    };
    Planes { width: WIDTH, channels: [plane(0), plane(1), plane(2)] }
}

fn case(name: &str) -> Planes {
    match name {
        "identical" => picture(base),
        "noise" => {
            picture(|x, y, c| base(x, y, c) + 0.04 * (12.9898 * x + 78.233 * y + 37.719 * c).sin())
        }
        "shift" => picture(|x, y, c| base(x + 2.0, y, c)),
        "brighter" => picture(|x, y, c| 1.1 * base(x, y, c) + 0.02),
        "blur" => picture(|x, y, c| {
            let around = [-1.0, 0.0, 1.0];
            let sum: f64 = around
                .iter()
                .flat_map(|dy| around.iter().map(move |dx| base(x + dx, y + dy, c)))
                .sum();
            sum / 9.0
        }),
        "highlight" => picture(|x, y, c| {
            let distance_sq = (x - 40.0).powi(2) + (y - 20.0).powi(2);
            base(x, y, c) + 0.5 * (-distance_sq / 18.0).exp()
        }),
        other => panic!("no such case: {other}"),
    }
}

/// Mean over all pixels but a rim.
fn mean(map: &[f64], rim: usize) -> f64 {
    let inside = |i: &usize| {
        let (x, y) = (i % WIDTH, i / WIDTH);
        (rim..WIDTH - rim).contains(&x) && (rim..HEIGHT - rim).contains(&y)
    };
    let values: Vec<f64> = (0..map.len()).filter(inside).map(|i| map[i]).collect();
    let count = values.len() as f64;
    values.iter().sum::<f64>() / count
}

#[test]
fn image_measures_equal_independent_implementations() {
    let reference = case("identical");
    let mask = vec![true; WIDTH * HEIGHT];
    let decode = |v: f64| if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) };
    let at = |row: usize, column: usize| row * WIDTH + column;
    let mut checked = 0;
    for line in RECORDED.lines().skip(1) {
        let [name, metric, value] = line.split(',').collect::<Vec<_>>()[..] else {
            panic!("three columns: {line}")
        };
        let expected: f64 = value.parse().unwrap();
        let test = case(name);
        let ssim = || ssim_map(&reference, &test);
        let flip = || flip_map(&reference, &test, PIXELS_PER_DEGREE);
        let itp = || delta_e_itp_map(&reference.map(decode), &test.map(decode));
        // ꟻLIP is recorded in single precision, the rest in double.
        let (found, allowed) = match metric {
            "psnr" => (psnr_db(&reference, &test, &mask).unwrap_or(f64::INFINITY), 1e-9),
            "ssim" => (mean(&ssim(), 5), 1e-9),
            "ssim_map_r12_c20" => (ssim()[at(12, 20)], 1e-9),
            "flip" => (mean(&flip(), 0), 1e-5),
            "flip_map_r12_c20" => (flip()[at(12, 20)], 2e-5),
            "flip_map_r20_c40" => (flip()[at(20, 40)], 2e-5),
            "delta_e_itp" => (mean(&itp(), 0), 1e-6),
            "delta_e_itp_r12_c20" => (itp()[at(12, 20)], 1e-6),
            other => panic!("no such metric: {other}"),
        };
        let agrees = found.to_bits() == expected.to_bits() || (found - expected).abs() <= allowed;
        assert!(agrees, "{name} {metric}: {found}, recorded {expected}");
        checked += 1;
    }
    assert_eq!(checked, 48);
}

#[test]
fn flip_reaches_its_ends() {
    // Recorded with flip-evaluator on flat pictures: these pass the knee of the colour scale.
    let flat = |rgb: [f64; 3]| Planes { width: 8, channels: rgb.map(|v| vec![v; 64]) };
    let error = |a: [f64; 3], b: [f64; 3]| flip_map(&flat(a), &flat(b), PIXELS_PER_DEGREE)[27];
    assert!((error([0.0, 1.0, 0.0], [0.0, 0.0, 1.0]) - 1.0).abs() < 1e-5);
    assert!((error([0.0; 3], [1.0; 3]) - 0.967_388).abs() < 2e-5);
    assert!((error([1.0, 0.0, 0.0], [0.0, 1.0, 1.0]) - 0.979_911).abs() < 2e-5);
}
