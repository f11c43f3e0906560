//! The maps of a surface, ready to be lit.

use crate::{Map, SynthError};

/// The longest side of a tile that is synthesized: a view of all lights then takes 1 GB.
const LARGEST_SIDE: usize = 1024;

/// Heights, albedo and roughness of a tile that repeats; row-major, the first row has the largest y. Texels are
/// square.
///
/// ```
/// use btf_synth::SurfaceMaps;
///
/// let heights = vec![0.0, 0.1, 0.0, 0.3];
/// let maps = SurfaceMaps::new(2, 2, heights, vec![[0.5; 3]; 4], vec![0.6; 4])?;
/// assert!((maps.heights()[3] - 0.2).abs() < 1e-6, "over the mean");
/// # Ok::<(), btf_synth::SynthError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceMaps {
    width: usize,
    height: usize,
    heights: Vec<f32>,
    albedo: Vec<[f32; 3]>,
    roughness: Vec<f32>,
}

impl SurfaceMaps {
    /// Returns maps of heights in units of the tile's width, of which the mean is subtracted; of linear albedo in
    /// [0, 1]; and of roughness in [0, 1].
    ///
    /// # Errors
    ///
    /// [`SynthError::Size`], [`SynthError::Length`], or [`SynthError::Value`] for a value out of
    /// range or not finite.
    pub fn new(
        width: usize,
        height: usize,
        mut heights: Vec<f32>,
        albedo: Vec<[f32; 3]>,
        roughness: Vec<f32>,
    ) -> Result<Self, SynthError> {
        let sides = 1..=LARGEST_SIDE;
        if !sides.contains(&width) || !sides.contains(&height) {
            return Err(SynthError::Size { width, height, largest: LARGEST_SIDE });
        }
        let expected = width * height;
        let lengths =
            [("heights", heights.len()), ("albedo", albedo.len()), ("roughness", roughness.len())];
        if let Some(&(what, found)) = lengths.iter().find(|(_, found)| *found != expected) {
            return Err(SynthError::Length { what, found, expected });
        }
        check("heights", heights.iter().copied(), "a number from -10 to 10", -10.0..=10.0)?;
        let unit = "a number from 0 to 1";
        for channel in 0..3 {
            check("albedo", albedo.iter().map(|rgb| rgb[channel]), unit, 0.0..=1.0)?;
        }
        check("roughness", roughness.iter().copied(), unit, 0.0..=1.0)?;
        let mean = mean(&heights);
        heights.iter_mut().for_each(|height| *height -= mean);
        Ok(Self { width, height, heights, albedo, roughness })
    }

    /// Returns maps made of maps of any sizes, each resampled whole to `size`² texels; heights in units of the
    /// tile's width, albedo linear.
    ///
    /// # Errors
    ///
    /// As [`SurfaceMaps::new`].
    pub fn from_maps(
        size: usize,
        heights: &Map,
        albedo: &[Map; 3],
        roughness: &Map,
    ) -> Result<Self, SynthError> {
        if !(1..=LARGEST_SIDE).contains(&size) {
            return Err(SynthError::Size { width: size, height: size, largest: LARGEST_SIDE });
        }
        let filtered = |map: &Map| Ok(map.box_filtered(size, size)?.values().to_vec());
        let [red, green, blue] = [&albedo[0], &albedo[1], &albedo[2]].map(filtered);
        let (red, green, blue) = (red?, green?, blue?);
        let albedo = (0..size * size).map(|i| [red[i], green[i], blue[i]]).collect();
        Self::new(size, size, filtered(heights)?, albedo, filtered(roughness)?)
    }

    /// Returns the number of texels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Returns the number of rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Returns the heights over their mean, in units of the tile's width.
    pub fn heights(&self) -> &[f32] {
        &self.heights
    }

    /// Returns the linear albedo of each texel.
    pub fn albedo(&self) -> &[[f32; 3]] {
        &self.albedo
    }

    /// Returns the roughness of each texel in [0, 1], the square root of a microfacet distribution's alpha.
    pub fn roughness(&self) -> &[f32] {
        &self.roughness
    }
}

fn check(
    what: &'static str,
    values: impl Iterator<Item = f32>,
    expected: &'static str,
    range: std::ops::RangeInclusive<f32>,
) -> Result<(), SynthError> {
    for (texel, value) in values.enumerate() {
        // NaN is in no range.
        if !range.contains(&value) {
            return Err(SynthError::Value { what, texel, value, expected });
        }
    }
    Ok(())
}

#[expect(clippy::cast_possible_truncation, reason = "the mean of f32 values, taken off them")]
fn mean(values: &[f32]) -> f32 {
    (values.iter().map(|&value| f64::from(value)).sum::<f64>() / values.len() as f64) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_makes_no_surface_is_refused() {
        let new = |heights: Vec<f32>, albedo: f32, roughness: f32| {
            SurfaceMaps::new(2, 1, heights, vec![[albedo; 3]; 2], vec![roughness; 2])
        };
        assert_eq!(new(vec![1.0, 2.0], 0.5, 0.5).unwrap().heights(), [-0.5, 0.5]);
        assert!(matches!(new(vec![1.0], 0.5, 0.5), Err(SynthError::Length { .. })));
        let refused = [
            (new(vec![1.0, f32::NAN], 0.5, 0.5), "heights"),
            (new(vec![1.0, 2.0], 1.5, 0.5), "albedo"),
            (new(vec![1.0, 2.0], f32::NAN, 0.5), "albedo"),
            (new(vec![1.0, 2.0], 0.5, -0.1), "roughness"),
        ];
        for (result, name) in refused {
            assert!(
                matches!(result, Err(SynthError::Value { what, .. }) if what == name),
                "{name}"
            );
        }
        let empty = SurfaceMaps::new(0, 1, vec![], vec![], vec![]);
        assert!(matches!(empty, Err(SynthError::Size { .. })));
    }
}
