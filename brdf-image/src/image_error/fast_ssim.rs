//! Mean structural similarity of many 8-bit pictures, fast.
//!
//! The same measure as [`ssim_map`](super::ssim_map), in f32 and without a map, on Y'CbCr: textures
//! of materials differ mostly in luma. Sum s = x + y and difference d = x − y of two planes say all:
//! with means m and variances v, similarity is (1 − m_d² / A)(1 − v_d / B), A = (m_s² + m_d²)/2 + C1,
//! B = (v_s + v_d)/2 + C2. That takes four filtered maps in place of five, and equal planes give
//! exactly 1 in any precision.

use super::filter::{gaussian, mirrored};
use super::ssim::{C1, C2, RADIUS, SIGMA};

const REACH: usize = RADIUS as usize;
const TAPS: usize = 2 * REACH + 1;
/// s, d, s² and d².
const MOMENTS: usize = 4;
/// Y', Cb and Cr.
const PLANES: usize = 3;
/// Weights of R', G' and B' in luma, ITU-R BT.601.
const LUMA: [f64; 3] = [0.299, 0.587, 0.114];
/// What each plane counts for. The usual weights for colour pictures: luma carries structure.
const PLANE_WEIGHTS: [f64; PLANES] = [0.8, 0.1, 0.1];

/// Scratch memory for the structural similarity of pictures of one size; one for each thread.
///
/// ```
/// let grey = [128; 3 * 16 * 16];
/// let same = brdf_image::SsimWorkspace::new(16, 16).mean_ssim(&grey, &grey);
/// assert!((same - 1.0).abs() < 1e-6);
/// ```
#[derive(Clone, Debug)]
pub struct SsimWorkspace {
    width: usize,
    height: usize,
    /// Weights of the three bytes of a pixel in each plane.
    planes: [[f32; 3]; PLANES],
    /// Weights of the centre and of the taps 1, 2, … beside it.
    kernel: [f32; REACH + 1],
    /// The moments of one row of each plane, continued by `REACH` on both sides.
    padded: Vec<f32>,
    /// The last `TAPS` rows of moments, filtered along the row.
    ring: Vec<f32>,
    /// One row of moments, filtered both ways.
    blurred: Vec<f32>,
}

impl SsimWorkspace {
    /// Returns a workspace for pictures of this size.
    ///
    /// # Panics
    ///
    /// If a side is 0.
    pub fn new(width: usize, height: usize) -> Self {
        assert!(width > 0 && height > 0, "pictures have pixels");
        let weights = gaussian(SIGMA, RADIUS);
        let segments = PLANES * MOMENTS;
        Self {
            width,
            height,
            planes: planes_of_bytes(),
            kernel: std::array::from_fn(|offset| narrow(weights[REACH + offset])),
            padded: vec![0.0; segments * (width + 2 * REACH)],
            ring: vec![0.0; TAPS * segments * width],
            blurred: vec![0.0; segments * width],
        }
    }

    /// Returns the mean similarity of two sRGB-encoded pictures, three bytes a pixel, row by row. Symmetric; 1 where
    /// equal.
    ///
    /// It is that of their full-range ITU-R BT.601 planes Y', Cb and Cr, unrounded, weighted .8, .1, .1; mirrored at
    /// the rim as [`ssim_map`](super::ssim_map) is, and within 1e-4 of it.
    ///
    /// # Panics
    ///
    /// Unless both have the size of the workspace.
    pub fn mean_ssim(&mut self, a: &[u8], b: &[u8]) -> f64 {
        let (row_bytes, rows) = (3 * self.width, self.height);
        assert_eq!(
            [a.len(), b.len()],
            [row_bytes * rows; 2],
            "pictures of the workspace's size, three bytes a pixel"
        );
        let mut sums = [0.0; PLANES];
        for step in 0..rows + REACH {
            if step < rows {
                let bytes = step * row_bytes..(step + 1) * row_bytes;
                self.spread_row(&a[bytes.clone()], &b[bytes]);
                self.filter_row(step % TAPS);
            }
            if step >= REACH {
                self.filter_column(step - REACH);
                self.add_similarity(&mut sums);
            }
        }
        let pixels = (self.width * rows) as f64;
        sums.iter().zip(PLANE_WEIGHTS).map(|(sum, weight)| weight * sum).sum::<f64>() / pixels
    }

    /// Takes the moments of one row of both pictures.
    fn spread_row(&mut self, a: &[u8], b: &[u8]) {
        let width = self.width;
        let stride = width + 2 * REACH;
        for (plane, moments) in self.padded.chunks_exact_mut(MOMENTS * stride).enumerate() {
            let weights = self.planes[plane];
            // Squares about the middle of the range lose fewer digits.
            let middle = if plane == 0 { 1.0 } else { 0.0 };
            let (linear, squares) = moments.split_at_mut(2 * stride);
            let (sums, differences) = linear.split_at_mut(stride);
            let inside = sums[REACH..][..width].iter_mut().zip(&mut differences[REACH..][..width]);
            let pixels = a.as_chunks::<3>().0.iter().zip(b.as_chunks::<3>().0);
            for ((sum, difference), (a, b)) in inside.zip(pixels) {
                let [x, y] = [a, b].map(|rgb| {
                    let [r, g, b] = rgb.map(f32::from);
                    weights[0] * r + weights[1] * g + weights[2] * b
                });
                (*sum, *difference) = (x + y - middle, x - y);
            }
            for row in [sums, differences] {
                continue_mirrored(row, width);
            }
            for (square, value) in squares.iter_mut().zip(&*linear) {
                *square = value * value;
            }
        }
    }
    /// Filters the moments along the row, into a place of the ring.
    fn filter_row(&mut self, place: usize) {
        let length = self.blurred.len();
        let target = &mut self.ring[place * length..][..length];
        let segments = target.chunks_exact_mut(self.width);
        for (out, padded) in segments.zip(self.padded.chunks_exact(self.width + 2 * REACH)) {
            weighted_sum(&self.kernel, |tap| &padded[tap..], out);
        }
    }

    /// Filters the rows of the ring along the column, around a row.
    fn filter_column(&mut self, row: usize) {
        let (ring, length, height) = (&self.ring, self.blurred.len(), self.height);
        let line = |tap: usize| {
            let place = mirrored(row + tap, REACH, height) % TAPS;
            &ring[place * length..][..length]
        };
        weighted_sum(&self.kernel, line, &mut self.blurred);
    }

    /// Adds the similarities of a row to the sum of each plane.
    fn add_similarity(&self, sums: &mut [f64; PLANES]) {
        let planes = self.blurred.chunks_exact(MOMENTS * self.width);
        for (sum, moments) in sums.iter_mut().zip(planes) {
            let [means, squares] = [0, 1].map(|half| &moments[2 * half * self.width..]);
            let (mean_s, mean_d) = means.split_at(self.width);
            let (square_s, square_d) = squares.split_at(self.width);
            let pixels = mean_s.iter().zip(mean_d).zip(square_s.iter().zip(square_d));
            *sum += pixels.map(|((ms, md), (ss, dd))| similarity(*ms, *md, *ss, *dd)).sum::<f64>();
        }
    }
}

/// From filtered s, less its middle 1, d, s² and d².
fn similarity(mean_s: f32, mean_d: f32, square_s: f32, square_d: f32) -> f64 {
    let (variance_s, variance_d) = (square_s - mean_s * mean_s, square_d - mean_d * mean_d);
    let whole_s = mean_s + 1.0;
    let a = 0.5 * (whole_s * whole_s + mean_d * mean_d) + narrow(C1);
    let b = 0.5 * (variance_s + variance_d) + narrow(C2);
    f64::from((a - mean_d * mean_d) * (b - variance_d) / (a * b))
}

/// Y', Cb and Cr in [0, 1] of bytes, but for the ½ that is added to chroma.
fn planes_of_bytes() -> [[f32; 3]; PLANES] {
    let chroma = |channel: usize| {
        let scale = 2.0 * (1.0 - LUMA[channel]);
        std::array::from_fn(|c| (f64::from(u8::from(c == channel)) - LUMA[c]) / scale)
    };
    [LUMA, chroma(2), chroma(0)].map(|weights| weights.map(|w| narrow(w / 255.0)))
}

/// Fills both margins of a row that stands at `REACH`, mirrored, the outermost value twice.
fn continue_mirrored(row: &mut [f32], width: usize) {
    for place in (0..REACH).chain(REACH + width..width + 2 * REACH) {
        row[place] = row[REACH + mirrored(place, REACH, width)];
    }
}

/// The sum of `TAPS` lines, tap 0 first, with weights symmetric about the middle one.
///
/// One pass for each pair of lines: plain loops over slices are what compilers turn into vectors.
fn weighted_sum<'a>(kernel: &[f32; REACH + 1], line: impl Fn(usize) -> &'a [f32], out: &mut [f32]) {
    for (sum, value) in out.iter_mut().zip(line(REACH)) {
        *sum = kernel[0] * value;
    }
    for (offset, weight) in kernel.iter().enumerate().skip(1) {
        let pairs = line(REACH - offset).iter().zip(line(REACH + offset));
        for (sum, (before, after)) in out.iter_mut().zip(pairs) {
            *sum += weight * (before + after);
        }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "f32 is the point here")]
fn narrow(value: f64) -> f32 {
    value as f32
}

#[cfg(test)]
mod tests {
    use super::super::{Planes, ssim_map};
    use super::*;

    /// Full-range Y'CbCr in f64 and three maps, one for each plane.
    fn oracle(width: usize, a: &[u8], b: &[u8]) -> f64 {
        let planes = [a, b].map(|bytes| {
            let pixel = |rgb: &[u8; 3]| {
                let [r, g, b] = rgb.map(|v| f64::from(v) / 255.0);
                let luma = 0.299 * r + 0.587 * g + 0.114 * b;
                [luma, 0.5 + (b - luma) / 1.772, 0.5 + (r - luma) / 1.402]
            };
            bytes.as_chunks::<3>().0.iter().map(pixel).collect::<Vec<_>>()
        });
        let similarity = |plane: usize| {
            let grey = |pixels: &Vec<[f64; 3]>| {
                let channel: Vec<f64> = pixels.iter().map(|p| p[plane]).collect();
                Planes { width, channels: [channel.clone(), channel.clone(), channel] }
            };
            let map = ssim_map(&grey(&planes[0]), &grey(&planes[1]));
            map.iter().sum::<f64>() / map.len() as f64
        };
        0.8 * similarity(0) + 0.1 * similarity(1) + 0.1 * similarity(2)
    }

    /// SplitMix64, a byte at a time.
    fn noise(seed: u64, count: usize) -> Vec<u8> {
        let mut state = seed;
        let mut next = || {
            state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mixed = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            mixed.to_le_bytes()[5]
        };
        (0..count).map(|_| next()).collect()
    }

    /// Flat white, a ramp of colours, a chequer and dark noise, side by side.
    fn structured(width: usize, height: usize) -> Vec<u8> {
        let grain = noise(5, width * height);
        let pixel = |index: usize| {
            let (x, y) = (index % width, index / width);
            let down = u8::try_from(y * 255 / height).unwrap();
            match 4 * x / width {
                0 => [255; 3],
                1 => [down, 90, 255 - down],
                2 => [if (x / 3 + y / 5) % 2 == 0 { 230 } else { 12 }; 3],
                _ => [grain[index] / 32, grain[index] / 24, 3],
            }
        };
        (0..width * height).flat_map(pixel).collect()
    }

    fn check(width: usize, height: usize, a: &[u8], b: &[u8]) {
        let fast = SsimWorkspace::new(width, height).mean_ssim(a, b);
        let exact = oracle(width, a, b);
        assert!((fast - exact).abs() < 1e-4, "{width} × {height}: {fast} for {exact}");
    }

    #[test]
    fn it_is_the_mean_of_the_exact_map() {
        for (width, height) in [(1, 1), (3, 2), (5, 40), (64, 48), (131, 77)] {
            let count = 3 * width * height;
            let (a, b) = (noise(1, count), noise(2, count));
            check(width, height, &a, &b);
            let mild: Vec<u8> = a.iter().zip(&b).map(|(a, b)| a / 8 * 7 + b / 8).collect();
            check(width, height, &a, &mild);
            let picture = structured(width, height);
            let shaken: Vec<u8> =
                picture.iter().zip(&b).map(|(p, n)| p.saturating_add(n / 16)).collect();
            check(width, height, &picture, &shaken);
            let shifted: Vec<u8> = picture.iter().map(|p| p.saturating_sub(9)).collect();
            check(width, height, &picture, &shifted);
        }
    }

    #[test]
    fn equal_pictures_have_similarity_one_and_order_does_not_matter() {
        let (a, b) = (structured(50, 30), noise(4, 4500));
        let mut workspace = SsimWorkspace::new(50, 30);
        assert!((workspace.mean_ssim(&a, &a) - 1.0).abs() < 1e-12, "equal pictures");
        let there = workspace.mean_ssim(&a, &b);
        let back = workspace.mean_ssim(&b, &a);
        assert_eq!(there.to_bits(), back.to_bits(), "{there} and {back}");
    }
}
