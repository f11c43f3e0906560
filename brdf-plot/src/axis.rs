//! Axes whose labels stand where a reader expects them.

use std::ops::Range;

use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use crate::colours::INK;
use crate::curves::short;
use crate::error::{PlotError, drawing};

/// An axis with labels at chosen places.
pub(crate) struct Ticked {
    line: RangedCoordf64,
    ticks: Vec<f64>,
}

impl Ticked {
    pub(crate) fn new(range: &Range<f64>, ticks: Vec<f64>) -> Self {
        Self { line: range.clone().into(), ticks }
    }

    /// From 0 to the largest value of a coordinate: right angles in thirds, others in even steps.
    pub(crate) fn up_to(largest: f64) -> Self {
        let range = 0.0..largest;
        let ticks = if (largest - 90.0).abs() < 1e-9 {
            vec![0.0, 30.0, 60.0, 90.0]
        } else {
            RangedCoordf64::from(range.clone()).key_points(4)
        };
        Self::new(&range, ticks)
    }
}

impl Ranged for Ticked {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        self.line.map(value, limit)
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if hint.weight().allow_light_points() { Vec::new() } else { self.ticks.clone() }
    }

    fn range(&self) -> Range<f64> {
        self.line.range()
    }
}

/// Draws two axes with their labels and names, without a mesh.
pub(crate) fn draw_axes(
    chart: &mut ChartContext<'_, SVGBackend<'_>, Cartesian2d<Ticked, Ticked>>,
    x: &str,
    y: &str,
) -> Result<(), PlotError> {
    chart
        .configure_mesh()
        .disable_mesh()
        .axis_style(INK)
        .label_style(("sans-serif", 11).into_font().color(&INK))
        .x_labels(4)
        .y_labels(4)
        .x_label_formatter(&|x| short(*x))
        .y_label_formatter(&|y| short(*y))
        .x_desc(x)
        .y_desc(y)
        .draw()
        .map_err(|e| drawing(&e))
}

/// The most labels on an axis.
pub(crate) const TICKS: usize = 11;

pub(crate) fn evenly(range: &Range<f64>) -> Vec<f64> {
    RangedCoordf64::from(range.clone()).key_points(TICKS)
}

/// Whole numbers within a range.
pub(crate) fn whole(range: &Range<f64>) -> impl Iterator<Item = f64> + use<> {
    let (first, last) = (range.start.ceil(), range.end.floor());
    std::iter::successors(Some(first), |x| Some(x + 1.0)).take_while(move |x| *x <= last)
}

#[cfg(test)]
mod tests {
    use plotters::coord::ranged1d::BoldPoints;

    use super::*;

    #[test]
    fn a_right_angle_has_labels_at_its_thirds() {
        assert_eq!(Ticked::up_to(90.0).key_points(BoldPoints(4)), [0.0, 30.0, 60.0, 90.0]);
        assert_eq!(Ticked::up_to(1.0).key_points(BoldPoints(4)), [0.0, 0.5, 1.0]);
    }
}
