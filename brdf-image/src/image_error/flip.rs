//! ꟻLIP: what a viewer sees who switches between two pictures.
//!
//! Source: P. Andersson, J. Nilsson, T. Akenine-Möller, M. Oskarsson, K. Åström and M. D. Fairchild,
//! "ꟻLIP: A Difference Evaluator for Alternating Images", 2020.

use std::f64::consts::PI;

use brdf_model::decode_srgb;

use super::Planes;
use super::filter::{Border, gaussian, offsets, separable};

/// Pixels in a degree of the viewer's field, for a display 0.7 m wide with 3840 pixels, seen from 0.7 m.
pub const PIXELS_PER_DEGREE: f64 = 3840.0 * PI / 180.0;

/// Contrast sensitivity of each channel of YCxCz: weights a and widths b of a sum of Gaussians,
/// a √(π/b) exp(−π² r²/b), r in degrees.
const SENSITIVITY: [&[(f64, f64)]; 3] =
    [&[(1.0, 0.0047)], &[(1.0, 0.0053)], &[(34.1, 0.04), (13.5, 0.025)]];
/// The widest of them fixes the radius of all.
const WIDEST: f64 = 0.04;
/// Width of the edge and point detectors, degrees.
const DETECTOR_WIDTH: f64 = 0.082;
/// Exponent of colour differences, and the share of the largest that [`KNEE_ERROR`] is given to.
const COLOUR_EXPONENT: f64 = 0.7;
const KNEE: f64 = 0.4;
const KNEE_ERROR: f64 = 0.95;
const FEATURE_EXPONENT: f64 = 0.5;

/// Returns the ꟻLIP error at each pixel of two sRGB-encoded pictures in [0, 1], with this many pixels in a degree of
/// the viewer's field; values at the rim continue beyond it. Symmetric, in [0, 1], 0 where equal.
///
/// # Panics
///
/// Unless both have the same size.
pub fn flip_map(a: &Planes, b: &Planes, pixels_per_degree: f64) -> Vec<f64> {
    assert_eq!((a.width, a.len()), (b.width, b.len()), "pictures of the same size");
    let opponent = [a, b].map(|picture| picture.map(decode_srgb).map_pixels(to_ycxcz));
    let seen = opponent.each_ref().map(|picture| seen_colour(picture, pixels_per_degree));
    let features = opponent.each_ref().map(|picture| features(picture, pixels_per_degree));
    let largest = hyab(hunt_lab([0.0, 1.0, 0.0]), hunt_lab([0.0, 0.0, 1.0])).powf(COLOUR_EXPONENT);
    (0..a.len())
        .map(|index| {
            let difference = hyab(seen[0].pixel(index), seen[1].pixel(index)).powf(COLOUR_EXPONENT);
            let knee = KNEE * largest;
            let colour = if difference < knee {
                KNEE_ERROR * difference / knee
            } else {
                KNEE_ERROR + (1.0 - KNEE_ERROR) * (difference - knee) / (largest - knee)
            };
            let [edges, points] = [0, 1]
                .map(|kind: usize| (features[0][kind][index] - features[1][kind][index]).abs());
            let feature = (edges.max(points) / 2_f64.sqrt()).powf(FEATURE_EXPONENT);
            colour.powf(1.0 - feature)
        })
        .collect()
}

/// Linear Rec. 709 to XYZ, D65, in the exact rationals of the primaries.
const TO_XYZ: [[f64; 3]; 3] = [
    [10_135_552.0 / 24_577_794.0, 8_788_810.0 / 24_577_794.0, 4_435_075.0 / 24_577_794.0],
    [2_613_072.0 / 12_288_897.0, 8_788_810.0 / 12_288_897.0, 887_015.0 / 12_288_897.0],
    [1_425_312.0 / 73_733_382.0, 8_788_810.0 / 73_733_382.0, 70_074_185.0 / 73_733_382.0],
];

fn times(matrix: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

/// XYZ over that of white.
fn relative_xyz(rgb: [f64; 3]) -> [f64; 3] {
    let (xyz, white) = (times(&TO_XYZ, rgb), times(&TO_XYZ, [1.0; 3]));
    std::array::from_fn(|i| xyz[i] / white[i])
}

fn to_rgb(relative: [f64; 3]) -> [f64; 3] {
    let white = times(&TO_XYZ, [1.0; 3]);
    let xyz = glam::DVec3::from(std::array::from_fn::<f64, 3, _>(|i| relative[i] * white[i]));
    let [r0, r1, r2] = TO_XYZ;
    let forward = glam::DMat3::from_cols(r0.into(), r1.into(), r2.into()).transpose();
    (forward.inverse() * xyz).to_array()
}

fn to_ycxcz(rgb: [f64; 3]) -> [f64; 3] {
    let [x, y, z] = relative_xyz(rgb);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn from_ycxcz([luma, cx, cz]: [f64; 3]) -> [f64; 3] {
    let y = (luma + 16.0) / 116.0;
    to_rgb([y + cx / 500.0, y, y - cz / 200.0])
}

/// CIELAB with chroma scaled by lightness (Hunt effect), of linear values in [0, 1].
fn hunt_lab(rgb: [f64; 3]) -> [f64; 3] {
    const TOE: f64 = 6.0 / 29.0;
    let root = |t: f64| {
        if t > TOE * TOE * TOE { t.cbrt() } else { t / (3.0 * TOE * TOE) + 4.0 / 29.0 }
    };
    let [x, y, z] = relative_xyz(rgb).map(root);
    let lightness = 116.0 * y - 16.0;
    [lightness, 0.01 * lightness * 500.0 * (x - y), 0.01 * lightness * 200.0 * (y - z)]
}

/// City-block in lightness, Euclidean in chroma.
fn hyab(a: [f64; 3], b: [f64; 3]) -> f64 {
    (a[0] - b[0]).abs() + (a[1] - b[1]).hypot(a[2] - b[2])
}

/// What contrast sensitivity leaves of a picture in YCxCz, in Hunt-adjusted CIELAB.
fn seen_colour(opponent: &Planes, ppd: f64) -> Planes {
    let radius = radius_of(3.0 * (WIDEST / (2.0 * PI * PI)).sqrt() * ppd);
    let filtered = |plane: &[f64], terms: &[(f64, f64)]| {
        let kernels: Vec<Vec<f64>> = terms
            .iter()
            .map(|(_, b)| {
                offsets(radius).map(|x| (-PI * PI * (x / ppd) * (x / ppd) / b).exp()).collect()
            })
            .collect();
        // The weight of each term is that of its square window before anything is scaled.
        let weights: Vec<f64> = terms
            .iter()
            .zip(&kernels)
            .map(|((a, b), kernel)| a * (PI / b).sqrt() * kernel.iter().sum::<f64>().powi(2))
            .collect();
        let total: f64 = weights.iter().sum();
        let mut sum = vec![0.0; plane.len()];
        for (kernel, weight) in kernels.iter().zip(&weights) {
            let area: f64 = kernel.iter().sum();
            let unit: Vec<f64> = kernel.iter().map(|k| k / area).collect();
            let part = separable(plane, opponent.width, &unit, &unit, Border::Clamp);
            sum.iter_mut().zip(part).for_each(|(sum, v)| *sum += weight / total * v);
        }
        sum
    };
    let channels = std::array::from_fn(|c| filtered(&opponent.channels[c], SENSITIVITY[c]));
    Planes { width: opponent.width, channels }
        .map_pixels(|pixel| hunt_lab(from_ycxcz(pixel).map(|v| v.clamp(0.0, 1.0))))
}

/// Magnitudes of edges and of points in the unfiltered luma.
fn features(opponent: &Planes, ppd: f64) -> [Vec<f64>; 2] {
    let luma: Vec<f64> = opponent.channels[0].iter().map(|v| (v + 16.0) / 116.0).collect();
    let sigma = 0.5 * DETECTOR_WIDTH * ppd;
    let radius = radius_of(3.0 * sigma);
    let smooth = gaussian(sigma, radius);
    let edge: Vec<f64> = offsets(radius).zip(&smooth).map(|(x, g)| -x * g).collect();
    let point: Vec<f64> =
        offsets(radius).zip(&smooth).map(|(x, g)| (x * x / (sigma * sigma) - 1.0) * g).collect();
    [edge, point].map(|detector| {
        let detector = balanced(&detector);
        let [across, along] = [(&detector, &smooth), (&smooth, &detector)]
            .map(|(rows, columns)| separable(&luma, opponent.width, rows, columns, Border::Clamp));
        across.iter().zip(&along).map(|(x, y)| x.hypot(*y)).collect()
    })
}

/// Positive weights scaled to sum 1, negative ones to −1.
fn balanced(kernel: &[f64]) -> Vec<f64> {
    let positive: f64 = kernel.iter().filter(|k| **k > 0.0).sum();
    let negative: f64 = -kernel.iter().filter(|k| **k < 0.0).sum::<f64>();
    kernel.iter().map(|k| if *k > 0.0 { k / positive } else { k / negative }).collect()
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few pixels")]
fn radius_of(extent: f64) -> u32 {
    extent.ceil() as u32
}
