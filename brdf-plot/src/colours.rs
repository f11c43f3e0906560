//! Colours that stay apart in greyscale.

use brdf_study::TestFunction;
use plotters::style::RGBColor;
use plotters::style::colors::colormaps::{ColorMap as _, ViridisRGB};

/// Text and axes.
pub(crate) const INK: RGBColor = RGBColor(39, 39, 42);
/// Grid lines.
pub(crate) const FAINT: RGBColor = RGBColor(212, 212, 216);
/// Where there is no data.
pub(crate) const NO_DATA: [u8; 4] = [228, 228, 231, 255];

/// Isolines of the test functions, as in the paper but for the Fresnel effect, which is white there.
pub(crate) const TEST_FUNCTIONS: [(TestFunction, [u8; 3]); 3] = [
    (TestFunction::Specular, [200, 30, 30]),
    (TestFunction::Fresnel, [20, 20, 20]),
    (TestFunction::Grazing, [40, 90, 220]),
];

/// Colours of series in order, from dark to light and back, so that neighbours differ in lightness.
const SERIES: [RGBColor; 8] = [
    RGBColor(30, 58, 138),
    RGBColor(234, 88, 12),
    RGBColor(6, 95, 70),
    RGBColor(217, 70, 239),
    RGBColor(0, 0, 0),
    RGBColor(101, 163, 13),
    RGBColor(159, 18, 57),
    RGBColor(14, 165, 233),
];

pub(crate) fn series(index: usize) -> RGBColor {
    SERIES[index % SERIES.len()]
}

/// The colour of a share in [0, 1]: viridis, whose lightness rises evenly.
pub(crate) fn heat(share: f64) -> [u8; 4] {
    #[expect(clippy::cast_possible_truncation, reason = "a share of a colour scale")]
    let RGBColor(r, g, b) = ViridisRGB.get_color(share.clamp(0.0, 1.0) as f32);
    [r, g, b, 255]
}
