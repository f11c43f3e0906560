//! Curves over two axes that are divided by factors of ten: errors against bytes.

use std::ops::Range;

use plotters::coord::Shift;
use plotters::prelude::*;

use crate::colours::{FAINT, INK, series};
use crate::curves::{Curves, marker, short};
use crate::error::{PlotError, drawing};
use crate::plot::{Plot, on_sheet};

const PANEL: (u32, u32) = (460, 340);
/// Room at both ends of an axis, as a factor.
const MARGIN: f64 = 1.25;
/// A line of the legend, the sample of a curve with the gaps around it, and a letter, in pixels.
const LEGEND_LINE: u32 = 22;
const SAMPLE: u32 = 52;
const LETTER: u32 = 7;

/// Plots panels of curves, `columns` side by side, with both axes divided by factors of ten; points that are not
/// positive are left out, and `y_scale` is not looked at.
///
/// All panels have the same axes and, for what it matters to the legend, the same series as the first. It stands below
/// them.
///
/// ```
/// use brdf_plot::{Curves, Series, plot_log_log};
///
/// let series = Series::new("splines", vec![(1000.0, 0.03), (8192.0, 0.015)]);
/// let panel = Curves { x: "bytes".to_owned(), series: vec![series], ..Curves::default() };
/// assert!(plot_log_log(&[panel], 1)?.svg().contains("bytes"));
/// # Ok::<(), brdf_plot::PlotError>(())
/// ```
///
/// # Errors
///
/// [`PlotError::Nothing`] without a point that can be shown; [`PlotError::Drawing`].
pub fn plot_log_log(panels: &[Curves], columns: usize) -> Result<Plot, PlotError> {
    let columns = columns.clamp(1, panels.len().max(1));
    let rows = panels.len().div_ceil(columns);
    let wide = |count: usize, side: u32| u32::try_from(count).unwrap_or(1) * side;
    let size = (wide(columns, PANEL.0), wide(rows, PANEL.1));
    let legend = legend(panels.first().map_or(&[], |panel| &panel.series), size.0);
    let below = wide(legend.len(), LEGEND_LINE);
    let points = || panels.iter().flat_map(|panel| &panel.series).flat_map(shown);
    let ranges = range(points().map(|p| p.0)).zip(range(points().map(|p| p.1)));
    let Some((across, along)) = ranges else {
        return Err(PlotError::Nothing { what: "no point can be shown" });
    };
    on_sheet((size.0, size.1 + below), |sheet, _| {
        let (above, below) = sheet.split_vertically(size.1);
        let areas = above.split_evenly((rows, columns));
        for (panel, area) in panels.iter().zip(&areas) {
            draw(panel, area, across.clone(), along.clone())?;
        }
        draw_legend(&legend, &below)
    })
}

/// The labels of series with their numbers, in lines that a width has room for; none of a single series.
fn legend(series: &[crate::Series], width: u32) -> Vec<Vec<(usize, &str)>> {
    let mut lines: Vec<Vec<(usize, &str)>> = Vec::new();
    if series.len() < 2 {
        return lines;
    }
    let mut used = width;
    for (index, series) in series.iter().enumerate() {
        let wanted = entry_width(&series.label);
        if used + wanted > width.saturating_sub(30) {
            lines.push(Vec::new());
            used = 0;
        }
        used += wanted;
        if let Some(line) = lines.last_mut() {
            line.push((index, &series.label));
        }
    }
    lines
}

fn entry_width(label: &str) -> u32 {
    SAMPLE + LETTER * u32::try_from(label.chars().count()).unwrap_or(0)
}

fn draw_legend(
    lines: &[Vec<(usize, &str)>],
    area: &DrawingArea<SVGBackend<'_>, Shift>,
) -> Result<(), PlotError> {
    let style = ("sans-serif", 12).into_font().color(&INK);
    let mut y = 6;
    for line in lines {
        let mut x = 30;
        for &(index, label) in line {
            let colour = series(index);
            let sample = EmptyElement::at((x, y))
                + PathElement::new(vec![(-9, 0), (9, 0)], colour.stroke_width(2))
                + marker(index, colour)
                + Text::new(label.to_owned(), (16, -6), style.clone());
            area.draw(&sample).map_err(|e| drawing(&e))?;
            x += entry_width(label).cast_signed();
        }
        y += LEGEND_LINE.cast_signed();
    }
    Ok(())
}

/// Points of a series that have a place.
fn shown(series: &crate::Series) -> impl Iterator<Item = (f64, f64)> + '_ {
    let is_positive = |v: f64| v > 0.0 && v.is_finite();
    series.points.iter().copied().filter(move |&(x, y)| is_positive(x) && is_positive(y))
}

fn range(values: impl Iterator<Item = f64>) -> Option<Range<f64>> {
    let (low, high) = values.fold((f64::MAX, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
    (high > 0.0).then(|| low / MARGIN..high * MARGIN)
}

fn draw(
    panel: &Curves,
    area: &DrawingArea<SVGBackend<'_>, Shift>,
    across: Range<f64>,
    along: Range<f64>,
) -> Result<(), PlotError> {
    let mut chart = ChartBuilder::on(area)
        .margin(10)
        .margin_right(24)
        .caption(&panel.title, ("sans-serif", 15).into_font().color(&INK))
        .x_label_area_size(36)
        .y_label_area_size(58)
        .build_cartesian_2d(across.log_scale(), along.log_scale())
        .map_err(|e| drawing(&e))?;
    chart
        .configure_mesh()
        .bold_line_style(FAINT)
        .light_line_style(TRANSPARENT)
        .axis_style(INK)
        .label_style(("sans-serif", 12).into_font().color(&INK))
        .x_desc(&panel.x)
        .y_desc(&panel.y)
        .x_label_formatter(&|x| decade(*x))
        .y_label_formatter(&|y| decade(*y))
        .draw()
        .map_err(|e| drawing(&e))?;
    for (index, of) in panel.series.iter().enumerate() {
        let colour = series(index);
        chart
            .draw_series(LineSeries::new(shown(of), colour.stroke_width(2)))
            .map_err(|e| drawing(&e))?;
        chart
            .draw_series(shown(of).map(|at| EmptyElement::at(at) + marker(index, colour)))
            .map_err(|e| drawing(&e))?;
    }
    Ok(())
}

/// 1, 2 or 5 times a power of ten, written out while that is short; the lines between have no room for a label.
fn decade(value: f64) -> String {
    let leading = value / 10_f64.powf(value.log10().floor());
    if ![1.0, 2.0, 5.0, 10.0].iter().any(|digit| (leading - digit).abs() < 1e-6) {
        return String::new();
    }
    if (1.0..1e7).contains(&value) { format!("{value:.0}") } else { short(value) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Series;

    fn panel(points: Vec<(f64, f64)>) -> Curves {
        Curves { series: vec![Series::new("one", points)], ..Curves::default() }
    }

    /// Equal factors are equal steps: the middle point of three decades stands in the middle.
    #[test]
    fn equal_factors_are_equal_steps() {
        let line = panel(vec![(10.0, 0.1), (100.0, 0.01), (1000.0, 0.001)]);
        let plot = plot_log_log(&[line], 1).expect("three points");
        let lines = plot.svg().lines().filter(|line| line.contains("<polyline"));
        let drawn = lines.map(|line| {
            let points = line.split("points=\"").nth(1).unwrap_or_default();
            points.split('"').next().unwrap_or_default().to_owned()
        });
        let [a, b, c] = drawn
            .map(|points| {
                points
                    .split_whitespace()
                    .filter_map(|point| point.split(',').next()?.parse::<f64>().ok())
                    .collect::<Vec<_>>()
            })
            .find_map(|xs| <[f64; 3]>::try_from(xs).ok())
            .expect("the line of three points");
        assert!(((b - a) - (c - b)).abs() <= 2.0, "{a}, {b}, {c}");
    }

    #[test]
    fn labels_leave_room_for_each_other() {
        let labels: Vec<String> = (1..=10_u8).map(|d| decade(0.01 * f64::from(d))).collect();
        let shown: Vec<&String> = labels.iter().filter(|label| !label.is_empty()).collect();
        assert_eq!(shown.len(), 4, "{labels:?}");
        assert_eq!(decade(1000.0), "1000");
    }

    #[test]
    fn points_that_are_not_positive_are_no_plot() {
        let nothing = plot_log_log(&[panel(vec![(10.0, 0.0), (0.0, 1.0)])], 1);
        assert!(matches!(nothing, Err(PlotError::Nothing { .. })));
    }
}
