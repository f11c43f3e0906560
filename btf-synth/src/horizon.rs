//! Shadows: how high the surface rises around each texel, and what light reaches it.

use rayon::prelude::*;

use crate::height_field::HeightField;
use crate::lights::{LANES, Lanes, Lights};

/// For each texel the steepest rise of the surface towards each light. A point between texels takes
/// the bilinear mean of these slopes and is lit by what stands steeper: shadows then end between
/// texels along smooth curves, where a mean of lit and unlit would blur them.
pub(crate) fn horizons(field: &HeightField, lights: &Lights) -> Vec<Lanes> {
    let flattest = lights.flattest();
    (0..field.width * field.height)
        .into_par_iter()
        .map_init(
            || vec![0.0; lights.azimuths.len()],
            |rises, texel| {
                for (rise, &azimuth) in rises.iter_mut().zip(&lights.azimuths) {
                    *rise = field.horizon(texel, azimuth, flattest);
                }
                std::array::from_fn(|lane| rises[lights.azimuth_of[lane]])
            },
        )
        .collect()
}

/// Irradiance at the centre of each texel: 1 under a light of unit irradiance along the normal.
pub(crate) fn direct_irradiance(
    field: &HeightField,
    lights: &Lights,
    horizons: &[Lanes],
) -> Vec<Lanes> {
    horizons
        .par_iter()
        .enumerate()
        .map(|(texel, horizon)| {
            let normal = normal(field.gradient(texel));
            let mut irradiance = [0.0; LANES];
            for lane in 0..LANES {
                let cos = normal[0] * lights.wi[0][lane]
                    + normal[1] * lights.wi[1][lane]
                    + normal[2] * lights.wi[2][lane];
                let is_lit = cos > 0.0 && lights.slope[lane] > horizon[lane];
                irradiance[lane] = if is_lit { cos } else { 0.0 };
            }
            irradiance
        })
        .collect()
}

/// The unit normal of a surface with these slopes along x and y.
pub(crate) fn normal([along_x, along_y]: [f32; 2]) -> [f32; 3] {
    let scale = 1.0 / (along_x * along_x + along_y * along_y + 1.0).sqrt();
    [-along_x * scale, -along_y * scale, scale]
}
