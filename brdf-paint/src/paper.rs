//! Material maps as published: one product after another.
//!
//! Source: Jaroszkiewicz and McCool 2003, section 4.2, with log(a + Δ) where the residual Δ becomes 0.

use brdf_job::Job;

use crate::coefficient_map::{CoefficientMap, read};
use crate::layout::{Layout, Part, by_channel};
use crate::{PaintError, PaintParams, PaintSamples};

/// Fits a product to what is left, scales it by a map until it is nowhere above a sample of any view, and
/// goes on with the rest (Eq. 17–19).
#[expect(clippy::cast_possible_truncation, reason = "pictures are f32")]
pub(crate) fn decompose(
    layout: &Layout,
    samples: &PaintSamples,
    params: &PaintParams,
    job: &Job<'_>,
) -> Result<Vec<Part>, PaintError> {
    job.begin("fitting products", params.products as u64);
    let mut rest = by_channel(&samples.values);
    let mut workspace = layout.inverted.workspace(3);
    let known = layout.touched(params.map_size);
    let mut parts = Vec::with_capacity(params.products);
    for product in 0..params.products {
        job.check()?;
        job.rename(format!("product {}", product + 1));
        layout.inverted.solve(&rest, &layout.maps, &mut workspace);
        let solution = workspace.solution().to_vec();
        let values = layout.values(&solution);
        let mut map = CoefficientMap::constant(params.map_size, params.wraps, 1.0);
        for (at, value) in values.iter().enumerate() {
            let mut most = 1.0_f32;
            for (channel, fitted) in value.iter().enumerate() {
                let left = rest[channel][at] as f32;
                if left < *fitted {
                    most = most.min(left / fitted);
                }
            }
            // Every texel that the sample reads, so that what it reads is no more.
            for (texel, share) in &layout.taps[at] {
                if *share > 0.0 {
                    map.values[*texel] = map.values[*texel].min(most);
                }
            }
        }
        map.fill(&known);
        for (at, value) in values.iter().enumerate() {
            let share = read(&map.values, &layout.taps[at]);
            for (channel, fitted) in value.iter().enumerate() {
                let left = &mut rest[channel][at];
                *left = (*left - f64::from(share * fitted)).max(0.0);
            }
        }
        parts.push(Part { solution, coefficients: map.values });
        job.advance(1);
    }
    Ok(parts)
}
