//! GGX lobes under a sum of products: what the products change, and what is left where samples say nothing.

use brdf_model::{Brdf, GgxLobe, GgxLobes, Rgb};
use brdf_param::DirectionPair;

use crate::error::SplineError;

/// Most lobes of a base: what three bits count.
pub(crate) const LOBES_MAX: usize = 7;

/// Smallest and largest α of a base's lobes: what single precision can do.
pub(crate) const ALPHAS: [f64; 2] = [1e-4, 10.0];

/// Returns the base as a stream holds it, in single precision; of one channel, its luminance.
pub(crate) fn stored(base: &GgxLobes, channels: usize) -> Result<GgxLobes, SplineError> {
    let lobes = base.lobes.len();
    if lobes == 0 || lobes > LOBES_MAX {
        return Err(SplineError::Lobes { lobes, max: LOBES_MAX });
    }
    let mut base = base.clone();
    for lobe in &mut base.lobes {
        lobe.alpha = lobe.alpha.clamp(ALPHAS[0], ALPHAS[1]);
    }
    Ok(from_numbers(&numbers(&base, channels), lobes, channels))
}

/// Numbers of a base of so many lobes.
pub(crate) fn length(lobes: usize, channels: usize) -> usize {
    2 * channels + lobes * (channels + 2)
}

/// Diffuse base and sheen, then f0, f90 and α of each lobe.
#[expect(clippy::cast_possible_truncation, reason = "what stands in a stream is f32")]
pub(crate) fn numbers(base: &GgxLobes, channels: usize) -> Vec<f32> {
    let colour = |rgb: Rgb| match channels {
        1 => vec![rgb.luminance() as f32],
        _ => rgb.channels().map(|v| v as f32).to_vec(),
    };
    let mut numbers = [colour(base.diffuse), colour(base.sheen)].concat();
    for lobe in &base.lobes {
        numbers.extend(colour(lobe.f0));
        numbers.extend([lobe.f90 as f32, lobe.alpha as f32]);
    }
    numbers
}

/// The base of [`length`] numbers.
pub(crate) fn from_numbers(numbers: &[f32], lobes: usize, channels: usize) -> GgxLobes {
    let colour = |numbers: &[f32]| match numbers {
        [r, g, b] => Rgb::new((*r).into(), (*g).into(), (*b).into()),
        other => Rgb::splat(other.first().copied().unwrap_or(0.0).into()),
    };
    let (head, rest) = numbers.split_at(2 * channels);
    let lobe = |numbers: &[f32]| GgxLobe {
        f0: colour(&numbers[..channels]),
        f90: numbers[channels].into(),
        alpha: numbers[channels + 1].into(),
    };
    GgxLobes {
        diffuse: colour(&head[..channels]),
        sheen: colour(&head[channels..]),
        lobes: rest.chunks_exact(channels + 2).take(lobes).map(lobe).collect(),
    }
}

/// Value of each channel of a base, if there is one, at a pair of directions within its domain.
pub(crate) fn value_of(base: Option<&GgxLobes>, pair: &DirectionPair) -> Option<[f64; 3]> {
    base.map(|base| base.eval(pair).channels())
}
