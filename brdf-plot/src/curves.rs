//! Curves over an axis: errors against ranks, spectra.

use std::ops::Range;

use plotters::coord::Shift;
use plotters::prelude::*;

use crate::axis::{TICKS, Ticked, evenly, whole};
use crate::colours::{FAINT, INK, series};
use crate::error::{PlotError, drawing};
use crate::plot::{Plot, on_sheet};

/// The division of an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scale {
    /// Evenly.
    #[default]
    Linear,
    /// By factors of ten; values that are not positive are left out.
    Log,
}

/// Points joined by a line, with a label.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Text in the legend.
    pub label: String,
    /// x and y of each point.
    pub points: Vec<(f64, f64)>,
}

impl Series {
    /// Returns a series of points with a label.
    pub fn new(label: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self { label: label.into(), points }
    }
}

/// A panel of series over common axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curves {
    /// Title above the panel.
    pub title: String,
    /// Label of the x axis, with the unit.
    pub x: String,
    /// Label of the y axis, with the unit.
    pub y: String,
    /// Division of the y axis.
    pub y_scale: Scale,
    /// Series that are drawn; each has a marker of its own.
    pub series: Vec<Series>,
}

const PANEL: (u32, u32) = (420, 320);

/// Plots panels of curves, `columns` side by side.
///
/// ```
/// use brdf_plot::{Curves, PlotError, Series, plot_curves};
///
/// let line = Curves {
///     title: "a straight line".to_owned(),
///     series: vec![Series::new("y = x", vec![(0.0, 0.0), (1.0, 1.0)])],
///     ..Curves::default()
/// };
/// assert!(plot_curves(&[line], 1)?.svg().contains("a straight line"));
/// assert!(matches!(plot_curves(&[Curves::default()], 1), Err(PlotError::Nothing { .. })));
/// # Ok::<(), PlotError>(())
/// ```
///
/// # Errors
///
/// [`PlotError::Nothing`] without a point that can be shown; [`PlotError::Drawing`].
pub fn plot_curves(panels: &[Curves], columns: usize) -> Result<Plot, PlotError> {
    let columns = columns.clamp(1, panels.len().max(1));
    let rows = panels.len().div_ceil(columns);
    let wide = |count: usize, side: u32| u32::try_from(count).unwrap_or(1) * side;
    let size = (wide(columns, PANEL.0), wide(rows, PANEL.1));
    on_sheet(size, |sheet, _| {
        let areas = sheet.split_evenly((rows, columns));
        panels.iter().zip(&areas).try_for_each(|(panel, area)| panel.draw(area))
    })
}

impl Curves {
    /// The value of y on the axis, where it has a place there.
    fn place(&self, y: f64) -> Option<f64> {
        match self.y_scale {
            Scale::Linear => y.is_finite().then_some(y),
            Scale::Log => (y > 0.0 && y.is_finite()).then(|| y.log10()),
        }
    }

    /// Places of labels on the x axis: whole numbers where all points stand on a few of them, as counts do.
    fn ticks_across(&self, range: &Range<f64>) -> Vec<f64> {
        let is_whole = |x: f64| (x - x.round()).abs() < 1e-9;
        let all_whole = self.series.iter().flat_map(|s| &s.points).all(|point| is_whole(point.0));
        let even = evenly(range);
        if all_whole && even.iter().any(|x| !is_whole(*x)) {
            return whole(range).collect();
        }
        even
    }

    /// Places of labels on the y axis; on a logarithm powers of ten, with twice and five times them where there is room.
    fn ticks_along(&self, range: &Range<f64>) -> Vec<f64> {
        if self.y_scale == Scale::Linear {
            return evenly(range);
        }
        let decades = range.end - range.start;
        let between: &[f64] = if decades > 3.0 { &[1.0] } else { &[1.0, 2.0, 5.0] };
        let powers: Vec<f64> = whole(&(range.start - 1.0..range.end)).collect();
        let ticks: Vec<f64> = powers
            .iter()
            .step_by(powers.len().div_ceil(TICKS).max(1))
            .flat_map(|power| between.iter().map(move |digit| power + digit.log10()))
            .filter(|tick| range.contains(tick))
            .collect();
        // Within one decade there may be none.
        if ticks.len() < 2 { evenly(range) } else { ticks }
    }

    fn draw(&self, area: &DrawingArea<SVGBackend<'_>, Shift>) -> Result<(), PlotError> {
        let placed: Vec<Vec<(f64, f64)>> = self
            .series
            .iter()
            .map(|s| s.points.iter().filter_map(|&(x, y)| Some((x, self.place(y)?))).collect())
            .collect();
        let all = || placed.iter().flatten();
        if all().next().is_none() {
            return Err(PlotError::Nothing { what: "no point can be shown" });
        }
        let range = |pick: fn(&(f64, f64)) -> f64| {
            let (low, high) = all()
                .map(pick)
                .fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(v), high.max(v)));
            // A single value stands in the middle of its neighbourhood.
            let margin = if high > low { 0.04 * (high - low) } else { 0.5 };
            (low - margin)..(high + margin)
        };
        let (across, mut along) = (range(|p| p.0), range(|p| p.1));
        if self.series.len() > 1 {
            // Room for the legend.
            along.end += 0.11 * legend_rows(self.series.len()) * (along.end - along.start);
        }
        let mut chart = ChartBuilder::on(area)
            .margin(10)
            .caption(&self.title, ("sans-serif", 15).into_font().color(&INK))
            .x_label_area_size(36)
            .y_label_area_size(58)
            .build_cartesian_2d(
                Ticked::new(&across, self.ticks_across(&across)),
                Ticked::new(&along, self.ticks_along(&along)),
            )
            .map_err(|e| drawing(&e))?;
        let decade = |y: &f64| match self.y_scale {
            Scale::Linear => short(*y),
            Scale::Log => short(10_f64.powf(*y)),
        };
        chart
            .configure_mesh()
            .bold_line_style(FAINT)
            .light_line_style(TRANSPARENT)
            .axis_style(INK)
            .label_style(("sans-serif", 12).into_font().color(&INK))
            .x_desc(&self.x)
            .y_desc(&self.y)
            .x_labels(TICKS)
            .y_labels(TICKS)
            .x_label_formatter(&|x| short(*x))
            .y_label_formatter(&decade)
            .draw()
            .map_err(|e| drawing(&e))?;
        for (index, (points, series_of)) in placed.iter().zip(&self.series).enumerate() {
            let colour = series(index);
            chart
                .draw_series(LineSeries::new(points.iter().copied(), colour.stroke_width(2)))
                .map_err(|e| drawing(&e))?
                .label(&series_of.label)
                .legend(move |(x, y)| {
                    EmptyElement::at((x + 9, y))
                        + PathElement::new(vec![(-9, 0), (9, 0)], colour.stroke_width(2))
                        + marker(index, colour)
                });
            chart
                .draw_series(points.iter().map(|&at| EmptyElement::at(at) + marker(index, colour)))
                .map_err(|e| drawing(&e))?;
        }
        if self.series.len() > 1 {
            chart
                .configure_series_labels()
                .position(SeriesLabelPosition::UpperRight)
                .background_style(WHITE.mix(0.85))
                .border_style(FAINT)
                .label_font(("sans-serif", 12).into_font().color(&INK))
                .draw()
                .map_err(|e| drawing(&e))?;
        }
        Ok(())
    }
}

fn legend_rows(series: usize) -> f64 {
    series as f64
}

/// A shape of its own for each series, since colours alone are lost in greyscale.
pub(crate) fn marker(index: usize, colour: RGBColor) -> PathElement<(i32, i32)> {
    let outline: &[(i32, i32)] = match index % 8 {
        0 => &[(-3, -3), (3, -3), (3, 3), (-3, 3), (-3, -3)],
        1 => &[(0, -4), (4, 3), (-4, 3), (0, -4)],
        2 => &[(-3, -3), (3, 3), (0, 0), (3, -3), (-3, 3)],
        3 => &[(0, -4), (4, 0), (0, 4), (-4, 0), (0, -4)],
        4 => &[(-4, 0), (4, 0), (0, 0), (0, -4), (0, 4)],
        5 => &[(0, 4), (4, -3), (-4, -3), (0, 4)],
        6 => &[(-3, -4), (3, -4), (-3, 4), (3, 4), (-3, -4)],
        _ => &[(-2, -4), (2, -4), (4, -2), (4, 2), (2, 4), (-2, 4), (-4, 2), (-4, -2), (-2, -4)],
    };
    PathElement::new(outline.to_vec(), colour.stroke_width(2))
}

/// A number for an axis: three digits, without zeros that say nothing.
pub(crate) fn short(value: f64) -> String {
    let magnitude = value.abs();
    if magnitude < 1e-12 {
        return "0".to_owned();
    }
    if !(1e-3..1e4).contains(&magnitude) {
        return format!("{value:.1e}");
    }
    let decimals = match magnitude {
        m if m >= 100.0 => 0,
        m if m >= 10.0 => 1,
        m if m >= 1.0 => 2,
        m if m >= 0.1 => 3,
        _ => 4,
    };
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_on_axes_are_short() {
        let cases = [(0.0, "0"), (0.5, "0.5"), (90.0, "90"), (0.0125, "0.0125"), (2e-5, "2.0e-5")];
        for (value, expected) in cases {
            assert_eq!(short(value), expected);
        }
    }

    #[test]
    fn counts_have_labels_at_whole_numbers() {
        let counts = |last: u32| Curves {
            series: vec![Series::new("a", (1..=last).map(|n| (f64::from(n), 1.0)).collect())],
            ..Curves::default()
        };
        assert_eq!(counts(5).ticks_across(&(0.84..5.16)), [1.0, 2.0, 3.0, 4.0, 5.0]);
        let many = counts(800).ticks_across(&(-30.0..830.0));
        assert!(many.len() <= TICKS && many.contains(&100.0), "{many:?}");
    }

    #[test]
    fn a_logarithmic_axis_is_labelled_with_1_2_and_5() {
        let log = Curves { y_scale: Scale::Log, ..Curves::default() };
        let labels = |range: Range<f64>| {
            log.ticks_along(&range).iter().map(|y| short(10_f64.powf(*y))).collect::<Vec<_>>()
        };
        let two_decades = labels(-2.9..-1.1);
        assert_eq!(two_decades, ["0.002", "0.005", "0.01", "0.02", "0.05"]);
        assert_eq!(labels(-4.5..-0.5).len(), 4, "powers of ten alone");
        let many = labels(-40.2..0.0).len();
        assert!((4..=TICKS).contains(&many), "{many} labels over 40 decades");
        assert!(labels(0.05..0.2).len() > 1, "a part of a decade has labels too");
    }

    #[test]
    fn a_series_without_a_place_is_no_plot() {
        let curves = Curves {
            y_scale: Scale::Log,
            series: vec![Series::new("zero", vec![(1.0, 0.0)])],
            ..Curves::default()
        };
        assert!(matches!(plot_curves(&[curves], 1), Err(PlotError::Nothing { .. })));
    }
}
