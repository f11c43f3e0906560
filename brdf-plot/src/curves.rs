//! Curves over an axis: errors against ranks, spectra.

use plotters::coord::Shift;
use plotters::prelude::*;

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
            .build_cartesian_2d(across, along)
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
    let outline: &[(i32, i32)] = match index % 6 {
        0 => &[(-3, -3), (3, -3), (3, 3), (-3, 3), (-3, -3)],
        1 => &[(0, -4), (4, 3), (-4, 3), (0, -4)],
        2 => &[(-3, -3), (3, 3), (0, 0), (3, -3), (-3, 3)],
        3 => &[(0, -4), (4, 0), (0, 4), (-4, 0), (0, -4)],
        4 => &[(-4, 0), (4, 0), (0, 0), (0, -4), (0, 4)],
        _ => &[(0, 4), (4, -3), (-4, -3), (0, 4)],
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
    fn a_series_without_a_place_is_no_plot() {
        let curves = Curves {
            y_scale: Scale::Log,
            series: vec![Series::new("zero", vec![(1.0, 0.0)])],
            ..Curves::default()
        };
        assert!(matches!(plot_curves(&[curves], 1), Err(PlotError::Nothing { .. })));
    }
}
