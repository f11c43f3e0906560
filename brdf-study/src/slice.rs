//! Slices of an isotropic BRDF at a fixed azimuth, and the alignment of their isolines with the axes.

use std::f64::consts::FRAC_PI_2;

use brdf_model::Brdf;
use brdf_param::{DirectionPair, Parametrization};
use serde::Serialize;

/// A slice of a material: luminance over the two radial coordinates of a parametrization, at one azimuth
/// between the points.
///
/// ```
/// use brdf_model::Preset;
/// use brdf_param::Parametrization;
/// use brdf_study::Slice;
///
/// let plastic = Preset::find("plastic").expect("a preset").brdf();
/// let slice = Slice::sample(&plastic, Parametrization::HalfDifference, 1.57, 16);
/// assert_eq!(slice.values.len(), 16 * 16);
/// let (labels, largest) = Slice::axes(slice.parametrization);
/// assert_eq!((labels[0], largest), ("theta_h (°)", 90.0));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Slice {
    /// Parametrization whose radial coordinates are the axes.
    pub parametrization: Parametrization,
    /// Azimuth of the second point about the first, radians.
    pub azimuth: f64,
    /// Number of cells along each side.
    pub size: usize,
    /// Luminance in sr⁻¹ at cell centres, row by row from the smallest second coordinate; `None`
    /// where a direction lies below the horizon or the material has no data.
    pub values: Vec<Option<f64>>,
}

impl Slice {
    /// Returns the slice of a material at an azimuth in radians, with `size` × `size` cells over the ranges
    /// of both coordinates.
    pub fn sample(
        brdf: &dyn Brdf,
        parametrization: Parametrization,
        azimuth: f64,
        size: usize,
    ) -> Self {
        let values = (0..size * size)
            .map(|index| {
                let [u, v] = [index % size, index / size].map(|i| centre(i, size));
                let pair = pair_at(parametrization, [u, v], azimuth)?;
                let lit = pair.wi.z > 0.0 && pair.wo.z > 0.0 && brdf.has_data(&pair);
                lit.then(|| brdf.eval(&pair).luminance())
            })
            .collect();
        Self { parametrization, azimuth, size, values }
    }

    /// Returns the labels of the two axes, with units, and the largest value of both.
    pub fn axes(parametrization: Parametrization) -> ([&'static str; 2], f64) {
        match parametrization {
            Parametrization::Standard => (["theta_i (°)", "theta_o (°)"], 90.0),
            Parametrization::HalfDifference => (["theta_h (°)", "theta_d (°)"], 90.0),
            Parametrization::KautzMcCool => (["h_radius", "d_radius"], 1.0),
            Parametrization::Orthographic | Parametrization::Hybrid => {
                (["h_length", "k_length"], 1.0)
            }
            Parametrization::OnionSlice => (["theta_o (°)", "theta_i (°)"], 90.0),
        }
    }
}

fn centre(index: usize, size: usize) -> f64 {
    (index as f64 + 0.5) / size as f64
}

/// The pair at shares [0, 1] of both radial coordinates' ranges.
pub(crate) fn pair_at(
    parametrization: Parametrization,
    unit: [f64; 2],
    azimuth: f64,
) -> Option<DirectionPair> {
    let [first, second] = unit.map(|share| polar_angle_of(parametrization, share));
    parametrization.isotropic_pair(first, second, azimuth)
}

/// The polar angle at a share of a radial coordinate's range.
fn polar_angle_of(parametrization: Parametrization, share: f64) -> f64 {
    match parametrization {
        Parametrization::Standard
        | Parametrization::HalfDifference
        | Parametrization::OnionSlice => FRAC_PI_2 * share,
        Parametrization::KautzMcCool => 2.0 * share.atan(),
        Parametrization::Orthographic | Parametrization::Hybrid => share.min(1.0).asin(),
    }
}

/// The share of a radial coordinate's range at a point of the hemisphere.
pub(crate) fn share_of(parametrization: Parametrization, point: glam::DVec3) -> f64 {
    let radius = point.truncate().length();
    match parametrization {
        Parametrization::Standard
        | Parametrization::HalfDifference
        | Parametrization::OnionSlice => brdf_param::polar_angle(point) / FRAC_PI_2,
        Parametrization::KautzMcCool => radius / (1.0 + point.z),
        Parametrization::Orthographic | Parametrization::Hybrid => radius,
    }
}

/// The alignment of isolines with the axes: shares of the squared gradient of ln(1 + 100 f), over cells whose
/// neighbours have data.
///
/// Coordinates are scaled to [0, 1], the azimuth to half turns.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SliceAlignment {
    /// Share across the axes, Σ min(gu², gv²) / Σ (gu² + gv²) within slices: 0 where every isoline runs along
    /// an axis, ½ where all are diagonal.
    pub across_axes: f64,
    /// Share along the azimuth: 0 where all slices are alike.
    pub along_azimuth: f64,
}

/// Cells of a slice along a side, and slices over half a turn.
const SLICE_SIZE: usize = 32;
const SLICES: usize = 13;
/// ln(1 + 100 f) is linear for dark and logarithmic for bright values, like isolines that a reader
/// would draw.
const GAIN: f64 = 100.0;

/// Returns the alignment of a material's isolines with the axes of a parametrization.
pub fn alignment(brdf: &dyn Brdf, parametrization: Parametrization) -> SliceAlignment {
    let slices: Vec<Vec<Option<f64>>> = (0..SLICES)
        .map(|index| {
            let azimuth = std::f64::consts::PI * unit(index, SLICES - 1);
            let slice = Slice::sample(brdf, parametrization, azimuth, SLICE_SIZE);
            slice.values.into_iter().map(|v| v.map(|f| (GAIN * f).ln_1p())).collect()
        })
        .collect();
    let (mut across, mut within, mut along) = (0.0, 0.0, 0.0);
    for (index, slice) in slices.iter().enumerate() {
        for cell in 0..slice.len() {
            let (column, row) = (cell % SLICE_SIZE, cell / SLICE_SIZE);
            let Some(value) = slice[cell] else { continue };
            let right = (column + 1 < SLICE_SIZE).then(|| slice[cell + 1]).flatten();
            let above = (row + 1 < SLICE_SIZE).then(|| slice[cell + SLICE_SIZE]).flatten();
            if let (Some(right), Some(above)) = (right, above) {
                let [gu, gv] = [right, above].map(|next| {
                    let step = (next - value) * unit(SLICE_SIZE, 1);
                    step * step
                });
                across += gu.min(gv);
                within += gu + gv;
            }
            if let Some(next) = slices.get(index + 1).and_then(|slice| slice[cell]) {
                along += ((next - value) * unit(SLICES - 1, 1)).powi(2);
            }
        }
    }
    let share = |part: f64, whole: f64| if whole > 0.0 { part / whole } else { 0.0 };
    SliceAlignment {
        across_axes: share(across, within),
        along_azimuth: share(along, within + along),
    }
}

fn unit(index: usize, count: usize) -> f64 {
    index as f64 / count as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TestFunction;

    #[test]
    fn gloss_is_aligned_where_the_paper_says_so() {
        let across = |p| alignment(&TestFunction::Specular, p).across_axes;
        for aligned in [Parametrization::Orthographic, Parametrization::Hybrid] {
            assert!(across(aligned) < 1e-9, "{aligned:?}: {}", across(aligned));
        }
        assert!(across(Parametrization::HalfDifference) > 0.05);
    }

    #[test]
    fn fresnel_is_aligned_with_half_difference_and_hybrid() {
        let across = |p| alignment(&TestFunction::Fresnel, p).across_axes;
        for aligned in [Parametrization::HalfDifference, Parametrization::Hybrid] {
            assert!(across(aligned) < 1e-9, "{aligned:?}: {}", across(aligned));
        }
        assert!(across(Parametrization::Orthographic) > 0.01);
    }

    #[test]
    fn shares_and_polar_angles_are_inverse() {
        for parametrization in crate::STUDIED {
            for share in [0.0, 0.2, 0.77, 1.0] {
                let theta = polar_angle_of(parametrization, share);
                let back = share_of(parametrization, brdf_param::spherical_direction(theta, 0.4));
                assert!((back - share).abs() < 1e-12, "{parametrization:?}: {back} for {share}");
            }
        }
    }
}
