//! Structural similarity.
//!
//! Source: Z. Wang, A. C. Bovik, H. R. Sheikh and E. P. Simoncelli, "Image Quality Assessment: From
//! Error Visibility to Structural Similarity", 2004: Gaussian window of σ = 1.5 and 11 taps, K1 =
//! .01, K2 = .03, range 1; the mean over channels.

use super::Planes;
use super::filter::{Border, gaussian, separable};

pub(super) const SIGMA: f64 = 1.5;
pub(super) const RADIUS: u32 = 5;
pub(super) const C1: f64 = 0.01 * 0.01;
pub(super) const C2: f64 = 0.03 * 0.03;

/// Returns the structural similarity around each pixel of two sRGB-encoded pictures in [0, 1] (Wang et al. 2004);
/// mirrored at the rim. Symmetric; 1 where equal.
///
/// # Panics
///
/// Unless both have the same size.
pub fn ssim_map(a: &Planes, b: &Planes) -> Vec<f64> {
    assert_eq!((a.width, a.len()), (b.width, b.len()), "pictures of the same size");
    let kernel = gaussian(SIGMA, RADIUS);
    let blur = |plane: &[f64]| separable(plane, a.width, &kernel, &kernel, Border::Mirror);
    let product =
        |x: &[f64], y: &[f64]| -> Vec<f64> { x.iter().zip(y).map(|(x, y)| x * y).collect() };
    let mut sum = vec![0.0; a.len()];
    for (x, y) in a.channels.iter().zip(&b.channels) {
        let (mean_x, mean_y) = (blur(x), blur(y));
        let [xx, yy, xy] = [(x, x), (y, y), (x, y)].map(|(x, y)| blur(&product(x, y)));
        for (index, sum) in sum.iter_mut().enumerate() {
            let (mx, my) = (mean_x[index], mean_y[index]);
            let (vx, vy) = (xx[index] - mx * mx, yy[index] - my * my);
            let covariance = xy[index] - mx * my;
            *sum += (2.0 * mx * my + C1) * (2.0 * covariance + C2)
                / ((mx * mx + my * my + C1) * (vx + vy + C2))
                / 3.0;
        }
    }
    sum
}
