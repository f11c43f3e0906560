//! How near images are to those of a BTF.

use anyhow::anyhow;
use brdf_image::SsimWorkspace;
use brdf_io::Btf;
use btf_vq::colour::linear_to_srgb;
use btf_vq::{AngularGrid, BtfSource, Encoding, Taps};
use rayon::prelude::*;

use crate::progress::Progress;

/// How near images are.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub(super) struct Fidelity {
    /// Over all values in 8-bit sRGB, dB.
    pub(super) psnr: f64,
    /// Mean over images.
    pub(super) mssim: f64,
}

/// Where the directions of every image lie.
pub(super) fn all_taps(source: &Btf, grid: &AngularGrid) -> Vec<Taps> {
    let views = source.layout().views.iter();
    views.flat_map(|view| view.lights.iter().map(|wi| Taps::new(grid, *wi, view.wo))).collect()
}

/// A display value of 8 bits.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to a byte")]
pub(super) fn to_byte(value: f32, encoding: Encoding) -> u8 {
    let encoded = match encoding {
        Encoding::Srgb => value,
        Encoding::Linear => linear_to_srgb(value.max(0.0)),
    };
    (encoded * 255.0).round().clamp(0.0, 255.0) as u8
}

/// Texels as an image of bytes.
pub(super) fn to_bytes(texels: &[[f32; 3]], encoding: Encoding, rgb: &mut [u8]) {
    for (target, value) in rgb.as_chunks_mut::<3>().0.iter_mut().zip(texels) {
        *target = value.map(|v| to_byte(v, encoding));
    }
}

/// Compares every `step`-th image of a source with another, 8-bit RGB, that `decode` makes.
pub(super) fn compare(
    source: &Btf,
    step: usize,
    decode: &(dyn Fn(usize, &mut [u8]) + Sync),
    progress: &Progress,
) -> anyhow::Result<Fidelity> {
    let layout = source.layout();
    let values = 3 * layout.texel_count();
    let chosen: Vec<usize> = (0..layout.image_count()).step_by(step).collect();
    let start = || {
        let ssim = SsimWorkspace::new(layout.width, layout.height);
        (ssim, vec![0.0_f32; values], vec![0_u8; values], vec![0_u8; values])
    };
    let each: Result<Vec<(u64, f64)>, btf_vq::SourceError> = chosen
        .par_iter()
        .map_init(start, |(ssim, wide, reference, other), at| {
            source.read_image(*at, wide)?;
            for (byte, v) in reference.iter_mut().zip(&*wide) {
                *byte = to_byte(*v, layout.encoding);
            }
            decode(*at, other);
            let squares =
                reference.iter().zip(&*other).map(|(a, b)| u64::from(a.abs_diff(*b)).pow(2));
            let squares = squares.sum();
            progress.done(1);
            Ok((squares, ssim.mean_ssim(reference, other)))
        })
        .collect();
    let each = each.map_err(|e| anyhow!(e))?;
    let squares: u64 = each.iter().map(|e| e.0).sum();
    let (mse, mssim) = (
        squares as f64 / (values * each.len()) as f64,
        each.iter().map(|e| e.1).sum::<f64>() / each.len() as f64,
    );
    Ok(Fidelity { psnr: 10.0 * (255.0 * 255.0 / mse).log10(), mssim })
}
