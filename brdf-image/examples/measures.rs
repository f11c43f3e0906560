//! Prints PSNR, SSIM, ꟻLIP and ΔE ITP of a shaded disc against copies with a shifted highlight.
//!
//! `cargo run -p brdf-image --example measures`
#![allow(clippy::print_stdout, reason = "an example")]

use brdf_image::{Film, Pixel, ToneMap, encode_png, image_errors};
use brdf_model::Rgb;

const SIDE: usize = 96;

fn main() -> Result<(), brdf_image::ImageError> {
    let reference = disc(0.0);
    let tone = ToneMap::exposed_for(&reference);
    println!(
        "exposure {:.2}, {} bytes as PNG",
        tone.exposure,
        encode_png(&tone.apply(&reference))?.len()
    );
    println!("{:>5} {:>8} {:>7} {:>7} {:>8}", "shift", "PSNR dB", "SSIM", "FLIP", "ΔE ITP");
    for shift in [0.01, 0.02, 0.05, 0.1] {
        let errors = image_errors(&reference, &disc(shift), tone.exposure);
        let psnr = errors.psnr_db.unwrap_or(f64::INFINITY);
        println!(
            "{shift:>5} {psnr:>8.1} {:>7.4} {:>7.4} {:>8.2}",
            errors.ssim, errors.flip, errors.delta_e_itp
        );
    }
    Ok(())
}

/// A red disc with a highlight, which is moved to the right by `shift` radii.
fn disc(shift: f64) -> Film {
    let place = |at: usize| (at as f64 + 0.5) / (0.5 * SIDE as f64) - 1.0;
    let pixels = (0..SIDE * SIDE).map(|at| {
        let (x, y) = (place(at % SIDE), place(at / SIDE));
        let height = 1.0 - x * x - y * y;
        if height < 0.0 {
            return Pixel::Background;
        }
        let highlight = (-30.0 * ((x - 0.3 - shift).powi(2) + (y + 0.3).powi(2))).exp();
        Pixel::Radiance(Rgb::new(0.5, 0.1, 0.1) * height.sqrt() + Rgb::splat(highlight), 1.0)
    });
    Film::new(SIDE, pixels.collect())
}
