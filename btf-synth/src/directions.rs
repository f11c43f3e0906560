//! The 81 directions of the UBO2003 measurements, which views and lights share.

/// Number of directions of the table, which are the lights of each view as well as the views.
pub const LIGHT_COUNT: usize = 81;

/// Polar angle and number of directions of each ring. The pole comes first; every ring starts at
/// azimuth 0 and runs counterclockwise in equal steps.
const RINGS: [(u32, u32); 6] = [(0, 1), (15, 6), (30, 12), (45, 18), (60, 20), (75, 24)];

/// Returns the polar angle from the normal and the azimuth of all 81 directions, in whole degrees.
///
/// Source: the file names of the UBO2003 measurements (M. Sattler, R. Sarlette, R. Klein,
/// "Efficient and Realistic Visualization of Cloth", EGSR 2003).
///
/// ```
/// let directions = btf_synth::ubo_directions();
/// assert_eq!((directions.len(), directions[0]), (81, (0, 0)));
/// ```
pub fn ubo_directions() -> Vec<(u32, u32)> {
    RINGS
        .iter()
        .flat_map(|&(theta, count)| (0..count).map(move |step| (theta, step * (360 / count))))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rings_start_where_the_file_names_say() {
        let table = ubo_directions();
        assert_eq!(table.len(), LIGHT_COUNT);
        assert_eq!(table[..3], [(0, 0), (15, 0), (15, 60)]);
        assert_eq!([table[7], table[19], table[37]], [(30, 0), (45, 0), (60, 0)]);
        assert_eq!([table[57], table[80]], [(75, 0), (75, 345)]);
    }
}
