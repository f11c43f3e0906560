//! Numbers over a surface.

use glam::DVec2;

/// A map of weights over texture coordinates; texel (i, j) has its centre at (i + ½, j + ½) / size.
///
/// ```
/// use glam::DVec2;
///
/// let map = brdf_paint::CoefficientMap::constant(4, true, 0.5);
/// assert!((map.at(DVec2::new(0.3, 0.9)) - 0.5).abs() < 1e-6);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct CoefficientMap {
    /// Texels a side.
    pub size: usize,
    /// Whether u = 0 and u = 1 are one place.
    pub wraps: bool,
    /// Row by row from v = 0, 0 and above.
    pub values: Vec<f32>,
}

/// The texels around a place and their shares.
pub(crate) type MapTaps = [(usize, f32); 4];

impl CoefficientMap {
    /// Returns a map with the same value everywhere.
    pub fn constant(size: usize, wraps: bool, value: f32) -> Self {
        Self { size, wraps, values: vec![value; size * size] }
    }

    /// Returns the value at a place, linear between texels.
    pub fn at(&self, place: DVec2) -> f32 {
        read(&self.values, &taps(self.size, self.wraps, place))
    }

    /// Gives texels that are not known what lies around them: means of halved maps, upwards from the
    /// coarsest (push and pull).
    pub(crate) fn fill(&mut self, known: &[bool]) {
        fill(&mut self.values, known, self.size, self.wraps);
    }
}

/// The value between the texels around a place.
pub(crate) fn read(values: &[f32], taps: &MapTaps) -> f32 {
    taps.iter().map(|(texel, share)| share * values[*texel]).sum()
}

/// Texels around a place.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_possible_wrap,
    reason = "places are clamped to the map"
)]
pub(crate) fn taps(size: usize, wraps: bool, place: DVec2) -> MapTaps {
    let position = (place.clamp(DVec2::ZERO, DVec2::ONE) * size as f64) - 0.5;
    let low = position.floor();
    let part = (position - low).as_vec2();
    let side = |at: i64, wraps: bool| {
        if wraps {
            at.rem_euclid(size as i64) as usize
        } else {
            at.clamp(0, size as i64 - 1) as usize
        }
    };
    let columns = [0, 1].map(|step| side(low.x as i64 + step, wraps));
    let rows = [0, 1].map(|step| side(low.y as i64 + step, false) * size);
    [
        (rows[0] + columns[0], (1.0 - part.x) * (1.0 - part.y)),
        (rows[0] + columns[1], part.x * (1.0 - part.y)),
        (rows[1] + columns[0], (1.0 - part.x) * part.y),
        (rows[1] + columns[1], part.x * part.y),
    ]
}

/// The texel whose centre is nearest to a place.
pub(crate) fn nearest(size: usize, wraps: bool, place: DVec2) -> usize {
    let around = taps(size, wraps, place).into_iter();
    around.max_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(texel, _)| texel)
}

fn fill(values: &mut [f32], known: &[bool], size: usize, wraps: bool) {
    if known.iter().all(|k| *k) || !known.iter().any(|k| *k) {
        return;
    }
    let half = size.div_ceil(2);
    let (mut sums, mut counts) = (vec![0.0_f32; half * half], vec![0.0_f32; half * half]);
    for (texel, value) in values.iter().enumerate().filter(|(texel, _)| known[*texel]) {
        let parent = texel / size / 2 * half + texel % size / 2;
        sums[parent] += value;
        counts[parent] += 1.0;
    }
    let coarse_known: Vec<bool> = counts.iter().map(|count| *count > 0.0).collect();
    let mut coarse: Vec<f32> = sums.iter().zip(&counts).map(|(s, c)| s / c.max(1.0)).collect();
    fill(&mut coarse, &coarse_known, half, wraps);
    let centre = |at: usize| (at as f64 + 0.5) / (2 * half) as f64;
    for (texel, value) in values.iter_mut().enumerate().filter(|(texel, _)| !known[*texel]) {
        let place = DVec2::new(centre(texel % size), centre(texel / size));
        *value = read(&coarse, &taps(half, wraps, place));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holes_take_what_lies_around_them() {
        let (size, mut map) = (9, CoefficientMap::constant(9, false, 0.0));
        let known: Vec<bool> = (0..81).map(|texel| texel % size < 2 || texel % size > 6).collect();
        for (texel, value) in map.values.iter_mut().enumerate() {
            *value = if texel % size > 6 { 1.0 } else { 0.0 };
        }
        map.fill(&known);
        let row = &map.values[4 * size..5 * size];
        assert!(row.windows(2).all(|pair| pair[0] <= pair[1] + 1e-6), "{row:?}");
        assert!(row[4] > 0.2 && row[4] < 0.8, "between: {row:?}");
    }

    #[test]
    fn a_map_that_wraps_has_no_seam() {
        let mut map = CoefficientMap::constant(8, true, 0.0);
        map.values.iter_mut().enumerate().for_each(|(texel, v)| *v = (texel % 8) as f32);
        let left = map.at(DVec2::new(1e-9, 0.5));
        let right = map.at(DVec2::new(1.0 - 1e-9, 0.5));
        assert!((left - right).abs() < 1e-5 && (left - 3.5).abs() < 1e-5, "{left} {right}");
    }
}
