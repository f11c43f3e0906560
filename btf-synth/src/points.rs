//! Point sets that are the same for every texel.

/// The `index`th of `count` points of the unit square, evenly spread along both axes: centres of
/// `count` intervals along one, the van der Corput sequence along the other.
///
/// Source: J. M. Hammersley, "Monte Carlo Methods for Solving Multivariable Problems", Annals of the
/// New York Academy of Sciences 86, 1960.
pub(crate) fn hammersley(index: u32, count: u32) -> [f32; 2] {
    let along = (index as f32 + 0.5) / count as f32;
    // The bits of the index mirrored at the binary point, then moved to the middle of the interval
    // that it stands for among `count`.
    let mirrored = f64::from(index.reverse_bits()) / f64::from(2_u32.pow(16)).powi(2);
    #[expect(clippy::cast_possible_truncation, reason = "a position in a texel")]
    let across = (mirrored + 0.5 / f64::from(count.next_power_of_two())) as f32;
    [along, across]
}

/// The `index`th of `count` directions around z, with density in proportion to the cosine.
pub(crate) fn cosine_direction(index: u32, count: u32) -> [f32; 3] {
    let [along, across] = hammersley(index, count);
    let radius = along.sqrt();
    let (sin, cos) = (std::f32::consts::TAU * across).sin_cos();
    [radius * cos, radius * sin, (1.0 - along).sqrt()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sixteen_points_fill_sixteen_strata() {
        let mut hit = [false; 16];
        for index in 0..16 {
            let [x, y] = hammersley(index, 16).map(|v| (v * 4.0).floor());
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 3")]
            let stratum = (4.0 * y + x) as usize;
            hit[stratum] = true;
        }
        assert_eq!(hit, [true; 16]);
    }

    #[test]
    fn the_mean_cosine_is_two_thirds() {
        let mean = (0..64).map(|i| cosine_direction(i, 64)[2]).sum::<f32>() / 64.0;
        assert!((mean - 2.0 / 3.0).abs() < 1e-3, "{mean}");
    }
}
